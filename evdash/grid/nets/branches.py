"""What connects the buses of a network as it is operated: series impedances, ratios, shunts."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import cos, hypot, pi, radians, sin, sqrt

from evdash.errors import Fault
from evdash.grid.nets.records import Bus, Line, Net, Switch, Trafo
from evdash.grid.radial import KW_PER_MW

SWITCH_RX = 2.0
"""pandapower's ratio of resistance to reactance inside a switch."""
UNLIMITED_KA = 9999.0
"""Currents from here on stand for "no limit" in published files."""


@dataclass(frozen=True, slots=True)
class AtBus:
    """Constant-power stand-in of something that depends on voltage: kW drawn, kvar injected."""

    bus: int
    load_kw: float = 0.0
    shunt_kvar: float = 0.0


@dataclass(frozen=True, slots=True)
class Branch:
    """A series element between two buses.

    `impedance_ohm` as seen from `to_bus`; `ratio` is the voltage at `to_bus` per voltage at
    `from_bus` when nothing flows, kV per kV; `rating_kva` None for no limit.
    """

    told: str
    from_bus: int
    to_bus: int
    impedance_ohm: complex
    ratio: float
    rating_kva: float | None


@dataclass
class Connections:
    """Branches in service with both ends closed, what hangs at buses, buses that are one."""

    branches: list[Branch] = field(default_factory=list)
    charging: list[AtBus] = field(default_factory=list)
    magnetising: list[AtBus] = field(default_factory=list)
    fused: list[tuple[int, int]] = field(default_factory=list)
    stubs: list[tuple[int, str]] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)


def connections(net: Net, buses: Mapping[int, Bus]) -> Connections:
    """The network as operated: out of service or open at both ends is out, open at one end is a
    stub that only draws its charging there."""
    found = Connections()
    open_at = {(s.et, s.element, s.bus) for s in net.switch if not s.closed}
    for line in net.line:
        ends = (line.from_bus, line.to_bus)
        if line.in_service and _both_live(ends, buses):
            closed = [bus for bus in ends if ("l", line.index, bus) not in open_at]
            _line(found, line, closed, net.f_hz, buses)
    for trafo in net.trafo:
        ends = (trafo.hv_bus, trafo.lv_bus)
        if trafo.in_service and _both_live(ends, buses):
            closed = [bus for bus in ends if ("t", trafo.index, bus) not in open_at]
            _trafo(found, trafo, closed, buses)
    for switch in net.switch:
        if switch.et == "b" and switch.closed and _both_live((switch.bus, switch.element), buses):
            _switch(found, switch)
    return found


def _both_live(ends: tuple[int, int], buses: Mapping[int, Bus]) -> bool:
    return all(bus in buses and buses[bus].in_service for bus in ends)


def _line(
    found: Connections, line: Line, closed: list[int], f_hz: float, buses: Mapping[int, Bus]
) -> None:
    volts_sq = (1000 * buses[line.from_bus].vn_kv) ** 2
    size = line.length_km * line.parallel * volts_sq / KW_PER_MW
    kvar = 2 * pi * f_hz * line.c_nf_per_km * 1e-9 * size
    kw = line.g_us_per_km * 1e-6 * size
    for bus in closed:
        found.charging.append(AtBus(bus, kw / len(closed), kvar / len(closed)))
    if len(closed) == 1:
        found.stubs.append((closed[0], line.told("line")))
    if len(closed) == 2:
        ohm = complex(line.r_ohm_per_km, line.x_ohm_per_km) * line.length_km / line.parallel
        rating = None
        if line.max_i_ka is not None and 0 < line.max_i_ka < UNLIMITED_KA:
            rating = _limit_kva(sqrt(3) * buses[line.from_bus].vn_kv * line.max_i_ka, line)
        found.branches.append(
            Branch(line.told("line"), line.from_bus, line.to_bus, ohm, 1.0, rating)
        )


def _limit_kva(rated_mva: float, element: Line | Trafo) -> float:
    """What may flow through `parallel` systems: all that pandapower's loading_percent and its limit
    say, kVA at nominal voltage."""
    allowed = (element.max_loading_percent or 100.0) / 100
    return rated_mva * element.df * element.parallel * allowed * KW_PER_MW


