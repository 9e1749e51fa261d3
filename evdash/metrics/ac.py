"""AC power flow of single executed intervals, and which limits it finds exceeded and by whom."""

from dataclasses import dataclass, replace

import numpy as np

from evdash.domain.breach import Breach
from evdash.domain.limits import Floats
from evdash.domain.scenario import Scenario
from evdash.errors import PowerFlowDiverged
from evdash.grid.acbreaches import ac_breaches
from evdash.grid.acflow import AcResult, build_network, solve_network
from evdash.grid.lindistflow import Injections, base_injections, with_station
from evdash.grid.radial import KW_PER_MW, radial_feeder


@dataclass(frozen=True, slots=True)
class AcPoint:
    """One interval in AC: node voltages, NaN where there is no solution, and limits exceeded."""

    voltage_pu: Floats
    breaches: tuple[Breach, ...]

    @property
    def solved(self) -> bool:
        return bool(np.isfinite(self.voltage_pu).all())


class AcNetwork:
    """A scenario's feeder as an AC network, built once and solved interval by interval.

    Not for two threads at once: the network is solved in place.
    """

    def __init__(self, scenario: Scenario) -> None:
        self.feeder = radial_feeder(scenario)
        self._net = build_network(scenario, self.feeder)

    def point(self, scenario: Scenario, interval: int, station_kw: float) -> AcPoint:
        """An interval as executed; `scenario` may differ from the first in all but the feeder."""
        executed = self._solved(scenario, interval, station_kw)
        base = self._solved(scenario, interval, 0.0)
        breaches = ac_breaches(scenario, executed, base)
        return AcPoint(
            executed.voltage_pu[0],
            tuple(replace(breach, interval=interval) for breach in breaches),
        )

    def _solved(self, scenario: Scenario, interval: int, station_kw: float) -> AcResult:
        """AC result of one interval, as a result of one row."""
        every = base_injections(scenario, self.feeder)
        rows = Injections(every.active_kw[[interval]], every.reactive_kvar[[interval]])
        power = with_station(scenario, self.feeder, rows, np.array([station_kw]))
        node_kva = np.hypot(power.active_kw, power.reactive_kvar)
        missing = np.full((1, len(self.feeder.nodes)), np.nan)
        names = self.feeder.nodes, self.feeder.lines
        try:
            solve_network(self._net, power.active_kw[0], power.reactive_kvar[0])
        except PowerFlowDiverged:
            no_lines = np.full((1, len(self.feeder.lines)), np.nan)
            return AcResult(*names, missing, no_lines, node_kva, np.full(1, np.nan))
        ends = self._net.res_line
        from_kva = np.hypot(ends.p_from_mw.to_numpy(), ends.q_from_mvar.to_numpy())
        to_kva = np.hypot(ends.p_to_mw.to_numpy(), ends.q_to_mvar.to_numpy())
        return AcResult(
            *names,
            self._net.res_bus.vm_pu.to_numpy()[None, 1:].copy(),
            KW_PER_MW * np.maximum(from_kva, to_kva)[None, :],
            node_kva,
            KW_PER_MW * ends.pl_mw.to_numpy().sum(keepdims=True),
        )
