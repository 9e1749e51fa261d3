"""What a person should know of a conversion, in sentences."""

from collections.abc import Iterable, Mapping, Sequence

from evdash.grid.nets.branches import UNLIMITED_KA, AtBus, Connections
from evdash.grid.nets.feeder import ConvertedFeeder
from evdash.grid.nets.records import RECORDS, Bus, Element, Net
from evdash.grid.nets.tree import Tree, label
from evdash.grid.radial import KW_PER_MW

SAME_SCALE = 1e-6
SHOWN = 6
BUSES = ("bus", "from_bus", "to_bus", "hv_bus", "lv_bus")
"""Columns that say where an element is."""


def told_topology(
    net: Net, buses: Mapping[int, Bus], joined: Connections, tree: Tree
) -> Iterable[str]:
    """What became of buses, switches and what is not supplied."""
    yield (
        f"{len(tree.node_of)} of {len(net.bus)} buses became {len(tree.branches) + 1} nodes, "
        f"supplied at {label(buses[tree.source])}, and {len(tree.branches)} lines."
    )
    merged = len(tree.node_of) - len(tree.branches) - 1
    if merged:
        yield f"{merged} buses joined to others by closed switches are part of those nodes."
    open_count = sum(not x.closed for x in net.switch if x.bus in tree.node_of)
    idle = sum(not x.in_service for x in (*net.line, *net.trafo) if _is_supplied(x, tree))
    if open_count or idle:
        yield (
            f"As operated: {open_count} open switches and {idle} lines or transformers out of "
            "service stay so."
        )
    stubs = [told for bus, told in joined.stubs if bus in tree.node_of]
    if stubs:
        yield (f"{_listed(stubs)}: open at one end; all of the charging is at the closed end.")
    out = [label(buses[bus]) for bus in tree.unsupplied]
    out += [label(bus) for bus in net.bus if not bus.in_service]
    if out:
        loads = [x for x in net.load if x.in_service and x.bus not in tree.node_of]
        kw = sum(load.p_mw * load.scaling for load in loads) * KW_PER_MW
        yield (
            f"{_listed(out)}: not supplied from this source or out of service, left out with "
            f"{len(loads)} loads of {kw:,.1f} kW."
        )


def told_levels(
    net: Net, buses: Mapping[int, Bus], tree: Tree, feeder: ConvertedFeeder
) -> Iterable[str]:
    """How voltage levels, taps and phase shifts were converted."""
    base_kv, source_voltage_pu = feeder.base_kv, feeder.source_voltage_pu
    levels = sorted({buses[node].vn_kv for node in tree.node_of.values()}, reverse=True)
    if len(levels) > 1:
        told = ", ".join(f"{kv:g}" for kv in levels)
        yield (
            f"Voltage levels of {told} kV: impedances are referred to {base_kv:g} kV through the "
            "transformers' real ratios, taps included."
        )
    if abs(source_voltage_pu - tree.source_vm_pu) > SAME_SCALE:
        yield (
            f"The source holds {tree.source_vm_pu:g} pu; with the transformers' ratios that is "
            f"{source_voltage_pu:.5g} pu of {base_kv:g} kV."
        )
    shifted = [
        t for t in net.trafo if t.in_service and t.shift_degree % 360 and _is_supplied(t, tree)
    ]
    if shifted:
        yield (
            f"{len(shifted)} transformers turn the phase; on a radial feeder that changes neither "
            "powers nor voltage magnitudes, and is left out."
        )
    others = [
        f"{name} ×{scale:.4g}"
        for name, scale in feeder.scale_of_node.items()
        if abs(scale - 1) > SAME_SCALE and name != feeder.source_node
    ]
    if others:
        yield (
            f"{_listed(others)}: behind other ratios than most nodes, so that the scenario's "
            "voltage times this factor is per unit of their own nominal voltage. Limits there are "
            "held on the scenario's voltage."
        )


def told_powers(
    net: Net, joined: Connections, tree: Tree, shunts: Iterable[AtBus]
) -> Iterable[str]:
    """What was made of everything that draws, feeds in or stores power."""

    def reach(found: Iterable[AtBus]) -> tuple[float, float]:
        here = [at for at in found if at.bus in tree.node_of]
        return sum(at.load_kw for at in here), sum(at.shunt_kvar for at in here)

    sources = (
        ("Line charging", reach(joined.charging)),
        ("Transformers' no-load losses and magnetising", reach(joined.magnetising)),
        ("Shunts and wards' impedances", reach(shunts)),
    )
    for told, (kw, kvar) in sources:
        if kvar:
            yield f"{told}: {kvar:+,.1f} kvar in shunt_kvar, constant at nominal voltage."
        if kw:
            yield f"{told}: {kw:,.2f} kW added to loads, so that they follow the load profile."
    here = {
        table: [x for x in getattr(net, table) if x.in_service and _is_supplied(x, tree)]
        for table in ("load", "sgen", "storage")
    }
    bent = [load for load in here["load"] if load.depends_on_voltage]
    if bent:
        yield f"{len(bent)} loads that depend on voltage draw constant power at nominal voltage."
    scaled = [x for x in (*here["load"], *here["sgen"]) if x.scaling != 1]
    if scaled:
        yield f"The scaling of {len(scaled)} loads or generators is multiplied in."
    stored = here["storage"]
    if stored:
        kw = sum(x.p_mw * x.scaling for x in stored) * KW_PER_MW
        yield (
            f"{len(stored)} storages are taken at the {kw:+,.1f} kW they draw in the file: "
            "charging follows the load profile, discharging that of generation. How much energy "
            "they hold is left out."
        )
    fed = here["sgen"] + [x for x in here["load"] if x.p_mw < 0]
    if fed:
        kw = sum(abs(x.p_mw) * x.scaling for x in fed) * KW_PER_MW
        yield (
            f"{len(fed)} generators of {kw:,.1f} kW follow the generation profile; what reactive "
            "power they have is in shunt_kvar, constant."
        )


