"""AC power flow of single executed intervals, and which limits it finds exceeded and by whom."""

from dataclasses import dataclass, replace

import numpy as np

from evdash.domain.breach import Breach
from evdash.domain.limits import Floats
from evdash.domain.scenario import Scenario
from evdash.grid.acbreaches import ac_breaches
from evdash.grid.acflow import AcNetwork, AcResult


@dataclass(frozen=True, slots=True)
class AcPoint:
    """One interval in AC: voltages (nodes,) and line flows (lines,), the larger of both ends, NaN
    where there is no solution, and limits exceeded.

    `failure` says why the power flow could not be asked at all, and nothing is known then:
    numbers are NaN, too, and no limit is called kept.
    """

    voltage_pu: Floats
    line_kva: Floats
    breaches: tuple[Breach, ...]
    failure: str = ""

    @property
    def solved(self) -> bool:
        return self.checked and bool(np.isfinite(self.voltage_pu).all())

    @property
    def checked(self) -> bool:
        return not self.failure


def unchecked_point(scenario: Scenario, failure: str) -> AcPoint:
    """An interval of which AC power flow could say nothing."""
    nodes, lines = len(scenario.nodes) - 1, len(scenario.lines)
    return AcPoint(np.full(nodes, np.nan), np.full(lines, np.nan), (), failure)


def without_station(network: AcNetwork, scenario: Scenario, interval: int) -> AcResult:
    """What the feeder does by itself in an interval: a result of one row."""
    return network.flow(scenario, np.array([interval]), np.zeros(1))


def ac_point(
    network: AcNetwork,
    scenario: Scenario,
    interval: int,
    station_kw: float,
    base: AcResult | None = None,
) -> AcPoint:
    """An interval as executed, held against the same interval without the station.

    `base`, from `without_station`, saves solving that again.
    """
    executed = network.flow(scenario, np.array([interval]), np.array([station_kw]))
    base = base or without_station(network, scenario, interval)
    breaches = ac_breaches(scenario, executed, base)
    told = tuple(replace(breach, interval=interval) for breach in breaches)
    return AcPoint(executed.voltage_pu[0], executed.line_kva[0], told)
