"""Why P1 left a request out: the first thing that stands in its way, found by exact tests.

The vehicle is asked for alone at an empty station without the feeder, with it, beside the
contracts, and beside those admitted in its interval. The first of these that refuses it is
the reason, so that each reason says what an empty station, or one without the newcomers,
would have answered. The first two are closed forms, the others small P1s.
"""

from collections import Counter
from dataclasses import dataclass, replace
from functools import partial
from math import ceil, floor

import numpy as np

from evdash.domain.elements import Element
from evdash.domain.limits import Floats, LimitRows
from evdash.domain.plan import Plan, Policy, Refusal, Snapshot
from evdash.domain.refusal import RefusalKind, RefusalReason
from evdash.domain.tariff import Tariff
from evdash.domain.vehicles import Request
from evdash.errors import SolverFailure
from evdash.scheduling.fast.forced import lp_bound_with
from evdash.scheduling.problem import OPTIMALITY_USD, problem_of

LEFT_OUT = RefusalReason("left out")
"""What P1 says until its plan is asked why, and where nothing more can be proven."""
WHOLE = 1e-9
ROUNDING_KW, ROUNDING_USD = 1e-6, 1e-9


def reasoned(policy: Policy, answers: Policy) -> Policy:
    """The policy with every refusal by P1 looked into; `answers` solves P1 for that."""
    return partial(_reasoned, policy, answers)


def _reasoned(policy: Policy, answers: Policy, snapshot: Snapshot) -> Plan:
    return with_reasons(snapshot, policy(snapshot), answers)


def with_reasons(snapshot: Snapshot, plan: Plan, answers: Policy) -> Plan:
    """The plan with a proven reason wherever it says no more than that somebody is left out."""
    asked = {request.vehicle: request for request in snapshot.requests}
    refused = tuple(
        Refusal(one.vehicle, reason_of(snapshot, asked[one.vehicle], plan, answers))
        if one.reason == LEFT_OUT
        else one
        for one in plan.refused
    )
    return replace(plan, refused=refused)


def reason_of(snapshot: Snapshot, request: Request, plan: Plan, answers: Policy) -> RefusalReason:
    """Why a plan that seeks profit leaves a request out."""
    alone = alone_at_the_station(snapshot, request)
    if alone is not None:
        return alone
    rivals = tuple(r for r in snapshot.requests if r.vehicle in set(plan.admitted))
    worth = snapshot.tariff.cost(plan.power_kw) - sum(r.revenue for r in rivals)
    probe = Probe(replace(snapshot, requests=()), request, answers)
    try:
        return _beside_others(probe, rivals, plan, worth)
    except SolverFailure:
        return LEFT_OUT


def alone_at_the_station(snapshot: Snapshot, request: Request) -> RefusalReason | None:
    """What refuses a request at an empty station: its energy's cost, or the feeder; else None."""
    return energy_too_dear(snapshot, request) or short_of_headroom(snapshot, request)


def energy_too_dear(snapshot: Snapshot, request: Request) -> RefusalReason | None:
    """The reason where even the cheapest schedule without any feeder costs what it pays."""
    cost = cheapest_cost(snapshot.tariff[: _window(snapshot, request)], request)
    if cost < request.revenue - ROUNDING_USD:
        return None
    return RefusalReason("energy", cost=cost, pays=request.revenue, need_kwh=request.need_kwh)


def short_of_headroom(snapshot: Snapshot, request: Request) -> RefusalReason | None:
    """The reason where the feeder cannot carry its charge at an otherwise empty station."""
    window, hours = _window(snapshot, request), snapshot.interval_hours
    room_kw = snapshot.rows.headroom_kw()[:window]
    if holds(room_kw, hours, request, ROUNDING_KW):
        return None
    return RefusalReason("feeder", elements=_short_elements(snapshot, request, room_kw))


def holds(room_kw: Floats, interval_hours: float, request: Request, slack_kw: float) -> bool:
    """Whether slots with so much room, (slots,) in kW, hold its charge, to within a slack."""
    owed_kw = request.need_kwh / interval_hours
    low_kw, top_kw = min(request.min_kw, owed_kw), min(request.max_kw, owed_kw)
    usable = np.sort(np.minimum(top_kw, room_kw[room_kw >= low_kw - slack_kw]))[::-1]
    slots = np.arange(1, len(usable) + 1)
    enough = (np.cumsum(usable) >= owed_kw - slack_kw) & (slots * low_kw <= owed_kw + WHOLE)
    return bool(enough.any())


