"""AC power flow of the executed schedule by pandapower: the referee of every answer."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from evdash.domain.limits import Floats
from evdash.domain.scenario import Scenario
from evdash.errors import PowerFlowDiverged
from evdash.grid.lindistflow import Injections, base_injections, with_station
from evdash.grid.radial import KW_PER_MW, RadialFeeder, radial_feeder


@dataclass(frozen=True, slots=True)
class AcResult:
    """AC solution per interval; NaN where there is none.

    Shapes: voltage_pu and node_kva, the net injection, (intervals, nodes); line_kva
    (intervals, lines), the larger of both ends; losses_kw (intervals,).
    """

    nodes: tuple[str, ...]
    lines: tuple[str, ...]
    voltage_pu: Floats
    line_kva: Floats
    node_kva: Floats
    losses_kw: Floats

    @property
    def diverged(self) -> tuple[int, ...]:
        """Rows without an AC solution."""
        return tuple(int(row) for row in np.flatnonzero(np.isnan(self.losses_kw)))


def ac_flow(scenario: Scenario, station_kw: Floats, first_interval: int = 0) -> AcResult:
    """AC power flow of intervals from `first_interval` on, one for each entry of `station_kw`.

    Loads, generation, shunts and the station draw constant power. An interval in which
    Newton's method finds no solution is left NaN.
    """
    feeder = radial_feeder(scenario)
    every = base_injections(scenario, feeder)
    rows = slice(first_interval, first_interval + len(station_kw))
    base = Injections(every.active_kw[rows], every.reactive_kvar[rows])
    injections = with_station(scenario, feeder, base, station_kw)
    net = build_network(scenario, feeder)
    shape = (len(station_kw), len(feeder.nodes)), (len(station_kw), len(feeder.lines))
    result = AcResult(
        feeder.nodes,
        feeder.lines,
        np.full(shape[0], np.nan),
        np.full(shape[1], np.nan),
        np.hypot(injections.active_kw, injections.reactive_kvar),
        np.full(len(station_kw), np.nan),
    )
    for row in range(len(station_kw)):
        try:
            solve_network(net, injections.active_kw[row], injections.reactive_kvar[row])
        except PowerFlowDiverged:
            continue
        result.voltage_pu[row] = net.res_bus.vm_pu.to_numpy()[1:]
        ends = net.res_line
        result.line_kva[row] = KW_PER_MW * np.maximum(
            np.hypot(ends.p_from_mw, ends.q_from_mvar), np.hypot(ends.p_to_mw, ends.q_to_mvar)
        )
        result.losses_kw[row] = KW_PER_MW * ends.pl_mw.sum()
    return result


def build_network(scenario: Scenario, feeder: RadialFeeder) -> Any:
    """The feeder as a pandapower network: bus 0 the source, one constant-power load a node."""
    import pandapower  # imported here: it takes seconds, and the first page must not wait

    net = pandapower.create_empty_network(sn_mva=scenario.feeder.base_mva)
    buses = {
        name: pandapower.create_bus(net, vn_kv=scenario.feeder.base_kv, name=name)
        for name in (scenario.feeder.source_node, *feeder.nodes)
    }
    source = buses[scenario.feeder.source_node]
    pandapower.create_ext_grid(net, source, vm_pu=scenario.feeder.source_voltage_pu)
    for line in scenario.lines:
        pandapower.create_line_from_parameters(
            net,
            buses[line.from_node],
            buses[line.to_node],
            length_km=1.0,
            r_ohm_per_km=line.r_ohm,
            x_ohm_per_km=line.x_ohm,
            c_nf_per_km=0.0,
            max_i_ka=1.0,
            name=line.name,
        )
    for name in feeder.nodes:
        pandapower.create_load(net, buses[name], p_mw=0.0, q_mvar=0.0, name=name)
    return net


def solve_network(net: Any, active_kw: Floats, reactive_kvar: Floats) -> None:
    """Solve for one interval's injections at the nodes; raises PowerFlowDiverged."""
    import pandapower

    net.load["p_mw"] = -active_kw / KW_PER_MW
    net.load["q_mvar"] = -reactive_kvar / KW_PER_MW
    try:
        pandapower.runpp(net, numba=False, tolerance_mva=1e-8, init="flat", max_iteration=30)
    except pandapower.LoadflowNotConverged as error:
        raise PowerFlowDiverged("Newton's method found no AC solution") from error
