"""Figures of a run that cases tell; hours are clock times of its first day, `HH:MM`."""

import math
from collections.abc import Sequence

from evdash.domain.elements import Element
from evdash.domain.refusal import RefusalKind
from evdash.domain.trace import Step, Trace
from evdash.explain.binding import REACHED_KW
from evdash.explain.words import Clock
from evdash.grid.radial import radial_feeder
from evdash.metrics.records import executed_power

MIDNIGHT = "24:00"
FULL = 0.99
"""So much of its headroom in use, the feeder counts as nearly full."""


def between(trace: Trace, begin: str, end: str = MIDNIGHT) -> list[Step]:
    """Steps of the first day whose intervals begin from `begin` on and before `end`."""
    first = trace.scenario.start.date()
    steps = [step for step in trace.steps if step.start.date() == first]
    return [step for step in steps if begin <= f"{step.start:%H:%M}" < end]


def headroom_kw(step: Step) -> float:
    """The most the station may draw in the interval of a step."""
    return float(step.inputs.rows.headroom_kw()[step.interval])


def is_nearly_full(step: Step) -> bool:
    """Whether the station draws nearly all that the feeder leaves."""
    return step.station_kw >= min(FULL * headroom_kw(step), headroom_kw(step) - REACHED_KW)


def too_low_by_itself(trace: Trace) -> list[Step]:
    """Steps in whose intervals, in AC, some voltage is too low without a single vehicle."""
    # a library that the first page is not to wait for
    from evdash.grid.acmany import ManyDays  # noqa: PLC0415

    lowest_pu = ManyDays(trace.scenario).base.voltage_pu.min(axis=1)
    limit_pu = trace.scenario.feeder.voltage_min_pu
    return [step for step in trace.steps if lowest_pu[step.interval] < limit_pu]


def binding(step: Step) -> Element | None:
    """The element that sets the headroom of the interval of a step."""
    return step.inputs.rows.binding()[step.interval]


def in_use(step: Step) -> int:
    """Chargers in use in the interval of a step."""
    return int(step.plan.charging[0])


def asked(steps: Sequence[Step]) -> int:
    """How many vehicles asked."""
    return sum(len(step.requests) for step in steps)


def refused(steps: Sequence[Step], *kinds: RefusalKind) -> int:
    """How many were refused, for reasons of some kinds where any are named."""
    reasons = [refusal.reason.kind for step in steps for refusal in step.plan.refused]
    return sum(kind in kinds for kind in reasons) if kinds else len(reasons)


def drawn_kwh(steps: Sequence[Step]) -> float:
    """Energy the station drew in the intervals of steps."""
    return math.fsum(step.station_kw * step.inputs.scenario.interval_hours for step in steps)


def charged_kwh(trace: Trace, asked_in: Sequence[Step]) -> dict[int, float]:
    """Energy by interval given to those who were admitted in some steps."""
    admitted = {vehicle for step in asked_in for vehicle in step.plan.admitted}
    found: dict[int, float] = {}
    for interval, vehicle, power_kw in executed_power(trace):
        if vehicle in admitted:
            kwh = power_kw * trace.scenario.interval_hours
            found[interval] = found.get(interval, 0.0) + kwh
    return found


def promised_hours(trace: Trace, option: str) -> float:
    """Mean time from arrival to the promised return of those admitted on an option, in h."""
    windows = [
        request.deadline_interval - request.arrival_interval
        for step in trace.steps
        for request in step.requests
        if request.option == option and request.vehicle in step.plan.admitted
    ]
    hours = trace.scenario.interval_hours
    return hours * sum(windows) / len(windows) if windows else math.nan


def is_behind(trace: Trace, node: str) -> bool:
    """Whether all that flows to a node passes the station's node."""
    feeder, station = radial_feeder(trace.scenario), trace.scenario.station.node
    if not {node, station} <= set(feeder.nodes) or node == station:
        return False
    here, there = (feeder.on_way[feeder.node_index(one)] for one in (station, node))
    return bool((there >= here).all())


def when(steps: Sequence[Step]) -> str:
    """When the intervals of steps are: `from 16:00 to 20:00`; `never` where there are none."""
    clock = Clock(steps[0].inputs.scenario, steps[0].interval) if steps else None
    return clock.spans(step.interval for step in steps) if clock else "never"
