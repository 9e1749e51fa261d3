"""A pandapower network as a scenario's feeder, by the rules of `docs/importing.md`.

A radial network has one voltage level at a time along any way, so that every impedance can be
referred to one nominal voltage through the transformers' real ratios, taps included, without
changing what flows or how voltages relate. What depends on voltage beside the series impedances
(line charging, magnetising, shunts) becomes constant power at nominal voltage.
"""

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from evdash.domain.scenario import Line, Node
from evdash.errors import Fault, InputError
from evdash.grid.nets.branches import AtBus, Connections, connections
from evdash.grid.nets.feeder import ConvertedFeeder
from evdash.grid.nets.notices import (
    told_levels,
    told_powers,
    told_ratings,
    told_topology,
    told_unheld,
    told_voltages,
)
from evdash.grid.nets.records import Bus, Net
from evdash.grid.nets.tree import Tree, names_of, radial_tree
from evdash.grid.radial import KW_PER_MW

LEAST_OHM = 1e-6
MOST_PU = 1.5
"""Voltages from here on stand for "no limit" in published files, as 0 does."""


def converted(net: Net, source: str | None = None) -> ConvertedFeeder:
    """The feeder `net` is, supplied from `source` where it has several supplies.

    Raises InputError naming every place that keeps it from being a balanced radial feeder.
    """
    buses = {bus.index: bus for bus in net.bus}
    faults = [*_unknown_buses(net, buses), *_refused(net)]
    if faults:
        raise InputError(faults)
    joined = connections(net, buses)
    tree, found = radial_tree(net, buses, joined, source)
    faults = [*joined.faults, *found]
    if tree is not None and not tree.branches:
        faults.append(Fault("network", "a source that supplies nothing", "should supply a node"))
    if faults or tree is None:
        raise InputError(faults)
    return _feeder(net, buses, joined, tree)


def _unknown_buses(net: Net, buses: Mapping[int, Bus]) -> Iterable[Fault]:
    ends = {
        "line": ("from_bus", "to_bus"),
        "trafo": ("hv_bus", "lv_bus"),
        **dict.fromkeys(("load", "sgen", "storage", "shunt", "ward", "ext_grid"), ("bus",)),
    }
    for table, columns in ends.items():
        for element in getattr(net, table):
            for column in columns:
                if (bus := getattr(element, column)) not in buses:
                    place = f"table {table}, row {element.index}, column {column}"
                    yield Fault(place, f"{bus}", "should be the index of a row of table bus")
    others = {"b": buses, "l": {x.index for x in net.line}, "t": {x.index for x in net.trafo}}
    for switch in net.switch:
        place = f"table switch, row {switch.index}"
        if switch.bus not in buses:
            yield Fault(f"{place}, column bus", f"{switch.bus}", "should be a row of table bus")
        if switch.et in others and switch.element not in others[switch.et]:
            rule = "should be the index of what it switches, a bus, line or transformer"
            yield Fault(f"{place}, column element", f"{switch.element}", rule)


def _refused(net: Net) -> Iterable[Fault]:
    rule = "cannot be carried by a balanced radial feeder of constant-power loads"
    for other in net.others:
        if other.in_service:
            yield Fault(other.told(other.table), "in service", rule)
    for load in net.load:
        for part in ("p", "q"):
            shares = [getattr(load, f"const_{kind}_{part}_percent") for kind in "zi"]
            if sum(shares) > 100:
                place = (
                    f"{load.told('load')}, columns const_z_{part}_percent, const_i_{part}_percent"
                )
                yield Fault(place, f"{sum(shares):g} together", "should be at most 100")
    for shunt in net.shunt:
        if shunt.in_service and shunt.step_dependency_table:
            yield Fault(shunt.told("shunt"), "steps by table (step_dependency_table)", rule)


@dataclass(slots=True)
class _Powers:
    """What is at one node, kW and kvar."""

    load_kw: float = 0.0
    load_kvar: float = 0.0
    shunt_kvar: float = 0.0
    generation_kw: float = 0.0


def _feeder(net: Net, buses: Mapping[int, Bus], joined: Connections, tree: Tree) -> ConvertedFeeder:
    reference = _reference_kv(tree, buses)
    shown_as = {node: kv / buses[node].vn_kv for node, kv in reference.items()}
    factor, base_kv = _base(tree, buses, shown_as)
    shunts = _at_nominal(net, buses)
    powers = _powers(net, joined, tree, shunts)
    notices = []
    names = names_of([buses[node] for node in reference])
    lines = []
    for branch in tree.branches:
        ohm = branch.impedance_ohm * (base_kv * factor / reference[branch.to_bus]) ** 2
        if max(ohm.real, ohm.imag) < LEAST_OHM:
            notices.append(
                f"{branch.told} has next to no impedance and was given {LEAST_OHM:g} ohm."
            )
            ohm = complex(0.0, LEAST_OHM)
        lines.append(
            Line(
                from_node=names[branch.from_bus],
                to_node=names[branch.to_bus],
                r_ohm=ohm.real,
                x_ohm=ohm.imag,
                rating_kva=branch.rating_kva,
            )
        )
    low, high = _limits(tree, buses)
    feeder = ConvertedFeeder(
        name=net.name,
        nodes=tuple(_node(names[node], powers[node], buses[node]) for node in reference),
        lines=tuple(lines),
        source_node=names[tree.source],
        source_voltage_pu=tree.source_vm_pu * factor,
        base_kv=base_kv,
        base_mva=net.sn_mva,
        voltage_min_pu=low,
        voltage_max_pu=high,
        node_of_bus={bus: names[node] for bus, node in tree.node_of.items()},
        scale_of_node={names[node]: value / factor for node, value in shown_as.items()},
        notices=(),
    )
    told = (
        *told_topology(net, buses, joined, tree),
        *told_levels(net, buses, tree, feeder),
        *notices,
        *told_powers(net, joined, tree, shunts),
        *told_ratings(net, joined, tree),
        *told_voltages(buses, tree, low, high),
        *told_unheld(net, tree),
    )
    return replace(feeder, notices=told)