def cheapest_cost(tariff: Tariff, request: Request) -> float:
    """What its energy costs at the least with all slots of a tariff to itself, $.

    With j slots the cheapest j are best, each at its lowest power and the rest in the cheapest.
    """
    owed_kw = request.need_kwh / tariff.interval_hours
    low_kw, top_kw = min(request.min_kw, owed_kw), min(request.max_kw, owed_kw)
    most = len(tariff) if low_kw <= 0 else min(len(tariff), floor(owed_kw / low_kw + WHOLE))
    costs = [np.inf]
    for slots in range(max(1, ceil(owed_kw / top_kw - WHOLE)), most + 1):
        spare_kw = max(0.0, owed_kw - slots * low_kw)
        more_kw = np.clip(spare_kw - (top_kw - low_kw) * np.arange(slots), 0.0, top_kw - low_kw)
        costs.append(tariff.least_cost(low_kw + more_kw))
    return min(costs)


@dataclass(frozen=True, slots=True)
class Probe:
    """One request beside the contracts of a snapshot without requests, asked of P1."""

    snapshot: Snapshot
    request: Request
    answers: Policy

    def ask(
        self,
        others: tuple[Request, ...] = (),
        *,
        forced: bool = False,
        no_feeder: bool = False,
        no_count: bool = False,
    ) -> Plan:
        """P1's plan for the contracts, the request and others."""
        return self.answers(
            self.asked(others, forced=forced, no_feeder=no_feeder, no_count=no_count)
        )

    def asked(
        self,
        others: tuple[Request, ...] = (),
        *,
        forced: bool = False,
        no_feeder: bool = False,
        no_count: bool = False,
    ) -> Snapshot:
        """What is asked of P1: the contracts, the request and others.

        `forced`: a bonus puts the request in wherever it fits. `no_feeder`, `no_count`: without
        end of headroom, or of chargers.
        """
        snapshot, request = self.snapshot, self.request
        if forced:
            request = request.with_bonus(self.bonus(others))
        if no_feeder:
            none = LimitRows((), np.zeros((0, 1)), np.zeros((snapshot.n_slots, 0)))
            snapshot = replace(snapshot, rows=none)
        if no_count:
            everyone = len(snapshot.contracts) + 1 + len(others)
            snapshot = replace(snapshot, chargers=max(snapshot.chargers, everyone))
        return replace(snapshot, requests=(*others, request))

    def fits(self, *, no_feeder: bool = False, no_count: bool = False) -> bool | None:
        """Whether some plan holds the contracts and the request; None if that is not proven.

        Beside the last plan's tail as it stands there often is room; that there is none at all
        the LP often proves. P1 is asked about the rest.
        """
        snapshot, window = self.snapshot, _window(self.snapshot, self.request)
        room_kw = np.full(window, np.inf)
        if not no_feeder:
            room_kw = (snapshot.rows.headroom_kw() - snapshot.tail_kw.sum(axis=0))[:window]
        if not no_count:
            busy = (snapshot.tail_kw > 0).sum(axis=0)[:window] >= snapshot.chargers
            room_kw = np.where(busy, 0.0, room_kw)
        if holds(room_kw, snapshot.interval_hours, self.request, 0.0):
            return True
        asked = self.asked(no_feeder=no_feeder, no_count=no_count)
        if np.isposinf(lp_bound_with(problem_of(asked), self.request.vehicle)):
            return False
        plan = self.ask(forced=True, no_feeder=no_feeder, no_count=no_count)
        return self.admits(plan) or (False if plan.report.status == "optimal" else None)

    def admits(self, plan: Plan) -> bool:
        return self.request.vehicle in plan.admitted

    def bonus(self, others: tuple[Request, ...] = ()) -> float:
        """More than any two plans can differ by, $."""
        return forcing_bonus(
            replace(self.snapshot, requests=(*others, self.request)), self.snapshot.tariff
        )

    @property
    def without_contracts(self) -> "Probe":
        """The same at an empty station."""
        nothing = np.zeros((0, self.snapshot.n_slots))
        return replace(self, snapshot=replace(self.snapshot, contracts=(), tail_kw=nothing))


def forcing_bonus(snapshot: Snapshot, tariff: Tariff) -> float:
    """A price on top, $, that puts a request in wherever it fits."""
    owed_kwh = sum(contract.owed_kwh for contract in snapshot.contracts)
    asked_kwh = sum(request.need_kwh for request in snapshot.requests)
    revenue = sum(request.revenue for request in snapshot.requests)
    return float(np.ceil(1 + revenue + tariff.most_apart(owed_kwh + asked_kwh)))


