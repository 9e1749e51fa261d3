"""AC power flow of the executed schedule by pandapower: the referee of every answer."""

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evdash.domain.elements import Element
from evdash.domain.limits import Floats
from evdash.domain.scenario import Scenario
from evdash.errors import PowerFlowDiverged
from evdash.grid.lindistflow import Injections, base_injections, with_station
from evdash.grid.radial import KW_PER_MW, RadialFeeder, radial_feeder
from evdash.grid.sides import Power, away_from_source

NEWTON = {"numba": False, "tolerance_mva": 1e-8, "init": "flat", "max_iteration": 30}
LOADS_CHANGE = {"bus_pq": True, "trafo": False, "gen": False}


@dataclass(frozen=True, slots=True)
class AcResult:
    """AC solution per interval; NaN where there is none.

    Powers are kW + j kvar away from the source. Shapes: voltage_pu and node_power, the net load,
    (intervals, nodes); line_power (intervals, lines, 2), at the end nearer to the source and at
    the other; losses_kw (intervals,).
    """

    nodes: tuple[str, ...]
    lines: tuple[Element, ...]
    voltage_pu: Floats
    line_power: Power
    node_power: Power
    losses_kw: Floats

    @property
    def line_kva(self) -> Floats:
        """The larger of both ends, (intervals, lines)."""
        return np.asarray(np.abs(self.line_power).max(axis=-1))

    @property
    def diverged(self) -> tuple[int, ...]:
        """Rows without an AC solution."""
        return tuple(int(row) for row in np.flatnonzero(np.isnan(self.losses_kw)))


def ac_flow(
    scenario: Scenario, station_kw: Floats, on_flow: Callable[[], None] | None = None
) -> AcResult:
    """AC power flow of the intervals from 0 on, one for each entry of `station_kw`, kW.

    `on_flow` is called before each of them; what it raises ends the work.
    """
    return AcNetwork(scenario).flow(scenario, np.arange(len(station_kw)), station_kw, on_flow)


class AcNetwork:
    """A scenario's feeder in pandapower, built once and solved in place: one thread at a time."""

    def __init__(self, scenario: Scenario) -> None:
        self.feeder = radial_feeder(scenario)
        self._net = build_network(scenario, self.feeder)

    def flow(
        self,
        scenario: Scenario,
        intervals: NDArray[np.int64],
        station_kw: Floats,
        on_flow: Callable[[], None] | None = None,
    ) -> AcResult:
        """AC power flow of `intervals` with the station drawing `station_kw`, both (rows,).

        Loads, generation, shunts and the station draw constant power. An interval in which
        Newton's method finds no solution is left NaN. `scenario` may differ from the one the
        network was built of in all but its feeder.
        """
        feeder = self.feeder
        every = base_injections(scenario, feeder)
        base = Injections(every.active_kw[intervals], every.reactive_kvar[intervals])
        injections = with_station(scenario, feeder, base, station_kw)
        count = len(station_kw)
        result = AcResult(
            nodes=feeder.nodes,
            lines=feeder.lines,
            voltage_pu=np.full((count, len(feeder.nodes)), np.nan),
            line_power=np.full((count, len(feeder.lines), 2), np.nan, dtype=complex),
            node_power=injections.net_load,
            losses_kw=np.full(count, np.nan),
        )
        for row in range(count):
            if on_flow is not None:
                on_flow()
            try:
                solve_network(self._net, injections.active_kw[row], injections.reactive_kvar[row])
            except PowerFlowDiverged:
                continue
            ends = self._net.res_line
            result.voltage_pu[row] = self._net.res_bus.vm_pu.to_numpy()[1:]
            result.line_power[row] = KW_PER_MW * away_from_source(
                feeder,
                (ends.p_from_mw + 1j * ends.q_from_mvar).to_numpy(),
                (ends.p_to_mw + 1j * ends.q_to_mvar).to_numpy(),
            )
            result.losses_kw[row] = KW_PER_MW * ends.pl_mw.sum()
        return result


def build_network(scenario: Scenario, feeder: RadialFeeder) -> Any:
    """The feeder as a pandapower network: bus 0 the source, one constant-power load a node."""
    import pandapower

    net = build_feeder(scenario)
    buses = dict(zip(net.bus["name"], net.bus.index, strict=True))
    pandapower.create_loads(
        net, [buses[name] for name in feeder.nodes], p_mw=0.0, q_mvar=0.0, name=feeder.nodes
    )
    return net


def build_feeder(scenario: Scenario) -> Any:
    """Buses, the source's first, and lines, in their order, with nothing on them yet."""
    import pandapower  # imported here: it takes seconds, and the first page must not wait

    source, lines = scenario.feeder.source_node, scenario.lines
    names = [source, *(node.node for node in scenario.nodes if node.node != source)]
    net = deepcopy(_empty_network())
    net.sn_mva = scenario.feeder.base_mva
    created = pandapower.create_buses(net, len(names), scenario.feeder.base_kv, name=names)
    buses = dict(zip(names, created, strict=True))
    pandapower.create_ext_grid(net, buses[source], vm_pu=scenario.feeder.source_voltage_pu)
    if lines:
        pandapower.create_lines_from_parameters(
            net,
            [buses[line.from_node] for line in lines],
            [buses[line.to_node] for line in lines],
            length_km=1.0,
            r_ohm_per_km=[line.r_ohm for line in lines],
            x_ohm_per_km=[line.x_ohm for line in lines],
            c_nf_per_km=0.0,
            max_i_ka=1.0,
            name=[line.name for line in lines],
        )
    return net


@lru_cache(maxsize=1)
def _empty_network() -> Any:
    """Made once and copied: of a small feeder, making its eighty empty tables is nine tenths."""
    import pandapower

    return pandapower.create_empty_network()


def solve_network(net: Any, active_kw: Floats, reactive_kvar: Floats) -> None:
    """Solve for one interval's injections at the nodes; raises PowerFlowDiverged.

    Only loads change from one interval to the next, so what pandapower makes of the network is
    kept: a third of the time. Newton's method starts from a flat profile all the same. From
    another interval's solution it may find the one of low voltage.
    """
    import pandapower
    from pandapower.pypower.idx_bus import VA, VM

    net.load["p_mw"] = -active_kw / KW_PER_MW
    net.load["q_mvar"] = -reactive_kvar / KW_PER_MW
    if net._ppc is not None:
        for buses in (net._ppc["bus"], net._ppc["internal"]["bus"]):
            buses[:, VM], buses[:, VA] = 1.0, 0.0
    try:
        pandapower.runpp(net, recycle=LOADS_CHANGE, **NEWTON)
    except pandapower.LoadflowNotConverged as error:
        raise PowerFlowDiverged("Newton's method found no AC solution") from error
