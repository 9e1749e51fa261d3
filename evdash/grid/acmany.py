"""AC power flow of executed schedules in one batch a day: many days of one feeder, quickly.

pandapower stays the referee (`evdash.grid.acflow`); `referee_error_pu` holds one against the other.
"""

import numpy as np

from evdash.domain.limits import Floats
from evdash.domain.scenario import Scenario
from evdash.grid.acbatch import AcBatch
from evdash.grid.acflow import AcResult, ac_flow
from evdash.grid.lindistflow import base_injections, with_station
from evdash.grid.radial import radial_feeder


class ManyDays:
    """A scenario's feeder in AC, solved once without the station, ready for many schedules."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario
        self._feeder = radial_feeder(scenario)
        self._batch = AcBatch(scenario, self._feeder)
        self._injections = base_injections(scenario, self._feeder)
        self.base = self.flow(np.zeros(scenario.intervals))

    def flow(self, station_kw: Floats) -> AcResult:
        """AC power flow of every interval with the station drawing `station_kw` (intervals,)."""
        at = with_station(self.scenario, self._feeder, self._injections, station_kw)
        flows = self._batch.solve(at.active_kw, at.reactive_kvar)
        return AcResult(
            nodes=self._feeder.nodes,
            lines=self._feeder.lines,
            voltage_pu=flows.voltage_pu,
            line_power=flows.line_power,
            node_power=at.net_load,
            losses_kw=flows.losses_kw,
        )


def referee_error_pu(scenario: Scenario, station_kw: Floats, found: AcResult) -> float:
    """Largest difference of a node's voltage from pandapower's, pu.

    Infinite where only one of the two finds a solution, 0 where neither does.
    """
    referee = ac_flow(scenario, station_kw).voltage_pu
    solved = np.isfinite(referee), np.isfinite(found.voltage_pu)
    if not np.array_equal(*solved):
        return float("inf")
    differing = np.abs(referee - found.voltage_pu)[solved[0]]
    return float(differing.max(initial=0.0))
