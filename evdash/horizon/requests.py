"""From an arrival to a request: need, time of return, and whether any schedule could serve it."""

import math
from collections.abc import Iterable
from dataclasses import replace
from datetime import datetime, timedelta
from functools import partial

from evdash.domain.arrivals import Arrival
from evdash.domain.refusal import RefusalReason
from evdash.domain.scenario import Scenario
from evdash.domain.vehicles import Request

CEIL_TOLERANCE = 1e-9
"""Keeps (0.8 − 0.2)·40/4.8 at 5 intervals where floating point says 5.000000000000001."""


def need_kwh(arrival: Arrival, efficiency: float) -> float:
    """Grid-side energy asked for, kWh: s_n = (SOC_out − SOC_in)·Bcap/η."""
    return (arrival.soc_out - arrival.soc_in) * arrival.battery_kwh / efficiency


def first_interval(scenario: Scenario, arrival: datetime) -> int:
    """Decision 1: the first interval that begins at or after the arrival."""
    return math.ceil((arrival - scenario.start) / timedelta(minutes=scenario.interval_minutes))


def promised_intervals(need_kwh: float, average_kw: float, max_kw: float, hours: float) -> int:
    """Time of return: a_n = ⌈s_n / P_Cj⌉, no faster than the vehicle itself can charge.

    At least one interval: next to no energy still takes a moment.
    """
    return max(1, math.ceil(need_kwh / (min(average_kw, max_kw) * hours) - CEIL_TOLERANCE))


def request_for(scenario: Scenario, arrival: Arrival) -> Request:
    """The request an arrival makes under the scenario's options and station limits."""
    option = scenario.options_by_name[arrival.option]
    station = scenario.station
    need = need_kwh(arrival, station.efficiency)
    max_kw = station.max_kw if arrival.max_kw is None else min(station.max_kw, arrival.max_kw)
    first = first_interval(scenario, arrival.arrival)
    promised = promised_intervals(need, option.average_kw, max_kw, scenario.interval_hours)
    request = Request(
        vehicle=arrival.vehicle,
        option=arrival.option,
        arrival=arrival.arrival,
        arrival_interval=first,
        deadline_interval=min(first + promised, scenario.intervals),
        need_kwh=need,
        price_per_kwh=option.price_per_kwh,
        min_kw=station.min_kw,
        max_kw=max_kw,
        battery_kwh=arrival.battery_kwh,
        soc_in=arrival.soc_in,
        soc_out=arrival.soc_out,
    )
    return replace(request, refusal=refusal_at_the_door(scenario, request))


def requests_by_interval(
    scenario: Scenario, arrivals: Iterable[Arrival]
) -> tuple[tuple[Request, ...], ...]:
    """Requests grouped by the interval they take part from; one extra group for the too late."""
    groups: list[list[Request]] = [[] for _ in range(scenario.intervals + 1)]
    for arrival in arrivals:
        request = request_for(scenario, arrival)
        groups[request.arrival_interval].append(request)
    return tuple(tuple(group) for group in groups)


def refusal_at_the_door(scenario: Scenario, request: Request) -> RefusalReason | None:
    """Decision 3: why no schedule whatever could serve the request, or None."""
    hours = scenario.interval_hours
    mean_kw = request.need_kwh / hours
    lowest_kw = min(request.min_kw, mean_kw)
    slots = request.deadline_interval - request.arrival_interval
    if slots <= 0:
        return RefusalReason("after the end")
    if scenario.station.chargers == 0:
        return RefusalReason("no chargers")
    told = partial(
        RefusalReason, need_kwh=request.need_kwh, max_kw=request.max_kw, low_kw=lowest_kw
    )
    if request.max_kw < lowest_kw - CEIL_TOLERANCE:
        return told("unattainable")
    fewest = math.ceil(mean_kw / request.max_kw - CEIL_TOLERANCE)
    if fewest * lowest_kw > mean_kw + CEIL_TOLERANCE:
        return told("unattainable", intervals=fewest)
    if fewest > slots:
        return told("end of horizon", intervals=fewest, left=slots)
    return None
