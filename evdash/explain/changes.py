"""One thing different at one interval, all else as it was: a snapshot changed for a trial."""

from dataclasses import dataclass, replace

import numpy as np

from evdash.domain.limits import Floats, LimitRows
from evdash.domain.plan import Snapshot
from evdash.domain.trace import Inputs
from evdash.domain.vehicles import Request
from evdash.horizon.requests import promised_intervals, refusal_at_the_door


@dataclass(frozen=True, slots=True)
class Change:
    """What a trial has more of than the step had; nothing by default.

    `chargers`: count. `headroom_kw`: kW in each of `slots` (None: all the vehicle's window).
    For the vehicle in question: `later`, intervals until its return; `price_per_kwh`, $/kWh;
    `need_kwh` and `max_kw`, which also set its time of return anew; `lifted`, its own charger
    takes any power; `bonus`, $ on top of what it pays. `without`: who had not come.
    """

    chargers: int = 0
    headroom_kw: float = 0.0
    slots: tuple[int, ...] | None = None
    later: int = 0
    price_per_kwh: float = 0.0
    need_kwh: float = 0.0
    max_kw: float = 0.0
    lifted: bool = False
    bonus: float = 0.0
    without: frozenset[str] = frozenset()

    @property
    def bears_on_vehicle(self) -> bool:
        """Whether any of it is the vehicle's own and not the same for all."""
        own = (self.later, self.price_per_kwh, self.need_kwh, self.max_kw, self.bonus)
        return self.lifted or any(own)

    @property
    def reshapes_vehicle(self) -> bool:
        """Whether the vehicle's power or window may differ."""
        return self.lifted or any((self.later, self.need_kwh, self.max_kw))

    def is_within(self, more: "Change") -> bool:
        """Whether `more` is the same or more of headroom and chargers, with nothing else."""
        if replace(self, chargers=0, headroom_kw=0.0, slots=None) != NOTHING:
            return False
        if replace(more, chargers=0, headroom_kw=0.0, slots=None) != NOTHING:
            return False
        if self.chargers > more.chargers:
            return False
        if not self.headroom_kw:
            return True
        known = self.slots is not None and more.slots is not None
        within = known and set(self.slots or ()) <= set(more.slots or ())
        return self.headroom_kw <= more.headroom_kw and (within or self.slots == more.slots)


NOTHING = Change()


def changed(inputs: Inputs, snapshot: Snapshot, vehicle: str, change: Change) -> Snapshot:
    """The snapshot with `change`, each request held against the door anew where it matters.

    A return beyond the horizon's end lengthens the horizon for this vehicle alone; the added
    slots have the price and the limits of the last interval.
    """
    requests = tuple(
        asked(inputs, snapshot, r, change if r.vehicle == vehicle else _of_all(change))
        for r in snapshot.requests
        if r.vehicle not in change.without
    )
    ends = next(r.deadline_interval for r in requests if r.vehicle == vehicle)
    lasting = longer(inputs, snapshot, ends - snapshot.now)
    slots = tuple(range(ends - snapshot.now)) if change.slots is None else change.slots
    return replace(
        lasting,
        chargers=snapshot.chargers + change.chargers,
        requests=requests,
        rows=_with_headroom(lasting.rows, change.headroom_kw, slots),
    )


def asked(inputs: Inputs, snapshot: Snapshot, request: Request, change: Change) -> Request:
    """A request with what `change` makes of it, judged at the door anew."""
    if change == NOTHING:
        return request
    scenario, chargers = inputs.scenario, snapshot.chargers + change.chargers
    need = request.need_kwh + change.need_kwh
    max_kw, deadline = request.max_kw + change.max_kw, request.deadline_interval
    if change.need_kwh or change.max_kw:
        average_kw = scenario.options_by_name[request.option].average_kw
        promised = promised_intervals(need, average_kw, max_kw, scenario.interval_hours)
        deadline = min(request.arrival_interval + promised, scenario.intervals)
    anew = replace(
        request,
        need_kwh=need,
        max_kw=max(max_kw, need / scenario.interval_hours) if change.lifted else max_kw,
        deadline_interval=deadline + change.later,
    )
    anew = anew.paying_more(change.price_per_kwh).with_bonus(change.bonus)
    station = scenario.station.model_copy(update={"chargers": chargers})
    return replace(anew, refusal=refusal_at_the_door(scenario.replacing(station=station), anew))


def _of_all(change: Change) -> Change:
    """The part of a change that bears on other vehicles' requests."""
    return Change(chargers=change.chargers)


def longer(inputs: Inputs, snapshot: Snapshot, n_slots: int) -> Snapshot:
    """The snapshot with at least `n_slots` slots, the last interval's conditions going on."""
    added = n_slots - snapshot.n_slots
    if added <= 0:
        return snapshot
    rows, contracts = inputs.rows, len(snapshot.contracts)
    limit_kw = np.vstack([snapshot.rows.limit_kw, np.repeat(rows.limit_kw[-1:], added, axis=0)])
    slots = np.minimum(snapshot.now + np.arange(n_slots), inputs.scenario.intervals - 1)
    return replace(
        snapshot,
        tariff=inputs.scenario.tariff[slots],
        rows=LimitRows(rows.elements, rows.coefficient, limit_kw),
        tail_kw=np.hstack([snapshot.tail_kw, np.zeros((contracts, added))]),
    )


def _with_headroom(rows: LimitRows, more_kw: float, slots: tuple[int, ...]) -> LimitRows:
    """Headroom is never below zero, so more of it counts from zero, too."""
    if more_kw == 0 or not rows.elements:
        return rows
    limit_kw: Floats = rows.limit_kw.copy()
    chosen = list(slots)
    limit_kw[chosen] = np.maximum(0.0, limit_kw[chosen]) + more_kw * rows.coefficient[:, 0]
    return LimitRows(rows.elements, rows.coefficient, limit_kw)
