"""What each vehicle asks for and whether any schedule could serve it, worked out from the scenario.

The audit's own derivation from arrivals, options and station.
"""

import math
from dataclasses import dataclass
from typing import Literal

from evdash.audit.events import chargers_at
from evdash.domain.arrivals import Arrival, RecordedArrivals
from evdash.domain.scenario import PriceOption, Scenario

ROUNDING = 1e-9
Door = Literal["", "after the end", "no chargers", "unattainable", "end of horizon"]
"""Why no schedule whatever could serve a vehicle; empty where one might."""


@dataclass(frozen=True, slots=True)
class Asked:
    """A vehicle's request: energy in kWh, grid side, in intervals [first, deadline)."""

    arrival: Arrival
    option: PriceOption
    need_kwh: float
    first: int
    deadline: int
    min_kw: float
    max_kw: float
    door: Door

    @property
    def revenue(self) -> float:
        """What its driver pays in full, $."""
        return self.option.price_per_kwh * self.need_kwh


def everyone_asked(scenario: Scenario) -> dict[str, Asked]:
    """What everyone asks for, by name, in order of arrival."""
    known = scenario.arrivals
    arrivals = known.vehicles if isinstance(known, RecordedArrivals) else ()
    in_order = sorted(arrivals, key=lambda arrival: arrival.arrival)
    return {arrival.vehicle: _asked(scenario, arrival) for arrival in in_order}


def _asked(scenario: Scenario, arrival: Arrival) -> Asked:
    station, hours = scenario.station, scenario.interval_minutes / 60
    option = next(option for option in scenario.option if option.name == arrival.option)
    need = (arrival.soc_out - arrival.soc_in) * arrival.battery_kwh / station.efficiency
    max_kw = min(station.max_kw, arrival.max_kw or math.inf)
    minutes = (arrival.arrival - scenario.start).total_seconds() / 60
    first = math.ceil(minutes / scenario.interval_minutes)
    average_kw = min(option.average_kw, max_kw)
    stay = max(1, math.ceil(need / (average_kw * hours) - ROUNDING))
    deadline = min(first + stay, scenario.intervals)
    chargers = chargers_at(scenario, first)
    door = _door(need / hours, station.min_kw, max_kw, deadline - first, chargers)
    return Asked(arrival, option, need, first, deadline, station.min_kw, max_kw, door)


def _door(mean_kw: float, min_kw: float, max_kw: float, left: int, chargers: int) -> Door:
    """`mean_kw`: the need in kW of one interval; it may take several, each from lowest to max."""
    if left <= 0:
        return "after the end"
    if chargers == 0:
        return "no chargers"
    lowest = min(min_kw, mean_kw)
    fewest = max(1, math.ceil(mean_kw / max_kw - ROUNDING))
    # more intervals than the fewest take more at the least, so that the fewest decide
    if lowest > max_kw + ROUNDING or fewest * lowest > mean_kw + ROUNDING:
        return "unattainable"
    return "end of horizon" if fewest > left else ""