def _beside_others(
    probe: Probe, rivals: tuple[Request, ...], plan: Plan, worth: float
) -> RefusalReason:
    if rivals and (one := _one_in_its_place(probe, rivals, plan)):
        return RefusalReason("outbid", by=(one,))
    fits = probe.fits()
    if not fits:
        return LEFT_OUT if fits is None else _no_room(probe)
    beside = probe.ask()
    if probe.admits(beside):
        return _outbid(probe, rivals, worth)
    alone = probe.without_contracts
    answer = alone.ask()
    if not alone.admits(answer):
        return _costs(alone, answer, alone.ask(forced=True), "feeder cost")
    forced = probe.ask(forced=True)
    return _costs(probe, beside, forced, "contracts cost") if probe.admits(forced) else LEFT_OUT


def _one_in_its_place(probe: Probe, rivals: tuple[Request, ...], plan: Plan) -> str | None:
    """The first of the newcomers in whose place it fits, and without whom P1 takes it in."""
    snapshot, window = probe.snapshot, _window(probe.snapshot, probe.request)
    if plan.report.status != "optimal":
        return None
    for rival in rivals:
        others = plan.power_kw[[name != rival.vehicle for name in plan.vehicles]]
        room_kw = (snapshot.rows.headroom_kw() - others.sum(axis=0))[:window]
        busy = (others > 0).sum(axis=0)[:window] >= snapshot.chargers
        room_kw = np.where(busy, 0.0, room_kw)
        if holds(room_kw, snapshot.interval_hours, probe.request, 0.0):
            left = tuple(r for r in rivals if r is not rival)
            return rival.vehicle if probe.admits(probe.ask(left)) else None
    return None


def _outbid(probe: Probe, rivals: tuple[Request, ...], worth: float) -> RefusalReason:
    """Few of the newcomers admitted if it would come in without these, else all of them.

    `worth`, in $, is P1's value of the plan that left it out: no plan with it is to beat that.
    """
    forced = probe.ask(rivals, forced=True)
    bound = forced.report.bound
    if not rivals or bound is None or bound + probe.bonus(rivals) < worth - 2 * OPTIMALITY_USD:
        return LEFT_OUT
    kept = set(forced.admitted)
    dropped = [r.vehicle for r in rivals if r.vehicle not in kept]
    left = tuple(r for r in rivals if r.vehicle in kept)
    few = bool(dropped) and bool(left) and probe.admits(probe.ask(left))
    return RefusalReason("outbid", by=tuple(dropped if few else (r.vehicle for r in rivals)))


def _costs(probe: Probe, without: Plan, forced: Plan, kind: RefusalKind) -> RefusalReason:
    """What charging it adds at the least, if that is proven to be no less than it pays."""
    pays, bound, known = probe.request.revenue, forced.report.bound, without.report.objective
    if bound is None or known is None:
        return LEFT_OUT
    cost = bound + probe.bonus() + pays - known
    if cost < pays - ROUNDING_USD:
        return RefusalReason("cent") if without.report.status == "optimal" else LEFT_OUT
    return RefusalReason(kind, cost=cost, pays=pays)


def _no_room(probe: Probe) -> RefusalReason:
    """Which of headroom and chargers, without end of it, would make room beside the contracts."""
    feeder, count = probe.fits(no_feeder=True), probe.fits(no_count=True)
    if feeder is None or count is None:
        return LEFT_OUT
    if count and not feeder:
        return RefusalReason("chargers")
    kind: RefusalKind = "headroom or chargers" if count else "headroom"
    kind = kind if feeder else "headroom and chargers"
    snapshot, window = probe.snapshot, _window(probe.snapshot, probe.request)
    left_kw = (snapshot.rows.headroom_kw() - snapshot.tail_kw.sum(axis=0))[:window]
    return RefusalReason(kind, elements=_short_elements(snapshot, probe.request, left_kw))


def _short_elements(snapshot: Snapshot, request: Request, left_kw: Floats) -> tuple[Element, ...]:
    """The tightest elements where less is left, (slots,), than it takes; of most slots first."""
    top_kw = min(request.max_kw, request.need_kwh / snapshot.interval_hours)
    binding = snapshot.rows.binding()
    short = Counter(binding[slot] for slot in np.flatnonzero(left_kw < top_kw))
    return tuple(element for element, _ in short.most_common() if element)


def _window(snapshot: Snapshot, request: Request) -> int:
    return request.deadline_interval - snapshot.now
