"""Contracts when something has happened: who changed its own terms, and who misses what.

A driver's own change never costs anybody else. Whatever the station or the feeder takes away
is spread so that least is missing (`evdash.scheduling.shortfall`).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from evdash.checker.plans import plan_problems
from evdash.domain.events import Event
from evdash.domain.limits import Floats
from evdash.domain.plan import Plan
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Inputs, LimitCheck, Revision, State
from evdash.domain.vehicles import ENERGY_TOLERANCE_KWH, Contract
from evdash.errors import SolverFailure
from evdash.horizon.advance import snapshot_of, still_waiting
from evdash.horizon.networks import limit_check
from evdash.scheduling.effort import Effort
from evdash.scheduling.guarded import answered
from evdash.scheduling.problem import Bools, Problem, contracts_problem
from evdash.scheduling.shed import shed
from evdash.scheduling.shortfall import (
    NOTICED_KWH,
    least_shortfall,
    most_energy_for,
    step_effort,
    usable,
)

SHED = "The least possible shortfall was not found: those who came last were switched off first"
UNPROVEN = "It was not proven that no less can be missing"
UNPROVEN_FEWEST = "It was not proven that no fewer vehicles can be short"
AS_MUCH = "as much as every promise leaves room for"
UNPROVEN_MORE = "but it was not proven that there is no room for more"
LEFT_BEHIND = "A solver did not come back and was left behind: asked again, it may answer otherwise"
NO_ROOM_FOUND = "no schedule was found that keeps every promise beside it"
SPENT = "what one interval may take to work it out is used up; ask again in the next"


@dataclass(frozen=True, slots=True)
class Settled:
    """The state after events, the contracts they changed, and what could not be done."""

    state: State
    revisions: tuple[Revision, ...]
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Terms:
    """All contracts, also those that have just ended, and a schedule, (contracts, slots) in kW."""

    inputs: Inputs
    now: int
    contracts: tuple[Contract, ...]
    power_kw: Floats

    def state(self) -> State:
        """The contracts still open with their schedule, and those that wait for room."""
        opened = [n for n, contract in enumerate(self.contracts) if not contract.is_fulfilled]
        here = [c for c in self.contracts if _window_left(c, self.now) > 0]
        tail_kw = self.power_kw[opened]
        tail_kw.setflags(write=False)
        contracts = tuple(self.contracts[n] for n in opened)
        return State(self.now, contracts, tail_kw, still_waiting(here, self.now))

    def kept_to(self, check: LimitCheck) -> bool:
        """Whether the schedule passes the independent checker."""
        state = self.state()
        names = tuple(contract.vehicle for contract in state.contracts)
        plan = Plan(now=self.now, vehicles=names, power_kw=state.tail_kw)
        return not plan_problems(check, state.contracts, plan)

    def problem(self, order: Sequence[int], n_firm: int, extra_kwh: float = 0.0) -> Problem:
        """The contracts in `order`, all of their promises owed; `extra_kwh` more for the last."""
        contracts = tuple(self.contracts[n] for n in order)
        owed = np.array([max(0.0, c.promised_kwh - c.delivered_kwh) for c in contracts])
        owed[-1:] += extra_kwh
        snapshot = snapshot_of(self.inputs, State(self.now, contracts, self.power_kw[order]))
        return contracts_problem(snapshot, owed, n_firm)

    def scheduled(self, power_kw: Floats, own: Bools) -> "_Terms":
        """The terms that a schedule keeps; `own` marks those who changed theirs, (contracts,)."""
        planned = power_kw.sum(axis=1) * self.inputs.scenario.interval_hours
        contracts = tuple(
            _kept_terms(contract, float(planned[n]), own=bool(own[n]))
            for n, contract in enumerate(self.contracts)
        )
        return replace(self, contracts=contracts, power_kw=power_kw)


def _window_left(contract: Contract, now: int) -> int:
    """Intervals in which it may still charge."""
    request = contract.request
    return request.deadline_interval - max(now, request.arrival_interval)


def _kept_terms(contract: Contract, planned_kwh: float, *, own: bool) -> Contract:
    """What `planned_kwh` more keeps of a promise; what its own driver gives up is not short."""
    reached = contract.delivered_kwh + planned_kwh
    missing = contract.promised_kwh - reached
    if missing <= ENERGY_TOLERANCE_KWH:
        request = replace(contract.request, need_kwh=contract.promised_kwh)
        return replace(contract, request=request, short_kwh=0.0)
    request = replace(contract.request, need_kwh=reached)
    short = min(contract.short_kwh, missing) if own else missing
    return replace(contract, request=request, short_kwh=short)


def settle(inputs: Inputs, state: State, events: Sequence[Event]) -> Settled:
    """The contracts of `state` under inputs newly in force and after `events` of this interval."""
    before = (*state.contracts, *state.waiting)
    nothing = np.zeros((len(state.waiting), state.tail_kw.shape[1]))
    terms = _Terms(
        inputs,
        state.now,
        tuple(with_own_change(contract, events) for contract in before),
        np.vstack([state.tail_kw, nothing]),
    )
    check, effort = limit_check(inputs), step_effort()
    asks = [event for event in events if event.event == "asks_more"]
    own = np.array([new != old for new, old in zip(terms.contracts, before, strict=True)], bool)
    # half for the promises there are where others want more, who then share the rest
    terms, notes = _rescheduled(terms, own, check, effort.part(0.5) if asks else effort)
    names = {contract.vehicle for contract in before}
    notes += tuple(
        f"{event.vehicle} has no contract that is open: nothing changes"
        for event in events
        if event.vehicle and event.vehicle not in names
    )
    for left, event in zip(range(len(asks), 0, -1), asks, strict=True):
        if event.vehicle in names:
            terms, note = _asked_more(terms, event, check, effort.part(1 / left))
            notes = (*notes, note)
    notes += (LEFT_BEHIND,) if effort.left_behind else ()
    revisions = (Revision(*pair) for pair in zip(before, terms.contracts, strict=True))
    changed = tuple(one for one in revisions if one.before != one.after)
    return Settled(terms.state(), changed, notes)


def with_own_change(contract: Contract, events: Sequence[Event]) -> Contract:
    """The contract with the window its own driver leaves it."""
    request = contract.request
    for event in events:
        if event.vehicle != contract.vehicle:
            continue
        if event.event == "no_show":
            request = replace(request, deadline_interval=event.interval)
        elif event.event == "leaves_early" and event.until_interval is not None:
            until = min(request.deadline_interval, event.until_interval)
            request = replace(request, deadline_interval=until)
        elif event.event == "late" and event.from_interval is not None:
            back = max(request.arrival_interval, event.from_interval)
            # who is back at once has not been away
            away = back > max(event.interval, request.arrival_interval)
            request = replace(request, arrival_interval=back) if away else request
    return contract if request == contract.request else replace(contract, request=request)


def _rescheduled(
    terms: _Terms, own: Bools, check: LimitCheck, effort: Effort
) -> tuple[_Terms, tuple[str, ...]]:
    """Terms that can be kept, with a schedule that passes the checker."""
    here = np.array([_window_left(c, terms.now) > 0 for c in terms.contracts], dtype=bool)
    # promises as they stand come first, then those who changed their own terms; each by arrival,
    # as who stands last is the first to be switched off where nothing else helps
    order = sorted(
        np.flatnonzero(here).tolist(),
        key=lambda n: (bool(own[n]), terms.contracts[n].request.arrival),
    )
    problem = terms.problem(order, int((here & ~own).sum()))
    for schedule, notes in _schedules(problem, effort):
        power = np.zeros_like(terms.power_kw)
        power[order] = schedule
        scheduled = terms.scheduled(power, own)
        if scheduled.kept_to(check):
            return scheduled, notes
    raise SolverFailure("a station that charges nobody is said to break a limit")


def _schedules(problem: Problem, effort: Effort) -> Iterator[tuple[Floats, tuple[str, ...]]]:
    """Schedules to try, the best first: the one there is, if it keeps every promise; the one
    that misses least; the one cut down without a solver; and at last none at all."""
    there = np.where(problem.window, problem.tail_kw, 0.0)
    missing = problem.owed_kwh - there.sum(axis=1) * problem.interval_hours
    if (missing <= ENERGY_TOLERANCE_KWH).all():
        yield there, ()
    try:
        asked = partial(least_shortfall, problem, effort)
        found = usable(answered(asked, effort), problem)
    except SolverFailure:
        pass
    else:
        if found.short_kwh.sum() > missing.sum() + NOTICED_KWH:
            yield there, ()  # terms cut before may be kept where the whole promise could not
        doubts = ((UNPROVEN, found.proven), (UNPROVEN_FEWEST, found.fewest))
        short = found.short_kwh.any()
        yield found.power_kw, tuple(doubt for doubt, proven in doubts if short and not proven)
    yield shed(problem), (SHED,)
    yield np.zeros_like(there), (SHED,)


def _asked_more(
    terms: _Terms, event: Event, check: LimitCheck, effort: Effort
) -> tuple[_Terms, str]:
    """More energy for one vehicle, as far as every promise leaves room; and what was granted."""
    refused = f"{event.vehicle} gets nothing more: "
    names = [contract.vehicle for contract in terms.contracts]
    asker = names.index(event.vehicle)
    contract = terms.contracts[asker]
    extra = min(event.amount, _room_in_battery(terms.inputs.scenario, contract))
    why = _nothing_more(terms, contract, extra, effort)
    if why:
        return terms, refused + why
    opened = [n for n, c in enumerate(terms.contracts) if not c.is_fulfilled and n != asker]
    order = [*opened, asker]
    larger = replace(contract.request, need_kwh=contract.request.need_kwh + extra)
    asked = tuple(
        replace(c, request=larger) if n == asker else c for n, c in enumerate(terms.contracts)
    )
    problem = terms.problem(order, len(opened), extra)
    try:
        most = partial(most_energy_for, problem, extra, effort)
        found = usable(answered(most, effort), problem)
    except SolverFailure:
        return terms, refused + NO_ROOM_FOUND
    allowed = np.append(np.zeros(len(opened)), extra) + ENERGY_TOLERANCE_KWH
    if (found.short_kwh > allowed).any():
        return terms, refused + NO_ROOM_FOUND
    power = np.zeros_like(terms.power_kw)
    power[order] = found.power_kw
    own = np.arange(len(names)) == asker
    granted = replace(terms, contracts=asked).scheduled(power, own)
    if not granted.kept_to(check):
        return terms, refused + NO_ROOM_FOUND
    got = extra - float(found.short_kwh[-1])
    told = f"{event.vehicle} gets {got:.2f} of {event.amount:g} kWh more"
    if not found.short_kwh.any():
        return granted, told if extra == event.amount else f"{told}, and then its battery is full"
    return granted, f"{told}, {AS_MUCH if found.proven else UNPROVEN_MORE}"


def _nothing_more(terms: _Terms, contract: Contract, extra_kwh: float, effort: Effort) -> str:
    """Why a driver who asks for more need not be asked about at all; empty if it must."""
    state = terms.state()
    if contract.vehicle not in {c.vehicle for c in state.contracts}:
        return "it has no contract that is still open"
    if state.is_short:
        return "promises already made are short"
    if extra_kwh <= ENERGY_TOLERANCE_KWH:
        return "its battery will be full"
    return SPENT if effort.is_spent else ""


def _room_in_battery(scenario: Scenario, contract: Contract) -> float:
    """Energy, drawn from the grid, that its battery can take beyond its contract, kWh."""
    request = contract.request
    full = (1 - request.soc_in) * request.battery_kwh / scenario.station.efficiency
    return full - request.need_kwh
