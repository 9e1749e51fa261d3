"""What a step changed in the plan of the step before, and why."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from evdash.domain.limits import Floats
from evdash.domain.plan import Policy
from evdash.domain.trace import Happening, Step, Trace
from evdash.domain.words import some_money
from evdash.explain.words import Clock, counted, listed
from evdash.horizon.advance import snapshot_of
from evdash.scheduling.p1 import p1_plans

MOVED_KW = 1e-6
A_CENT = 0.01
NAMED = 3


@dataclass(frozen=True, slots=True)
class Move:
    """Energy of one contract planned for one interval before, for another now."""

    vehicle: str
    from_interval: int
    to_interval: int
    energy_kwh: float


@dataclass(frozen=True, slots=True)
class Revision:
    """Step `interval`'s plan for the contracts held against the plan of the step before.

    `cost_change` in $ of energy, at the prices now in force. `for_newcomers_kwh`: what of
    `moved_kwh` would have stayed where it was had nobody new been admitted.
    """

    interval: int
    moves: tuple[Move, ...]
    cost_change: float
    for_newcomers_kwh: float
    admitted: tuple[str, ...]
    edited: tuple[str, ...]
    text: str

    @property
    def moved_kwh(self) -> float:
        """Energy that changed its interval, kWh."""
        return sum(move.energy_kwh for move in self.moves)


def explain_revision(trace: Trace, interval: int, policy: Policy | None = None) -> Revision:
    """What the step at `interval` changed in the plan before it; ValueError for the first step.

    Where newcomers were admitted, P1 is solved once more without them: what moves all the
    same did not move on their account.
    """
    steps = {step.interval: step for step in trace.steps}
    if interval not in steps or interval - 1 not in steps:
        raise ValueError(f"no plan of interval {interval} follows another")
    last, step = steps[interval - 1], steps[interval]
    snapshot = snapshot_of(step.inputs, step.before)
    names = tuple(contract.vehicle for contract in step.before.contracts)
    before_kw = _planned_before(last, names)
    after_kw = step.plan.power_kw[: len(names)]
    hours = snapshot.interval_hours
    moves = moves_between(names, before_kw, after_kw, interval, hours)
    moved_kwh = sum(move.energy_kwh for move in moves)
    made_room_kwh = _for_newcomers(step, before_kw, policy or p1_plans()) if moves else 0.0
    revision = Revision(
        interval=interval,
        moves=moves,
        cost_change=snapshot.tariff.cost(after_kw - before_kw),
        for_newcomers_kwh=min(moved_kwh, made_room_kwh),
        admitted=step.plan.admitted,
        edited=edits_between(last, step),
        text="",
    )
    clock = Clock(step.inputs.scenario, interval)
    happened = happened_told([h for h in trace.happenings if h.interval == interval], clock)
    edited = edits_told(revision) if not happened else ""
    return replace(revision, text=f"{happened}{edited}{_told(step, revision)}")


def _planned_before(last: Step, vehicles: Sequence[str]) -> Floats:
    """What the step before had left to do for these vehicles, (vehicles, slots) in kW.

    What happened in between may have closed contracts and opened others again.
    """
    tail_kw = last.after.tail_kw
    rows = {
        contract.vehicle: row for contract, row in zip(last.after.contracts, tail_kw, strict=True)
    }
    nothing = np.zeros(tail_kw.shape[1])
    return np.array([rows.get(vehicle, nothing) for vehicle in vehicles]).reshape(
        len(vehicles), len(nothing)
    )


def happened_told(happenings: Sequence[Happening], clock: Clock) -> str:
    """What happened before the step was decided, and what it did to promises, in sentences."""
    told = ""
    for happening in happenings:
        events = "; ".join(event.text for event in happening.events)
        told += f"At {clock.at(happening.interval)}, {events}. "
        short = [revision for revision in happening.revisions if revision.short_kwh > 0]
        if short:
            told += (
                f"{happening.short_kwh:.1f} kWh promised to {counted(len(short), 'vehicle')} "
                "cannot be delivered in time. "
            )
    return told


def moves_between(
    vehicles: Sequence[str], before_kw: Floats, after_kw: Floats, now: int, interval_hours: float
) -> tuple[Move, ...]:
    """Every kWh that changed its interval; arrays (vehicles, slots from `now`).

    Of each vehicle the earliest energy given up goes to the earliest taken on.
    """
    moves = []
    for vehicle, before, after in zip(vehicles, before_kw, after_kw, strict=True):
        change = after - before
        given, taken = np.maximum(0.0, -change), np.maximum(0.0, change)
        sources = [int(t) for t in np.flatnonzero(given > MOVED_KW)]
        targets = [int(t) for t in np.flatnonzero(taken > MOVED_KW)]
        while sources and targets:
            source, target = sources[0], targets[0]
            kw = min(given[source], taken[target])
            moves.append(Move(vehicle, now + source, now + target, float(kw) * interval_hours))
            given[source] -= kw
            taken[target] -= kw
            if given[source] <= MOVED_KW:
                sources.pop(0)
            if taken[target] <= MOVED_KW:
                targets.pop(0)
    return tuple(moves)


def _for_newcomers(step: Step, before_kw: Floats, policy: Policy) -> float:
    """Energy moved that P1 would have left where it was without the newcomers, kWh.

    `before_kw` (contracts, slots). What moves the same way in both plans, slot by slot the
    smaller of the two, did not move on their account.
    """
    if not step.plan.admitted:
        return 0.0
    snapshot = snapshot_of(step.inputs, step.before)
    anyway_kw = policy(replace(snapshot, requests=())).power_kw - before_kw
    moved_kw = step.plan.power_kw[: len(before_kw)] - before_kw
    same_kw = np.where(
        np.sign(anyway_kw) == np.sign(moved_kw), np.minimum(abs(anyway_kw), abs(moved_kw)), 0.0
    )
    return float((abs(moved_kw) - same_kw).sum()) * snapshot.interval_hours / 2


def edits_between(last: Step, step: Step) -> tuple[str, ...]:
    """Which parts of the inputs were edited between two steps, in words."""
    old, new = last.inputs, step.inputs
    if old is new:
        return ()
    now = step.interval
    edits = {
        "the headroom": not np.array_equal(
            old.rows.headroom_kw()[now:], new.rows.headroom_kw()[now:]
        ),
        "the energy price": not np.array_equal(
            old.scenario.price_per_kwh[now:], new.scenario.price_per_kwh[now:]
        ),
        "the station": old.scenario.station != new.scenario.station,
        "the price options": old.scenario.option != new.scenario.option,
        "the arrivals": old.requests[now:] != new.requests[now:],
    }
    return tuple(what for what, is_edited in edits.items() if is_edited)


def edits_told(revision: Revision) -> str:
    """What had been edited before the step, in a sentence."""
    return f"{listed(revision.edited).capitalize()} had been edited. " if revision.edited else ""


def _told(step: Step, revision: Revision) -> str:
    clock = Clock(step.inputs.scenario, step.interval)
    n, moved = len(step.before.contracts), revision.moved_kwh
    if not revision.moves:
        whose = "the only contract" if n == 1 else f"all {n} contracts"
        held = f"{whose} stayed as planned" if n else "there was no contract to change"
        return f"At {clock.at(step.interval)} {held}."
    vehicles = len({move.vehicle for move in revision.moves})
    who = "the only contract" if n == 1 else f"{vehicles} of {n} contracts"
    cost = revision.cost_change
    paid = (
        "at the same energy cost"
        if abs(cost) < A_CENT / 2
        else f"for {some_money(abs(cost))} {'more' if cost > 0 else 'less'} in energy"
    )
    return (
        f"At {clock.at(step.interval)} {who} moved "
        f"{moved:.1f} kWh {paid}: {_shifts(clock, revision.moves)}. {_why(revision, cost)}"
    )


def _shifts(clock: Clock, moves: Sequence[Move]) -> str:
    """The largest moves in words."""
    largest = sorted(moves, key=lambda move: (-move.energy_kwh, move.vehicle))[:NAMED]
    told = [
        f"{move.vehicle} {move.energy_kwh:.1f} kWh from {clock.at(move.from_interval)} to "
        f"{clock.at(move.to_interval)}"
        for move in largest
    ]
    more = len(moves) - len(told)
    return listed([*told, f"{counted(more, 'smaller move')}"] if more else told)


def _why(revision: Revision, cost: float) -> str:
    made_room = revision.for_newcomers_kwh
    share = made_room / revision.moved_kwh
    newcomers = listed(revision.admitted) if len(revision.admitted) <= NAMED else ""
    newcomers = newcomers or f"{len(revision.admitted)} newcomers"
    if share > 0.995:
        return f"All of it made room for {newcomers}."
    rest = (
        "into cheaper hours"
        if cost < -A_CENT / 2
        else "as other inputs allow or demand"
        if revision.edited
        else "to be done earlier, or with fewer gaps, at a cost equal to the cent"
    )
    if share < 0.005:
        return f"It moved {rest}."
    return f"{made_room:.1f} kWh of it made room for {newcomers}; the rest moved {rest}."