def _trafo(found: Connections, trafo: Trafo, closed: list[int], buses: Mapping[int, Bus]) -> None:
    hv_kv, lv_kv, faults = rated_kv(trafo)
    found.faults += faults
    base_ohm = lv_kv**2 / trafo.sn_mva / trafo.parallel
    if trafo.vkr_percent > trafo.vk_percent:
        found.faults.append(
            Fault(
                f"{trafo.told('trafo')}, column vkr_percent",
                f"{trafo.vkr_percent:g}",
                f"should be at most vk_percent, {trafo.vk_percent:g}",
            )
        )
        return
    x_percent = sqrt(trafo.vk_percent**2 - trafo.vkr_percent**2)
    no_load_kva = trafo.i0_percent / 100 * trafo.sn_mva * KW_PER_MW
    kvar = sqrt(max(0.0, no_load_kva**2 - trafo.pfe_kw**2)) * trafo.parallel
    for bus in closed:
        rated = hv_kv if bus == trafo.hv_bus else lv_kv
        at_nominal = (buses[bus].vn_kv / rated) ** 2 / len(closed)
        found.magnetising.append(
            AtBus(bus, trafo.pfe_kw * trafo.parallel * at_nominal, -kvar * at_nominal)
        )
    if len(closed) == 1:
        found.stubs.append((closed[0], trafo.told("trafo")))
    if len(closed) == 2:
        found.branches.append(
            Branch(
                trafo.told("trafo"),
                trafo.hv_bus,
                trafo.lv_bus,
                complex(trafo.vkr_percent, x_percent) / 100 * base_ohm,
                lv_kv / hv_kv,
                _limit_kva(trafo.sn_mva, trafo),
            )
        )


def rated_kv(trafo: Trafo) -> tuple[float, float, list[Fault]]:
    """Rated voltages of both sides with the tap where it stands, kV, and what cannot be read.

    A tap changer of type Ratio or Symmetrical adds steps × tap_step_percent of the rated voltage
    of its side at the angle tap_step_degree; one of type Ideal turns the angle only; without a
    type a tap has no effect, as in pandapower 3.
    """
    kv = {"hv": trafo.vn_hv_kv, "lv": trafo.vn_lv_kv}
    place = trafo.told("trafo")
    faults = []
    if trafo.tap_dependency_table:
        faults.append(
            Fault(place, "a tap changer by table (tap_dependency_table)", "cannot be converted")
        )
    if (trafo.tap2_pos or 0.0) != (trafo.tap2_neutral or 0.0):
        faults.append(Fault(place, "a second tap changer off neutral", "cannot be converted"))
    kind = trafo.tap_changer_type
    if kind not in (None, "", "Ratio", "Symmetrical", "Ideal", "None"):
        faults.append(Fault(f"{place}, column tap_changer_type", repr(kind), "cannot be converted"))
    if kind in ("Ratio", "Symmetrical") and trafo.tap_side and trafo.tap_pos is not None:
        steps = trafo.tap_pos - (trafo.tap_neutral or 0.0)
        rated = kv[trafo.tap_side]
        added = steps * (trafo.tap_step_percent or 0.0) / 100 * rated
        angle = radians(trafo.tap_step_degree or 0.0)
        kv[trafo.tap_side] = hypot(rated + added * cos(angle), added * sin(angle))
    if min(kv.values()) <= 0:
        faults.append(Fault(place, "a tap that leaves no voltage", "should leave more than none"))
        return trafo.vn_hv_kv, trafo.vn_lv_kv, faults
    return kv["hv"], kv["lv"], faults


def _switch(found: Connections, switch: Switch) -> None:
    if switch.z_ohm == 0:
        found.fused.append((switch.bus, switch.element))
        return
    x_ohm = switch.z_ohm / sqrt(1 + SWITCH_RX**2)
    found.branches.append(
        Branch(
            switch.told("switch"),
            switch.bus,
            switch.element,
            complex(SWITCH_RX * x_ohm, x_ohm),
            1.0,
            None,
        )
    )


def in_parallel(branches: list[Branch]) -> Iterator[Branch]:
    """Branches between the same two buses and of the same ratio as one.

    The currents divide by admittance, so the first to reach its rating limits them all.
    """
    if len(branches) == 1:
        yield branches[0]
        return
    ohms = [branch.impedance_ohm for branch in branches]
    together = 0j if 0 in ohms else 1 / sum(1 / ohm for ohm in ohms)
    ratings = [
        branch.rating_kva * abs(branch.impedance_ohm) / abs(together)
        for branch in branches
        if branch.rating_kva is not None and together
    ]
    first = branches[0]
    yield Branch(
        " and ".join(branch.told for branch in branches),
        first.from_bus,
        first.to_bus,
        together,
        first.ratio,
        min(ratings, default=None),
    )
