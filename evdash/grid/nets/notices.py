"""What a person should know of a conversion, in sentences."""

from collections.abc import Iterable, Mapping

from evdash.grid.nets.branches import AtBus, Connections
from evdash.grid.nets.feeder import ConvertedFeeder
from evdash.grid.nets.records import Bus, Net
from evdash.grid.nets.tree import Tree, label
from evdash.grid.radial import KW_PER_MW

SAME_SCALE = 1e-6
SHOWN = 6


def told_topology(
    net: Net, buses: Mapping[int, Bus], joined: Connections, tree: Tree
) -> Iterable[str]:
    """What became of buses, switches and what is not supplied."""
    yield (
        f"{len(net.bus)} buses became {len(tree.branches) + 1} nodes, supplied at "
        f"{label(buses[tree.source])}, and {len(tree.branches)} lines."
    )
    merged = len(tree.node_of) - len(tree.branches) - 1
    if merged:
        yield f"{merged} buses joined to others by closed switches are part of those nodes."
    open_count = sum(not switch.closed for switch in net.switch)
    idle = sum(not element.in_service for element in (*net.line, *net.trafo))
    if open_count or idle:
        yield (
            f"As operated: {open_count} open switches and {idle} lines or transformers out of "
            "service stay so."
        )
    if joined.stubs:
        yield (
            f"{_listed(joined.stubs)}: open at one end; all of the charging is at the closed end."
        )
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
    shifted = [t for t in net.trafo if t.in_service and t.shift_degree % 360]
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
    bent = [load for load in net.load if load.in_service and load.depends_on_voltage]
    if bent:
        yield f"{len(bent)} loads that depend on voltage draw constant power at nominal voltage."
    scaled = [x for x in (*net.load, *net.sgen) if x.in_service and x.scaling != 1]
    if scaled:
        yield f"The scaling of {len(scaled)} loads or generators is multiplied in."
    stored = [x for x in net.storage if x.in_service]
    if stored:
        kw = sum(x.p_mw * x.scaling for x in stored) * KW_PER_MW
        yield (
            f"{len(stored)} storages are taken at the {kw:+,.1f} kW they draw in the file: "
            "charging follows the load profile, discharging that of generation."
        )
    fed = [x for x in net.sgen if x.in_service and x.bus in tree.node_of]
    fed += [x for x in net.load if x.in_service and x.p_mw < 0 and x.bus in tree.node_of]
    if fed:
        kw = sum(abs(x.p_mw) * x.scaling for x in fed) * KW_PER_MW
        yield (
            f"{len(fed)} generators of {kw:,.1f} kW follow the generation profile; what reactive "
            "power they have is in shunt_kvar, constant."
        )


def told_limits(
    buses: Mapping[int, Bus], tree: Tree, low: float | None, high: float | None
) -> Iterable[str]:
    """Whose voltage limits hold."""
    if low is not None and high is not None:
        yield f"Voltage limits of {low:g} to {high:g} pu are the file's."
    elif any(buses[b.to_bus].min_vm_pu is not None for b in tree.branches):
        yield "The file's buses have different voltage limits; the scenario keeps its own."


def _listed(names: Iterable[str]) -> str:
    listed = list(names)
    more = f" and {len(listed) - SHOWN} more" if len(listed) > SHOWN else ""
    return ", ".join(listed[:SHOWN]) + more
