"""Which element sets the headroom in which hours, and when it was reached."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from evdash.domain.elements import CHARGERS, Element
from evdash.domain.limits import STATION
from evdash.domain.trace import Step, Trace
from evdash.domain.words import element_words
from evdash.explain.words import Clock

REACHED_KW = 0.05
REACHED_SHARE = 1e-3
"""Within 0.05 kW or 0.1 % of its limit an element counts as reached."""


@dataclass(frozen=True, slots=True)
class Binding:
    """One element and its intervals.

    `tightest`: it sets the headroom, whether reached or not (never for chargers). `reached`:
    the station drew all it leaves or, for chargers, all were in use.
    """

    element: Element
    tightest: tuple[int, ...]
    reached: tuple[int, ...]


def binding_elements(trace: Trace) -> tuple[Binding, ...]:
    """Every element that was tightest or reached in the intervals executed, most often first."""
    tightest: dict[Element, list[int]] = {}
    reached: dict[Element, list[int]] = {}
    for step in trace.steps:
        if element := step.inputs.rows.binding()[step.interval]:
            tightest.setdefault(element, []).append(step.interval)
        for element in reached_in(step):
            reached.setdefault(element, []).append(step.interval)
    table = [
        Binding(element, tuple(tightest.get(element, ())), tuple(reached.get(element, ())))
        for element in dict.fromkeys([*tightest, *reached])
    ]
    return tuple(sorted(table, key=lambda row: (-len(row.reached), -len(row.tightest))))


def binding_told(trace: Trace) -> tuple[str, ...]:
    """For each element a sentence: when it sets the headroom, when it is reached."""
    if not trace.steps:
        return ()
    clock = Clock(trace.scenario, trace.steps[0].interval)
    return tuple(_told(row, clock) for row in binding_elements(trace))


def _told(row: Binding, clock: Clock) -> str:
    if row.element == CHARGERS:
        return f"All chargers are in use {clock.spans(row.reached)}."
    named = element_words(row.element, clock.scenario)
    sets = f"sets the headroom {clock.spans(row.tightest)}" if row.tightest else ""
    if not row.reached:
        return f"{named[:1].upper()}{named[1:]} {sets}, and is never reached."
    joint = "and is reached" if sets else "is reached"
    return f"{named[:1].upper()}{named[1:]} {sets} {joint} {clock.spans(row.reached)}.".replace(
        "  ", " "
    )


def reached_in(step: Step) -> Iterator[Element]:
    """The elements reached in the interval a step carried out."""
    rows, interval = step.inputs.rows, step.interval
    room_kw = np.maximum(0.0, rows.limit_kw[interval]) / rows.coefficient[:, STATION]
    left_kw = room_kw - step.station_kw
    near_kw = np.maximum(REACHED_KW, REACHED_SHARE * room_kw)
    # a row without a limit in this interval has all the room there is, and is never reached
    for row in np.flatnonzero(np.isfinite(room_kw) & (left_kw <= near_kw)):
        yield rows.elements[row]
    if 0 < step.inputs.scenario.station.chargers <= int(step.plan.charging[0]):
        yield CHARGERS
