"""The contracts chosen, when does who charge? With u fixed, the LP settles most of D."""

from dataclasses import dataclass

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.fast.branch import (
    HAIR_USD,
    Settled,
    branch,
    by_guessing,
    cost_of_running,
)
from evdash.scheduling.fast.search import CUT_ROUNDS, RUNNING_KW, Search
from evdash.scheduling.highs import Indices, LpPoint
from evdash.scheduling.problem import TIE_USD, Bools

NODES = 500
DIVE_LPS = 40
GUESSES_USD = (0.1, np.inf)


def schedule_for(search: Search, u: Floats) -> float:
    """Offer the cheapest schedule found for contracts `u` (vehicles,); a bound on their cost, $."""
    lp = search.relaxed(u, u, CUT_ROUNDS)
    if lp is None:
        return np.inf if search.session.infeasible else -np.inf
    return completed(search, u, lp)


def completed(search: Search, u: Floats, lp: LpPoint) -> float:
    """The same, the LP for these contracts being solved.

    Its conflicts are rounded away, then there is branch and bound over the pairs it uses, at
    last over all pairs; each only if the one before did not reach the LP's bound.
    """
    target = max(search.bound, lp.objective) + TIE_USD
    rounded(search, u, lp, target)
    if search.cost > target and not search.effort.is_spent:
        around(search, u, lp, target)
    if search.cost > target and not search.effort.is_spent:
        return all_pairs(search, u, lp, target)
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


def all_pairs(search: Search, u: Floats, lp: LpPoint, target: float) -> float:
    """Branch and bound over every pair not ruled out: a bound on the cost of contracts `u`, $."""

    def attempt(beyond: float) -> float:
        off = cost_of_running(search, lp.reduced_cost) > beyond - lp.objective + HAIR_USD
        settled = Settled(off, np.zeros_like(off), u, u)
        outcome = branch(search, settled, nodes=NODES, absolute_gap=TIE_USD, target=target)
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


def rounded(search: Search, u: Floats, lp: LpPoint, ceiling: float) -> None:
    """Dive: switch conflicting pairs on or off, solve the LP again, until no conflict is left.

    All conflicts at once; where that costs more than `ceiling`, the surest few, then the surest
    alone, at last that one the other way.
    """
    at = search.relaxation.columns
    low = search.relaxation.charges.low_kw[at.vehicle]
    top = search.relaxation.charges.top_kw[at.vehicle]
    bounds = Rounding(np.zeros(at.n_pairs), top)
    values: Floats | None = lp.values
    solved = 0
    while values is not None and solved < DIVE_LPS:
        pairs, on = switches(search, values, bounds)
        if len(pairs) == 0:
            if not any(conflict.any() for conflict in search.conflicts(values)):
                search.offer(values)
            break
        values = None
        for taken, as_they_are in ways(len(pairs)):
            chosen, is_on = pairs[:taken], on[:taken] == as_they_are
            attempt = bounds.switched(chosen[is_on], chosen[~is_on], low)
            search.session.bound(np.arange(at.n_pairs), attempt.lower, attempt.upper)
            point = search.relaxed(u, u)
            solved += 1
            if point is not None and point.objective <= ceiling:
                bounds, values = attempt, point.values
                break
    search.session.bound(np.arange(at.n_pairs), np.zeros(at.n_pairs), top)


def ways(count: int) -> list[tuple[int, bool]]:
    """How many of the surest switches to make, and whether as they are or the other way."""
    fewer = sorted({count, -(-count // 4), 1}, reverse=True)
    return [*((taken, True) for taken in fewer), (1, False)]


def switches(search: Search, values: Floats, bounds: Rounding) -> tuple[Indices, Bools]:
    """Which pairs to switch at a point, the surest first, and whether on (True) or off.

    In slots with too many running the weakest go; elsewhere what runs below its lowest power
    goes to the nearer of off and on.
    """
    at, problem = search.relaxation.columns, search.problem
    power = values[: at.n_pairs]
    low = search.relaxation.charges.low_kw[at.vehicle]
    short, crowded = search.conflicts(values)
    weakest: list[Indices] = []
    for slot in np.flatnonzero(crowded):
        running = np.flatnonzero((at.slot == slot) & (power > RUNNING_KW))
        free = running[bounds.lower[running] == 0]
        surplus = len(running) - problem.chargers
        weakest.append(free[np.argsort(power[free], kind="stable")][:surplus])
    weak = np.flatnonzero(short & ~crowded[at.slot])
    if crowded.any():
        weak = weak[power[weak] >= 0.5 * low[weak]]
    pairs = np.concatenate([weak, *weakest])
    share = power[pairs] / np.maximum(low[pairs], RUNNING_KW)
    on = (share >= 0.5) & (np.arange(len(pairs)) < len(weak))
    order = np.argsort(-np.where(on, share, 1 - share), kind="stable")
    return pairs[order], on[order]