def told_ratings(net: Net, joined: Connections, tree: Tree) -> Iterable[str]:
    """Which lines have no rating and why, and what else than a current or a power is in others."""
    live = {branch.told for branch in joined.branches if branch.from_bus in tree.node_of}
    lines = [line for line in net.line if line.told("line") in live]
    kinds = (
        ("no max_i_ka", [x for x in lines if x.max_i_ka is None]),
        ("a max_i_ka of 0", [x for x in lines if x.max_i_ka == 0]),
        (
            f"a max_i_ka from {UNLIMITED_KA:,.0f} kA on",
            [x for x in lines if x.max_i_ka is not None and x.max_i_ka >= UNLIMITED_KA],
        ),
    )
    for why, unrated in kinds:
        if unrated:
            yield (
                f"{len(unrated)} of {len(lines)} lines have {why} and so nothing that limits them "
                f"here: {_listed(x.told('line') for x in unrated)}. If they have a limit, give it "
                "as rating_kva in lines.csv."
            )
    trafos = [trafo for trafo in net.trafo if trafo.told("trafo") in live]
    rated = [x for x in lines if x.max_i_ka and x.max_i_ka < UNLIMITED_KA]
    if rated:
        yield "Lines' ratings are the file's currents at nominal voltage."
    found = [x.max_loading_percent for x in rated] + [x.max_loading_percent for x in trafos]
    loaded = [percent for percent in found if percent is not None and percent != 100]
    if loaded:
        yield (
            f"max_loading_percent of {_span(loaded)} % is part of the ratings of {len(loaded)} "
            "lines or transformers."
        )
    uneven = [
        x.told("trafo")
        for x in trafos
        if (x.leakage_resistance_ratio_hv, x.leakage_reactance_ratio_hv) != (0.5, 0.5)
    ]
    if uneven:
        yield (
            f"{_listed(uneven)}: the leakage impedance is not halved between the sides in the file "
            "(leakage_resistance_ratio_hv, leakage_reactance_ratio_hv); that is left out, also in "
            "the comparison below."
        )


def told_voltages(
    buses: Mapping[int, Bus], tree: Tree, low: float | None, high: float | None
) -> Iterable[str]:
    """Whose voltage limits hold, and what the file's are where they do not."""
    if low is not None and high is not None:
        yield f"Voltage limits of {low:g} to {high:g} pu are the file's."
        return
    beside = [buses[bus] for bus, node in tree.node_of.items() if node != tree.source]
    sides = (
        ("lower", "min_vm_pu", low, [bus.min_vm_pu for bus in beside]),
        ("upper", "max_vm_pu", high, [bus.max_vm_pu for bus in beside]),
    )
    for side, column, taken, found in sides:
        given = [limit for limit in found if limit is not None]
        if taken is not None:
            yield f"The {side} voltage limit of {taken:g} pu is the file's."
        elif not given:
            yield f"The file's buses have no {side} voltage limit; the scenario keeps its own."
        elif len(given) == len(found) and len(set(given)) == 1:
            yield (
                f"The file's {side} voltage limit, {column} of {given[0]:g} pu, is none a scenario "
                "can hold beside the other one; the scenario keeps its own."
            )
        else:
            yield (
                f"{len(given)} of {len(found)} buses have a {side} voltage limit, {column} of "
                f"{_span(given)} pu; a scenario has one for all nodes and keeps its own."
            )


def told_unheld(net: Net, tree: Tree) -> Iterable[str]:
    """Limits of the file that no scenario has a place for, by table and column."""
    for table in RECORDS:
        limits: dict[str, dict[str, float]] = {}
        for element in getattr(net, table):
            if element.in_service and _is_supplied(element, tree):
                for column, value in element.unheld.items():
                    limits.setdefault(column, {})[element.told(table)] = value
        for column, by_name in limits.items():
            yield (
                f"{column} of {_span(list(by_name.values()))} is a limit no scenario has a place "
                f"for, and is not held: {_listed(by_name)}."
            )


def _is_supplied(element: Element, tree: Tree) -> bool:
    """Whether all of an element lies on the feeder that is taken."""
    ends = [getattr(element, column, None) for column in BUSES]
    if isinstance(element, Bus):
        ends = [element.index]
    return all(bus in tree.node_of for bus in ends if bus is not None)


def _span(values: Sequence[float]) -> str:
    low, high = min(values), max(values)
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def _listed(names: Iterable[str]) -> str:
    listed = list(names)
    more = f" and {len(listed) - SHOWN} more" if len(listed) > SHOWN else ""
    return ", ".join(listed[:SHOWN]) + more