def _node(name: str, at: _Powers, bus: Bus) -> Node:
    return Node(
        node=name,
        load_kw=at.load_kw,
        load_kvar=at.load_kvar,
        shunt_kvar=at.shunt_kvar or None,
        generation_kw=at.generation_kw or None,
        x=bus.x,
        y=bus.y,
    )


def _reference_kv(tree: Tree, buses: Mapping[int, Bus]) -> dict[int, float]:
    """The voltage at each node when the source has its nominal one and nothing flows, kV."""
    reference = {tree.source: buses[tree.source].vn_kv}
    for branch in tree.branches:
        reference[branch.to_bus] = reference[branch.from_bus] * branch.ratio
    return reference


def _base(
    tree: Tree, buses: Mapping[int, Bus], shown_as: Mapping[int, float]
) -> tuple[float, float]:
    """The scale and nominal voltage of most nodes beside the source: theirs are carried exactly."""
    nodes = [branch.to_bus for branch in tree.branches]
    scale = Counter(round(shown_as[node], 9) for node in nodes).most_common(1)[0][0]
    alike = [node for node in nodes if round(shown_as[node], 9) == scale]
    base_kv = Counter(buses[node].vn_kv for node in alike).most_common(1)[0][0]
    return shown_as[next(n for n in alike if buses[n].vn_kv == base_kv)], base_kv


def _powers(
    net: Net, joined: Connections, tree: Tree, shunts: Iterable[AtBus]
) -> dict[int, _Powers]:
    """What is at each node."""
    powers = {tree.source: _Powers()} | {branch.to_bus: _Powers() for branch in tree.branches}

    def draw(bus: int, kw: float, kvar: float) -> None:
        """Power drawn that follows the load profile; what is fed in follows generation's."""
        at = powers[tree.node_of[bus]]
        if kw < 0:
            at.generation_kw -= kw
            at.shunt_kvar -= kvar
        else:
            at.load_kw += kw
            at.load_kvar += kvar

    for load in net.load:
        if load.in_service and load.bus in tree.node_of:
            size = load.scaling * KW_PER_MW
            draw(load.bus, load.p_mw * size, load.q_mvar * size)
    for sgen in net.sgen:
        if sgen.in_service and sgen.bus in tree.node_of:
            size = sgen.scaling * KW_PER_MW
            draw(sgen.bus, -sgen.p_mw * size, -sgen.q_mvar * size)
    for storage in net.storage:
        if storage.in_service and storage.bus in tree.node_of:
            size = storage.scaling * KW_PER_MW
            draw(storage.bus, storage.p_mw * size, storage.q_mvar * size)
    for ward in net.ward:
        if ward.in_service and ward.bus in tree.node_of:
            draw(ward.bus, ward.ps_mw * KW_PER_MW, ward.qs_mvar * KW_PER_MW)
    for at in (*joined.charging, *joined.magnetising, *shunts):
        if at.bus in tree.node_of:
            draw(at.bus, at.load_kw, 0.0)
            powers[tree.node_of[at.bus]].shunt_kvar += at.shunt_kvar
    return powers


def _at_nominal(net: Net, buses: Mapping[int, Bus]) -> list[AtBus]:
    """Shunts and wards' impedances as constant power at their bus's nominal voltage."""
    found = []
    for shunt in net.shunt:
        if shunt.in_service:
            kv = buses[shunt.bus].vn_kv
            size = shunt.step * (kv / (shunt.vn_kv or kv)) ** 2 * KW_PER_MW
            found.append(AtBus(shunt.bus, shunt.p_mw * size, -shunt.q_mvar * size))
    for ward in net.ward:
        if ward.in_service:
            found.append(AtBus(ward.bus, ward.pz_mw * KW_PER_MW, -ward.qz_mvar * KW_PER_MW))
    return found


def _limits(tree: Tree, buses: Mapping[int, Bus]) -> tuple[float | None, float | None]:
    """The lower and the upper voltage limit that all buses beside the source's agree on, each by
    itself, per unit."""
    beside = [buses[bus] for bus, node in tree.node_of.items() if node != tree.source]
    sides = ({bus.min_vm_pu for bus in beside}, {bus.max_vm_pu for bus in beside})
    low, high = (side.pop() if len(side) == 1 else None for side in sides)
    low = low if low is not None and 0 < low < MOST_PU else None
    high = high if high is not None and 0 < high < MOST_PU else None
    return (None, None) if low is not None and high is not None and low >= high else (low, high)
