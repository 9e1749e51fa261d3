"""The contracts chosen, when does who charge? Recourse: u fixed, most of D settled by the LP."""

from dataclasses import dataclass

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.fast.branch import (
    GAP_USD,
    HAIR_USD,
    Settled,
    branch,
    by_guessing,
    cost_of_running,
)
from evdash.scheduling.fast.search import CUT_ROUNDS, RUNNING_KW, Search
from evdash.scheduling.highs import LpPoint
from evdash.scheduling.problem import TIE_USD
from evdash.scheduling.rows import Indices

NODES = 500
DIVES = 12
GUESSES_USD = (0.1, np.inf)


def schedule_for(search: Search, u: Floats) -> float:
    """Offer the cheapest schedule found for contracts `u` (vehicles,); a bound on their cost, $.

    First the LP, then its conflicts rounded away, then branch and bound over the pairs the LP
    uses, at last over all pairs; each only if the one before did not reach the LP's bound.
    """
    search.session.bound(search.relaxation.columns.u, u, u)
    lp = search.relaxed(CUT_ROUNDS)
    if lp is None:
        return np.inf if search.session.infeasible else -np.inf
    target = max(search.bound, lp.objective) + TIE_USD
    rounded(search, lp, target)
    if search.cost > target and not search.out_of_time:
        around(search, u, lp, target)
    if search.cost > target and not search.out_of_time:
        return all_pairs(search, u, lp)
    return lp.objective


def around(search: Search, u: Floats, lp: LpPoint, target: float) -> None:
    """Branch and bound near the LP's point: off where it is off, on where it is at the top."""
    at = search.relaxation.columns
    power = lp.values[: at.n_pairs]
    off = power <= RUNNING_KW
    on = power >= search.relaxation.charges.top_kw[at.vehicle] - RUNNING_KW
    outcome = branch(search, Settled(off, on & ~off, u, u), nodes=NODES, target=target)
    if outcome.values is not None:
        search.offer(outcome.values)


def all_pairs(search: Search, u: Floats, lp: LpPoint) -> float:
    """Branch and bound over every pair not ruled out: a bound on the cost of contracts `u`, $."""

    def attempt(beyond: float) -> float:
        off = cost_of_running(search, lp.reduced_cost) > beyond - lp.objective + HAIR_USD
        settled = Settled(off, np.zeros_like(off), u, u)
        outcome = branch(search, settled, nodes=NODES, absolute_gap=GAP_USD)
        if outcome.values is not None:
            search.offer(outcome.values)
        return outcome.bound

    return by_guessing(lp.objective, GUESSES_USD, lambda: search.cost, attempt)


@dataclass(frozen=True, slots=True)
class Rounding:
    """Bounds on P while diving, (pairs,), kW: 0 above where switched off, low below where on."""

    lower: Floats
    upper: Floats

    def switched(self, on: Indices, off: Indices, low_kw: Floats) -> "Rounding":
        """These pairs switched on and off besides."""
        lower, upper = self.lower.copy(), self.upper.copy()
        lower[on] = low_kw[on]
        upper[off] = 0.0
        return Rounding(lower, upper)


def rounded(search: Search, lp: LpPoint, ceiling: float) -> None:
    """Dive: switch conflicting pairs on or off, solve the LP again, until no conflict is left.

    All conflicts at once; where that costs more than `ceiling`, the first alone, on or off.
    """
    at = search.relaxation.columns
    low = search.relaxation.charges.low_kw[at.vehicle]
    top = search.relaxation.charges.top_kw[at.vehicle]
    bounds = Rounding(np.zeros(at.n_pairs), top)
    values: Floats | None = lp.values
    for _ in range(DIVES):
        if values is None:
            break
        on, off = switches(search, values, bounds)
        if len(on) + len(off) == 0:
            if not any(conflict.any() for conflict in search.conflicts(values)):
                search.offer(values)
            break
        first = np.concatenate([on, off])[:1]
        nobody = first[:0]
        tried = [(on, off), (first, nobody), (nobody, first)]
        values = None
        for switched_on, switched_off in tried[0 if len(on) + len(off) > 1 else 1 :]:
            attempt = bounds.switched(switched_on, switched_off, low)
            search.session.bound(np.arange(at.n_pairs), attempt.lower, attempt.upper)
            point = search.relaxed()
            if point is not None and point.objective <= ceiling:
                bounds, values = attempt, point.values
                break
    search.session.bound(np.arange(at.n_pairs), np.zeros(at.n_pairs), top)


def switches(search: Search, values: Floats, bounds: Rounding) -> tuple[Indices, Indices]:
    """Which pairs to switch on and off at a point: (on, off).

    In slots with too many running the weakest go; elsewhere what runs below its lowest power
    goes to the nearer of off and on, the surest first.
    """
    at, problem = search.relaxation.columns, search.problem
    power = values[: at.n_pairs]
    low = search.relaxation.charges.low_kw[at.vehicle]
    short, crowded = search.conflicts(values)
    off: list[Indices] = []
    for slot in np.flatnonzero(crowded):
        running = np.flatnonzero((at.slot == slot) & (power > RUNNING_KW))
        free = running[bounds.lower[running] == 0]
        off.append(free[np.argsort(power[free], kind="stable")][: len(running) - problem.chargers])
    weak = np.flatnonzero(short & ~crowded[at.slot])
    share = power[weak] / low[weak]
    on = weak[share >= 0.5][np.argsort(-share[share >= 0.5], kind="stable")]
    if not crowded.any():
        off.append(weak[share < 0.5])
    return on, np.concatenate([np.empty(0, dtype=np.intp), *off])
