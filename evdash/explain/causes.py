"""What refused a vehicle, found by solving again with one thing relaxed."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from evdash.domain.vehicles import Request
from evdash.explain.changes import NOTHING, Change
from evdash.explain.trials import Trials
from evdash.horizon.requests import CEIL_TOLERANCE

CauseKind = Literal[
    "after the end",
    "no chargers",
    "unattainable",
    "end of horizon",
    "price",
    "displaced",
    "headroom",
    "chargers",
    "headroom or chargers",
    "headroom and chargers",
    "time",
    "promises short",
    "not P1",
    "not known",
]
DOOR: tuple[CauseKind, ...] = ("after the end", "no chargers", "unattainable", "end of horizon")
"""Refused whatever the others do: no schedule could serve such a request."""

REACHED_KW = 1e-6


@dataclass(frozen=True, slots=True)
class Taken:
    """Where room was missing: intervals, each with the element that sets the headroom.

    `headroom`: (interval, element) pairs; `chargers`: intervals in which all were in use.
    """

    headroom: tuple[tuple[int, str], ...] = ()
    chargers: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Cause:
    """What refused a vehicle.

    `displaced_by`: newcomers without whom it would have been admitted. `loss` in $: by how
    much admitting it would have lowered the profit of what was known then; None where no
    plan with it was found. `energy_cost` in $: what its energy would have cost beside the
    contracts alone; None unless that is the cause. `then`: what would have refused it next,
    had there been as much room as it likes; blank if nothing.
    """

    kind: CauseKind
    taken: Taken = Taken()
    displaced_by: tuple[Request, ...] = ()
    loss: float | None = None
    energy_cost: float | None = None
    then: Literal["", "displaced", "price"] = ""


def kind_at_the_door(trials: Trials) -> CauseKind | None:
    """Which of the door's conditions turned the vehicle away; None if it was let in.

    The same order as at the door itself.
    """
    request, hours = trials.request, trials.snapshot.interval_hours
    if not request.refusal:
        return None
    if trials.window <= 0:
        return "after the end"
    if trials.snapshot.chargers == 0:
        return "no chargers"
    return "unattainable" if unattainable(request, hours) else "end of horizon"


def unattainable(request: Request, interval_hours: float) -> bool:
    """Whether no number of intervals, however many, can hold what the vehicle needs."""
    mean_kw = request.need_kwh / interval_hours
    fewest = int(np.ceil(mean_kw / request.max_kw - CEIL_TOLERANCE))
    return max(1, fewest) * min(request.min_kw, mean_kw) > mean_kw + CEIL_TOLERANCE or (
        request.max_kw < min(request.min_kw, mean_kw) - CEIL_TOLERANCE
    )


def unlimited(trials: Trials, *, headroom: bool = False, chargers: bool = False) -> Change:
    """A change with so much headroom, or so many chargers, that they cannot bind."""
    return Change(
        headroom_kw=trials.all_power_kw if headroom else 0.0,
        chargers=trials.idle_chargers if chargers else 0,
    )


def cause_of(trials: Trials) -> Cause:
    """The cause of a refusal by P1.

    If the vehicle fits beside the contracts, it was money: displaced by newcomers if it would
    have come in without them, its price if not. If it does not fit, that is relaxed first
    which is the vehicle's own (the power it can take, so that its time would do), then
    headroom and chargers, each alone.
    """
    if trials.fits():
        return _outbid(trials)
    kind: CauseKind
    with_headroom = trials.fits(unlimited(trials, headroom=True))
    with_chargers = trials.fits(unlimited(trials, chargers=True))
    if trials.fits(Change(lifted=True)):
        kind = "time"
    elif with_headroom and with_chargers:
        kind = "headroom or chargers"
    elif with_headroom:
        kind = "headroom"
    elif with_chargers:
        kind = "chargers"
    else:
        kind = "headroom and chargers"
    return Cause(
        kind,
        taken=_taken(trials, with_headroom, with_chargers),
        then=_next_cause(trials, unlimited(trials, headroom=with_headroom, chargers=with_chargers)),
    )


def _next_cause(trials: Trials, room: Change) -> Literal["", "displaced", "price"]:
    """What refuses the vehicle once there is room."""
    if room == NOTHING or trials.admits(room):
        return ""
    return "displaced" if trials.admits(replace(room, without=trials.others)) else "price"


def _outbid(trials: Trials) -> Cause:
    loss = _finite(trials.cost_with() - trials.cost_without)
    alone = Change(without=trials.others)
    if not trials.admits(alone):
        more = trials.cost_with(alone) - trials.cost(alone)
        return Cause("price", loss=loss, energy_cost=_finite(more + trials.request.revenue))
    return Cause("displaced", displaced_by=_displacers(trials), loss=loss)


def _finite(usd: float) -> float | None:
    return float(usd) if np.isfinite(usd) else None


def _displacers(trials: Trials) -> tuple[Request, ...]:
    """The newcomers without whom it would have come in: few of them if few will do."""
    admitted = frozenset(trials.base.admitted)
    forced = trials.forced()
    dropped = admitted - frozenset(forced.admitted if forced else ())
    for names in (dropped, admitted, trials.others):
        if names and trials.admits(Change(without=names)):
            return tuple(r for r in trials.snapshot.requests if r.vehicle in names)
    return ()


def _taken(trials: Trials, with_headroom: bool, with_chargers: bool) -> Taken:
    """Where a plan that holds the vehicle goes beyond what there is.

    `with_headroom`, `with_chargers`: which of them, relaxed alone, make such a plan possible;
    where neither does, both are relaxed.
    """
    if not with_headroom and not with_chargers:
        return beyond(trials, unlimited(trials, headroom=True, chargers=True))
    headroom = beyond(trials, unlimited(trials, headroom=True)).headroom
    chargers = beyond(trials, unlimited(trials, chargers=True)).chargers
    return Taken(headroom if with_headroom else (), chargers if with_chargers else ())


def beyond(trials: Trials, change: Change) -> Taken:
    """Where a plan for the contracts and the vehicle, under a change, goes beyond what there is."""
    plan = trials.forced(replace(change, without=trials.others))
    if plan is None:
        return Taken()
    return Taken(
        headroom=tuple(
            (trials.snapshot.now + slot, element_at(trials, slot))
            for slot in slots_beyond_headroom(trials, plan.station_kw)
        ),
        chargers=tuple(
            trials.snapshot.now + int(slot)
            for slot in np.flatnonzero(plan.charging > trials.snapshot.chargers)
        ),
    )


def slots_beyond_headroom(trials: Trials, station_kw: np.ndarray) -> tuple[int, ...]:
    """Slots in which a station power (slots,) is beyond the headroom there is."""
    snapshot = trials.snapshot
    room = np.maximum(snapshot.rows.headroom_kw(), snapshot.tail_kw.sum(axis=0))
    known = min(len(room), len(station_kw))
    return tuple(
        int(slot) for slot in np.flatnonzero(station_kw[:known] > room[:known] + REACHED_KW)
    )


def element_at(trials: Trials, slot: int) -> str:
    """The tightest element of a slot."""
    return trials.snapshot.rows.binding()[slot]
