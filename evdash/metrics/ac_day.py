"""A day as executed in full AC power flow, and what charging did to the feeder there."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from evdash.domain.breach import Breach
from evdash.domain.elements import Element
from evdash.domain.trace import Trace
from evdash.grid.acbreaches import ac_breaches
from evdash.grid.acflow import AcNetwork, AcResult
from evdash.grid.lindistflow import voltage_pu
from evdash.grid.radial import radial_feeder
from evdash.metrics.breaches import in_force_only
from evdash.metrics.records import executed_station_kw


@dataclass(frozen=True, slots=True)
class AcDay:
    """AC power flow of the intervals executed, and every limit exceeded in them."""

    flow: AcResult
    breaches: tuple[Breach, ...]


@dataclass(frozen=True, slots=True)
class AcTroubles:
    """What charging did to the feeder in AC; what it does by itself is left out.

    `longest` is without a break at one element. None where no power flow was asked for, or none
    found a solution.
    """

    voltage_node_intervals: int | None = None
    voltage_depth_pu: float | None = None
    voltage_longest_h: float | None = None
    overload_intervals: int | None = None
    overload_kva: float | None = None
    overload_longest_h: float | None = None
    unsolved: int | None = None
    losses_kwh: float | None = None
    voltage_error_pu: float | None = None


def ac_day(trace: Trace, network: AcNetwork | None = None, base: AcResult | None = None) -> AcDay:
    """AC power flow of what was executed, held against the same intervals without the station.

    `network` and `base`, from `ac_base`, save building and solving them again where several
    days of one feeder are judged.
    """
    scenario, station_kw = trace.scenario, executed_station_kw(trace)
    network = network or AcNetwork(scenario)
    flow = network.flow(scenario, np.arange(len(station_kw)), station_kw)
    without = base or ac_base(trace, network)
    return AcDay(flow, in_force_only(trace, lambda at: ac_breaches(at, flow, without)))


def ac_base(trace: Trace, network: AcNetwork) -> AcResult:
    """The executed intervals without the station."""
    intervals = np.arange(len(trace.steps))
    return network.flow(trace.scenario, intervals, np.zeros(len(intervals)))


def troubles(trace: Trace, ac: AcDay) -> AcTroubles:
    """What charging did to the feeder, counted."""
    hours = trace.scenario.interval_hours
    mine = [breach for breach in ac.breaches if breach.by_station]
    voltage = [breach for breach in mine if breach.element.is_voltage]
    rating = [breach for breach in mine if breach.element.is_rating]
    flow, solved = ac.flow, np.isfinite(ac.flow.losses_kw)
    error = np.abs(_linear_voltage_pu(trace) - flow.voltage_pu)[solved]
    return AcTroubles(
        voltage_node_intervals=len(voltage),
        voltage_depth_pu=max((breach.depth for breach in voltage), default=0.0),
        voltage_longest_h=longest(voltage) * hours,
        overload_intervals=len(rating),
        overload_kva=max((breach.depth for breach in rating), default=0.0),
        overload_longest_h=longest(rating) * hours,
        unsolved=len(flow.diverged),
        losses_kwh=float(flow.losses_kw[solved].sum()) * hours if solved.all() else None,
        voltage_error_pu=float(error.max()) if error.size else None,
    )


def _linear_voltage_pu(trace: Trace) -> np.ndarray:
    """Linearised voltages of the executed intervals, (steps, nodes)."""
    scenario, done = trace.scenario, len(trace.steps)
    station_kw = np.zeros(scenario.intervals)
    station_kw[:done] = executed_station_kw(trace)
    return voltage_pu(scenario, radial_feeder(scenario), station_kw)[:done]


def longest(breaches: Iterable[Breach]) -> int:
    """Most intervals in a row in which one element was beyond its limit."""
    beyond: dict[Element, set[int]] = {}
    for breach in breaches:
        beyond.setdefault(breach.element, set()).add(breach.interval)
    most = 0
    for intervals in beyond.values():
        for first in (t for t in intervals if t - 1 not in intervals):
            last = first
            while last + 1 in intervals:
                last += 1
            most = max(most, last - first + 1)
    return most
