"""Whom to admit now, by what it is worth over many sampled futures.

A two-stage stochastic program, its expectation replaced by the mean of sampled days (sample
average approximation) and solved by cuts (the L-shaped method of Van Slyke and Wets, 1969): the
first stage says whom of today's requests to admit, the second, one linear program for each
future, what the rest of that day then brings.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from scipy.sparse import csr_matrix

from evdash.domain.limits import Floats
from evdash.domain.plan import Snapshot
from evdash.domain.vehicles import Request
from evdash.scheduling.effort import Effort
from evdash.scheduling.fast.rounding import relaxed_and_cut
from evdash.scheduling.foresight import capacity_price, known_day
from evdash.scheduling.highs import WHOLE, LinearProgram, LpPoint, Session
from evdash.scheduling.problem import OPTIMALITY_USD

ROUNDS = 12
CUT_ROUNDS = 2
LATER_USD_PER_KWH = 1e-4
"""What a kWh costs for each slot it comes later."""
HAIR_KW = 1e-6
NODES = 1000
WORK = 1e7
"""Of one question to one future, as `Effort` counts; only a safety: rounds and nodes decide."""
Answer = TypeVar("Answer")


@dataclass(frozen=True, slots=True)
class Expectation:
    """What admitting `admitted` (requests,) costs in every future, (futures,), $.

    `slopes` (futures, requests): how that would change with each request's admission.
    `first_kw` (vehicles,): what those present then draw now, in the mean over the futures.
    `energy_price` (slots,) in $/kWh and `charger_price` (slots,) in $: what capacity would be
    worth to others, in the mean.
    """

    admitted: Floats
    costs: Floats
    slopes: Floats
    first_kw: Floats
    energy_price: Floats
    charger_price: Floats

    @property
    def cost(self) -> float:
        return float(self.costs.mean())


class SampledDay:
    """One future as a linear program held open, so that each question starts from the last.

    Vehicle cuts tighten it, as a future served by halves looks better than any can be; and a
    plan's energy comes as early as a trifle allows, for room later is room for the unexpected.
    """

    def __init__(self, snapshot: Snapshot, coming: tuple[Request, ...], n_requests: int) -> None:
        self.day = known_day(snapshot, coming)
        problem, at, program = self.day.problem, self.day.columns, self.day.program
        program.cost[: at.n_pairs] += LATER_USD_PER_KWH * at.slot * problem.interval_hours
        self.session = Session(program)
        self.n_present = problem.n_contracts + n_requests
        self.asking = at.u[problem.n_contracts : self.n_present]
        self.first = np.flatnonzero((at.slot == 0) & (at.vehicle < self.n_present))

    def best(self) -> LpPoint | None:
        """The day at its best, everything open, and then cut; None if infeasible."""
        return relaxed_and_cut(self.day, self.session, Effort(WORK), CUT_ROUNDS)

    def given(self, admitted: Floats) -> LpPoint | None:
        """The day at its best if just these requests are admitted; None if infeasible."""
        self.session.bound(self.asking, admitted, admitted)
        return self.session.relaxed(Effort(WORK))

    def cost_of(self, admitted: Floats, first_kw: Floats) -> float:
        """What the day costs at best if besides those present (vehicles,) draw this now, $."""
        wished = first_kw[self.day.columns.vehicle[self.first]]
        self.session.bound(self.first, np.maximum(0.0, wished - HAIR_KW), wished + HAIR_KW)
        point = self.given(admitted)
        top = self.day.program.upper[self.first]
        self.session.bound(self.first, np.zeros(len(top)), top)
        return np.inf if point is None else point.objective

    def first_kw(self, point: LpPoint) -> Floats:
        """What those present draw now at a point, (vehicles,), kW."""
        return np.asarray(self.day.power_kw(point.values)[: self.n_present, 0])


def asked_of_all(days: Sequence[SampledDay], ask: Callable[[SampledDay], Answer]) -> list[Answer]:
    """What every future answers, in their order.

    Each is a program of its own, and HiGHS leaves Python to the others while it solves one.
    """
    with ThreadPoolExecutor() as threads:
        return list(threads.map(ask, days))


def best_admissions(
    days: list[SampledDay], n_requests: int, rounds: int = ROUNDS
) -> Expectation | None:
    """The admissions of least mean cost; None if no future can do without any of the requests.

    Begins with what most futures vote for. Every round asks all futures about one set, and
    the cuts that gives say which set to try next, until none can be a cent better or `rounds`
    are over.
    """
    free = [point for point in asked_of_all(days, SampledDay.best) if point is not None]
    if len(free) < len(days):
        return None
    votes = np.mean([p.values[day.asking] for day, p in zip(days, free, strict=True)], axis=0)
    cuts = Cuts(n_requests, np.array([point.objective for point in free]))
    best = _most_voted(days, votes, cuts)
    if best is None:
        return None
    cuts.support(best)
    for _ in range(rounds):
        admitted, bound = cuts.next_admissions()
        if admitted is None or bound >= best.cost - OPTIMALITY_USD:
            break
        found = expectation_of(days, admitted)
        if found is None:
            cuts.exclude(admitted)
            continue
        cuts.support(found)
        best = min(best, found, key=lambda expectation: expectation.cost)
    return best


def _most_voted(days: list[SampledDay], votes: Floats, cuts: "Cuts") -> Expectation | None:
    """Those most futures would admit; of a set that cannot all be served, the least voted goes."""
    admitted = np.round(votes)
    for leaves in np.argsort(votes, kind="stable"):
        found = expectation_of(days, admitted)
        if found is not None:
            return found
        cuts.exclude(admitted)
        admitted = np.where(np.arange(len(votes)) == leaves, 0.0, admitted)
    return expectation_of(days, admitted)


def expectation_of(days: list[SampledDay], admitted: Floats) -> Expectation | None:
    """Costs, slopes and prices over all futures; None if one of them is infeasible."""
    asked = asked_of_all(days, lambda day: day.given(admitted))
    points = [point for point in asked if point is not None]
    if len(points) < len(days):
        return None
    prices = [capacity_price(day.day, point) for day, point in zip(days, points, strict=True)]
    return Expectation(
        admitted=admitted,
        costs=np.array([point.objective for point in points]),
        slopes=np.array([p.reduced_cost[day.asking] for day, p in zip(days, points, strict=True)]),
        first_kw=np.mean([d.first_kw(p) for d, p in zip(days, points, strict=True)], axis=0),
        energy_price=np.mean([headroom for headroom, _ in prices], axis=0),
        charger_price=np.mean([charger for _, charger in prices], axis=0),
    )


def costs_of(days: list[SampledDay], admitted: Floats, first_kw: Floats) -> Floats:
    """What each future costs at best, (futures,), $, if this is decided now."""
    return np.array(asked_of_all(days, lambda day: day.cost_of(admitted, first_kw)))


class Cuts:
    """The master: a lower bound on every future's cost for every set of admissions."""

    def __init__(self, n_requests: int, floors: Floats) -> None:
        """`floors` (futures,): no future does better than when it chooses for itself."""
        self.n_requests, self.floors = n_requests, floors
        self.rows: list[Floats] = []
        self.least: list[float] = []

    def support(self, found: Expectation) -> None:
        """A future's cost is convex in u, so a tangent lies below it everywhere."""
        for future, (cost, slope) in enumerate(zip(found.costs, found.slopes, strict=True)):
            row = np.append(-slope, np.zeros(len(self.floors)))
            row[self.n_requests + future] = 1.0
            self.rows.append(row)
            self.least.append(float(cost - slope @ found.admitted))

    def exclude(self, admitted: Floats) -> None:
        """What cannot all be served cannot be served with more: one of them stays out."""
        self.rows.append(np.append(-admitted, np.zeros(len(self.floors))))
        self.least.append(1.0 - float(admitted.sum()))

    def next_admissions(self) -> tuple[Floats | None, float]:
        """The set of least mean bound, and that bound; None if every set is excluded."""
        n, futures = self.n_requests, len(self.floors)
        program = LinearProgram(
            cost=np.append(np.zeros(n), np.full(futures, 1 / futures)),
            matrix=csr_matrix(np.array(self.rows)),
            row_lower=np.array(self.least),
            row_upper=np.full(len(self.rows), np.inf),
            lower=np.append(np.zeros(n), self.floors),
            upper=np.append(np.ones(n), np.full(futures, np.inf)),
        )
        kinds = np.append(np.full(n, WHOLE), np.zeros(futures)).astype(np.uint8)
        outcome = Session(program).branched(kinds, Effort(WORK), nodes=NODES)
        if outcome.values is None:
            return None, outcome.bound
        return np.round(outcome.values[:n]), float(outcome.values[n:].mean())


def sampled_days(
    snapshot: Snapshot, futures: list[tuple[Request, ...]], n_requests: int
) -> list[SampledDay]:
    """Every future's program as seen from a snapshot."""
    return [SampledDay(snapshot, coming, n_requests) for coming in futures]
