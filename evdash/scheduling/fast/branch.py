"""Branch and bound by HiGHS over what is left open: for master, recourse and the full problem."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.fast.pricing import added_cost
from evdash.scheduling.fast.search import Search
from evdash.scheduling.highs import SEMI_CONTINUOUS, WHOLE, Kinds, LpPoint, MilpOutcome
from evdash.scheduling.problem import Bools

GAP_USD = 0.004
HAIR_USD = 1e-7
"""Keeps the best point itself from being ruled out by rounding."""


@dataclass(frozen=True, slots=True)
class Settled:
    """What is settled before branching: pairs that stay off or surely run, (pairs,); bounds on
    u, (vehicles,)."""

    off: Bools
    on: Bools
    u_lower: Floats
    u_upper: Floats


def branch(
    search: Search,
    settled: Settled,
    *,
    nodes: int,
    only_u: bool = False,
    absolute_gap: float = 0.0,
    target: float = -np.inf,
) -> MilpOutcome:
    """P1 with all that is not settled open; the bounds on pairs are lifted again afterwards.

    `only_u` leaves D, and P below its lowest power, continuous.
    """
    at, session = search.relaxation.columns, search.session
    low = search.relaxation.charges.low_kw[at.vehicle]
    top = search.relaxation.charges.top_kw[at.vehicle]
    has_d, open_pairs = at.d >= 0, ~settled.off & ~settled.on & (not only_u)
    kinds: Kinds = np.zeros(at.total, dtype=np.uint8)
    semi = np.flatnonzero(open_pairs & ~has_d & (low > 0))
    kinds[semi] = SEMI_CONTINUOUS
    kinds[at.d[open_pairs & has_d]] = WHOLE
    kinds[at.u[settled.u_lower < settled.u_upper]] = WHOLE

    lower = np.where(settled.on, low, 0.0)
    lower[semi] = low[semi]
    session.bound(at.u, settled.u_lower, settled.u_upper)
    session.bound(np.arange(at.n_pairs), lower, np.where(settled.off, 0.0, top))
    d = at.d[has_d]
    session.bound(d, settled.on[has_d].astype(np.float64), (~settled.off[has_d]).astype(np.float64))
    outcome = session.branched(
        kinds, search.effort, nodes=nodes, absolute_gap=absolute_gap, target=target
    )
    session.bound(np.arange(at.n_pairs), np.zeros(at.n_pairs), top)
    session.bound(d, np.zeros(len(d)), np.ones(len(d)))
    return outcome


def cost_of_running(search: Search, lp_reduced_cost: Floats) -> Floats:
    """By how much an LP's objective grows at least if a pair runs, (pairs,), $.

    A running pair has P ≥ low and D = 1; reduced costs of at least 0 price both.
    """
    at = search.relaxation.columns
    dearer = np.maximum(0.0, lp_reduced_cost)
    cost = dearer[: at.n_pairs] * search.relaxation.charges.low_kw[at.vehicle]
    return np.asarray(cost + np.where(at.d >= 0, dearer[at.d], 0.0))


def settled_by_reduced_costs(search: Search, root: LpPoint, allowed: float) -> Settled:
    """What costs more than `allowed` above the LP `root`, $: pairs that run, u as it is not.

    `root` is the LP without any bound on u but the program's own.
    """
    at, program = search.relaxation.columns, search.relaxation.program
    added = added_cost(search.relaxation, root)
    lower, upper = program.lower[at.u].copy(), program.upper[at.u].copy()
    free = lower < upper
    upper[free & (added > allowed)] = 0.0
    lower[free & (-added > allowed)] = 1.0
    off = cost_of_running(search, root.reduced_cost) > allowed
    return Settled(off, np.zeros_like(off), lower, upper)


def by_guessing(
    lp_objective: float,
    guesses: Sequence[float],
    best: Callable[[], float],
    attempt: Callable[[float], float],
) -> float:
    """A bound from guesses how far above an LP the optimum lies; all in $.

    Reduced costs settle what a guess rules out, which leaves little to branch over. `attempt`
    solves with what is dearer than its argument ruled out, and returns the bound proven: one
    below that argument holds altogether, else the optimum lies beyond and the next guess is
    wider. `best` is the cost of the best point known.
    """
    bound = lp_objective
    for guess in guesses:
        beyond = min(lp_objective + guess, best())
        if beyond <= bound:
            continue
        proven = attempt(beyond)
        bound = max(bound, min(proven, beyond))
        if proven < beyond:
            break
    return bound
