"""The feeder over the horizon: line loading, headroom, limits exceeded, linearised against AC."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from evdash.checker.feeder import FeederCheck
from evdash.domain.breach import Breach
from evdash.domain.limits import STATION, Floats
from evdash.domain.outlook import Outlook
from evdash.domain.trace import Trace
from evdash.grid.lindistflow import base_injections, line_flows, with_station
from evdash.grid.radial import radial_feeder
from evdash.metrics.breaches import in_force_only
from evdash.metrics.outlook import spans_in_force

Cause = Literal["station", "both", "feeder"]


@dataclass(frozen=True, slots=True)
class Flows:
    """What flows through each line, kVA, linearised and so lossless.

    Shapes: line_kva with the station and base_line_kva without, (intervals, lines);
    rating_kva (lines,), inf for none. Lines stand in the order of `lines.csv`.
    """

    line_kva: Floats
    base_line_kva: Floats
    rating_kva: Floats


@dataclass(frozen=True, slots=True)
class Violation:
    """One limit exceeded in some intervals for one cause; the worst of them is told.

    `cause`: "station", the limit holds without charging; "feeder", charging changes nothing or
    relieves it; "both", exceeded anyway and worsened by charging. Depths in `unit`.
    """

    element: str
    unit: str
    cause: Cause
    intervals: tuple[int, ...]
    worst: int
    depth: float
    base_depth: float


@dataclass(frozen=True, slots=True)
class Gap:
    """Linearised against AC voltages of one interval, pu: the lowest of each, and where they
    differ most. `difference` is linearised less AC at `node`."""

    interval: int
    lowest_linear: float
    lowest_ac: float
    node: str
    difference: float


def flows(trace: Trace, outlook: Outlook) -> Flows:
    """Loading of every line under the inputs in force in each interval."""
    feeder = radial_feeder(trace.scenario)
    shape = (outlook.n_intervals, len(feeder.lines))
    loaded, base = np.empty(shape), np.empty(shape)
    for inputs, span in spans_in_force(trace):
        scenario, in_force = inputs.scenario, radial_feeder(inputs.scenario)
        without = base_injections(scenario, in_force)
        with_it = with_station(scenario, in_force, without, outlook.station_kw)
        for injections, into in ((without, base), (with_it, loaded)):
            flow = line_flows(in_force, injections)
            into[span] = np.hypot(flow.active_kw, flow.reactive_kvar)[span]
    return Flows(loaded, base, feeder.line_rating_kva)


def tightest(trace: Trace, interval: int, most: int) -> tuple[tuple[str, float], ...]:
    """The elements that leave least room for the station in an interval, and how much, kW."""
    inputs = trace.steps[interval].inputs if interval < trace.now else trace.inputs
    room_kw = inputs.rows.capacity_kw()[interval]
    order = np.argsort(inputs.rows.limit_kw[interval] / inputs.rows.coefficient[:, STATION])
    return tuple((inputs.rows.elements[row], float(room_kw[row])) for row in order[:most])


def day_breaches(trace: Trace, outlook: Outlook) -> tuple[Breach, ...]:
    """Limits exceeded in the linearised model: executed, and planned from now on."""
    station_kw = outlook.station_kw
    return in_force_only(trace, lambda scenario: FeederCheck(scenario).breaches(station_kw))


def violations(breaches: Iterable[Breach]) -> tuple[Violation, ...]:
    """Breaches of one model put together by element and cause, the station's own first."""
    groups: dict[tuple[str, Cause], list[Breach]] = {}
    for breach in breaches:
        groups.setdefault((breach.element, cause_of(breach)), []).append(breach)
    found = []
    for (element, cause), group in groups.items():
        worst = max(group, key=lambda breach: breach.depth)
        intervals = tuple(sorted({breach.interval for breach in group}))
        found.append(
            Violation(
                element,
                worst.unit,
                cause,
                intervals,
                worst.interval,
                worst.depth,
                worst.base_depth,
            )
        )
    order = {"station": 0, "both": 1, "feeder": 2}
    return tuple(sorted(found, key=lambda v: (order[v.cause], -len(v.intervals), v.element)))


def cause_of(breach: Breach) -> Cause:
    """Whose doing it is that a limit is exceeded."""
    if not breach.by_station:
        return "feeder"
    return "both" if breach.base_depth > breach.tolerance else "station"


def gaps(outlook: Outlook, ac_voltage_pu: Mapping[int, Floats]) -> tuple[Gap, ...]:
    """Linearised against AC for every interval that has an AC solution; arrays (nodes,)."""
    found = []
    for t, ac in sorted(ac_voltage_pu.items()):
        if np.isfinite(ac).all():
            difference = outlook.voltage_pu[t] - ac
            i = int(np.abs(difference).argmax())
            found.append(
                Gap(
                    interval=t,
                    lowest_linear=float(outlook.voltage_pu[t].min()),
                    lowest_ac=float(ac.min()),
                    node=outlook.nodes[i],
                    difference=float(difference[i]),
                )
            )
    return tuple(found)
