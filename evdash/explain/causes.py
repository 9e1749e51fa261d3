"""What refused a vehicle: the reason its step gave, and what solving again adds to it."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from evdash.domain.elements import Element
from evdash.domain.refusal import RefusalKind, RefusalReason
from evdash.domain.vehicles import Request
from evdash.explain.changes import NOTHING, Change
from evdash.explain.trials import Trials
from evdash.horizon.requests import refusal_at_the_door
from evdash.scheduling.refused import reason_of

DOOR: tuple[RefusalKind, ...] = ("after the end", "no chargers", "unattainable", "end of horizon")
"""Refused whatever the others do: no schedule could serve such a request."""
ROOM: tuple[RefusalKind, ...] = (
    "feeder",
    "headroom",
    "chargers",
    "headroom or chargers",
    "headroom and chargers",
)
"""Refused because no plan holds it beside the contracts."""
OTHERS: tuple[RefusalKind, ...] = (
    "rule",
    "kept for others",
    "best day",
    "left out",
    "policy",
    "fallback",
    "as told",
)
"""Not a reason of P1's own, so that P1 may be asked what it would have said."""

REACHED_KW = 1e-6


@dataclass(frozen=True, slots=True)
class Taken:
    """Where room was missing: intervals, each with the element that sets the headroom.

    `headroom`: (interval, element) pairs; `chargers`: intervals in which all were in use.
    """

    headroom: tuple[tuple[int, Element | None], ...] = ()
    chargers: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Cause:
    """The reason for which a vehicle was refused, and what solving again adds to it.

    `displaced_by`: newcomers who took its place; `only_by`: without them it would have come in
    even with everyone else who asked, not just beside the others admitted. `loss` in $: by how
    much admitting it would have lowered the profit of what was known then; None where no plan
    with it was found. `then`: what would have refused it next, had there been as much room as
    it likes; blank if
    nothing. `by_pace`: there is room before its return, not at the pace of its own charger.
    """

    reason: RefusalReason
    taken: Taken = Taken()
    displaced_by: tuple[Request, ...] = ()
    only_by: bool = False
    loss: float | None = None
    then: Literal["", "displaced", "price"] = ""
    by_pace: bool = False

    @property
    def kind(self) -> RefusalKind:
        return self.reason.kind


def at_the_door(trials: Trials) -> RefusalReason | None:
    """The reason with which the vehicle was turned away at the door; None if it was let in."""
    given = trials.request.refusal
    if given is not None and given.kind == "as told":
        return refusal_at_the_door(trials.inputs.scenario, trials.request) or given
    return given


def unlimited(trials: Trials, *, headroom: bool = False, chargers: bool = False) -> Change:
    """A change with so much headroom, or so many chargers, that they cannot bind."""
    return Change(
        headroom_kw=trials.all_power_kw if headroom else 0.0,
        chargers=trials.idle_chargers if chargers else 0,
    )


def reason_by_p1(trials: Trials) -> RefusalReason:
    """What P1 itself says, of the vehicle as it asked."""
    return reason_of(trials.snapshot, trials.request, trials.base, trials.policy)


def cause_of(trials: Trials, reason: RefusalReason) -> Cause:
    """What there is to add to a reason of P1's."""
    if reason.kind in ROOM:
        with_headroom = reason.kind not in ("chargers", "headroom and chargers")
        with_chargers = reason.kind in ("chargers", "headroom or chargers")
        room = unlimited(trials, headroom=with_headroom, chargers=with_chargers)
        return Cause(
            reason,
            taken=_taken(trials, with_headroom, with_chargers),
            then=_next_cause(trials, room),
            by_pace=reason.kind != "chargers" and trials.fits(Change(lifted=True)),
        )
    by = tuple(r for r in trials.snapshot.requests if r.vehicle in reason.by)
    only_by = bool(by) and trials.admits(Change(without=frozenset(reason.by)))
    return Cause(
        reason,
        displaced_by=by,
        only_by=only_by,
        loss=_finite(trials.cost_with() - trials.cost_without),
    )


def _next_cause(trials: Trials, room: Change) -> Literal["", "displaced", "price"]:
    """What refuses the vehicle once there is room."""
    if room == NOTHING or trials.admits(room):
        return ""
    return "displaced" if trials.admits(replace(room, without=trials.others)) else "price"


def _finite(usd: float) -> float | None:
    return float(usd) if np.isfinite(usd) else None


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


def element_at(trials: Trials, slot: int) -> Element | None:
    """The tightest element of a slot."""
    return trials.snapshot.rows.binding()[slot]
