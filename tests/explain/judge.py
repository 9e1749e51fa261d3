"""An explanation held against P1, each remedy applied by hand where that can be done."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from evdash.domain.limits import LimitRows
from evdash.domain.plan import Policy, Snapshot
from evdash.domain.trace import Trace
from evdash.explain.causes import DOOR, OTHERS
from evdash.explain.changes import changed
from evdash.explain.refusals import Explanation
from evdash.explain.remedies import NoRemedy, Remedy, change_by
from evdash.horizon.advance import snapshot_of
from evdash.horizon.requests import request_for


def problems_of(trace: Trace, told: Explanation, policy: Policy) -> Iterator[str]:
    """Everything an explanation says that P1 does not confirm, in words."""
    if not told.cause.kind or not told.detail.startswith("Refused because "):
        yield f"{told.vehicle}: no cause"
    if told.cause.kind in OTHERS:
        yield f"{told.vehicle}: {told.cause.kind}"
    for remedy in told.remedies:
        who = f"{told.vehicle} in interval {told.interval}, {remedy.kind}"
        if not admits(trace, told, remedy, remedy.amount, policy):
            yield f"{who}: {remedy.amount} does not admit it"
        if admits(trace, told, remedy, remedy.refused_at, policy):
            yield f"{who}: {remedy.refused_at} admits it too"
        if abs(remedy.refused_at) >= abs(remedy.amount):
            yield f"{who}: {remedy.refused_at} is not less than {remedy.amount}"
        if remedy.kind == "headroom" and not _in_its_hours(trace, told, remedy, policy):
            yield f"{who}: {remedy.amount} in {remedy.intervals} alone does not admit it"
    if told.cause.kind in DOOR:
        return
    for none in told.helpless:
        yield from _helps_all_the_same(trace, told, none, policy)


def admits(
    trace: Trace, told: Explanation, remedy: Remedy | NoRemedy, amount: float, policy: Policy
) -> bool:
    snapshot = applied(trace, told, remedy.kind, amount)
    return told.vehicle in policy(snapshot).admitted


def applied(trace: Trace, told: Explanation, kind: str, amount: float) -> Snapshot:
    """The snapshot with a remedy of a P1 refusal applied without the code under test.

    Where the door or the horizon's end has to move, `changed` does it.
    """
    late = told.interval >= trace.scenario.intervals
    step = None if late else trace.steps[told.interval]
    inputs = step.inputs if step else trace.inputs
    snapshot = snapshot_of(inputs, step.before if step else trace.state)
    mine = next(r for r in snapshot.requests if r.vehicle == told.vehicle)
    if kind in ("amount", "max_kw") and amount:
        return _with_request(snapshot, _asking(trace, told, kind, amount))
    later = mine.deadline_interval + (round(amount) if kind == "time" else 0)
    if mine.refusal or later > trace.scenario.intervals:
        return changed(inputs, snapshot, told.vehicle, change_by(kind, amount))
    if kind == "chargers":
        return replace(snapshot, chargers=snapshot.chargers + round(amount))
    if kind == "headroom":
        window = range(mine.deadline_interval - snapshot.now)
        return _with_headroom(snapshot, amount, list(window))
    if kind == "price":
        return _with_request(snapshot, replace(mine, price_per_kwh=mine.price_per_kwh + amount))
    return _with_request(snapshot, replace(mine, deadline_interval=later))


def _asking(trace: Trace, told: Explanation, kind: str, amount: float):
    """The request of an arrival that asks for more or less, or can take more."""
    scenario = trace.steps[told.interval].inputs.scenario
    arrival = next(a for a in trace.inputs.arrivals if a.vehicle == told.vehicle)
    if kind == "amount":
        more = amount * scenario.station.efficiency / arrival.battery_kwh
        arrival = arrival.model_copy(update={"soc_out": arrival.soc_out + more})
    else:
        arrival = arrival.model_copy(update={"max_kw": arrival.max_kw + amount})
    return request_for(scenario, arrival)


def _with_request(snapshot: Snapshot, request) -> Snapshot:
    others = snapshot.requests
    return replace(
        snapshot,
        requests=tuple(request if r.vehicle == request.vehicle else r for r in others),
    )


def _with_headroom(snapshot: Snapshot, more_kw: float, slots: list[int]) -> Snapshot:
    rows = snapshot.rows
    limit_kw = rows.limit_kw.copy()
    limit_kw[slots] = np.maximum(0.0, limit_kw[slots]) + more_kw
    return replace(snapshot, rows=LimitRows(rows.elements, rows.coefficient, limit_kw))


def _in_its_hours(trace: Trace, told: Explanation, remedy: Remedy, policy: Policy) -> bool:
    step = trace.steps[told.interval]
    snapshot = snapshot_of(step.inputs, step.before)
    slots = [interval - told.interval for interval in remedy.intervals]
    widened = _with_headroom(snapshot, remedy.amount, slots)
    return told.vehicle in policy(widened).admitted


def _helps_all_the_same(
    trace: Trace, told: Explanation, none: NoRemedy, policy: Policy
) -> Iterator[str]:
    amounts = {
        "chargers": (1, 2, 5, 50),
        "headroom": (0.1, 1.0, 7.7, 25.0, 1000.0),
        "time": (1, 2, round(none.most) if np.isfinite(none.most) else 3),
        "price": (0.1, 1000.0),
    }
    for amount in amounts[none.kind]:
        if none.proven and admits(trace, told, none, amount, policy):
            yield f"{told.vehicle} in interval {told.interval}: {none.kind} {amount} helps"
