"""Branch and bound by HiGHS over what is left open: for master, schedule and the full problem.

Before it, what each request and each pair adds to the cost at least settles what need not be open.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.fast.relaxation import Relaxation
from evdash.scheduling.fast.search import Search
from evdash.scheduling.highs import SEMI_CONTINUOUS, WHOLE, Kinds, LpPoint, MilpOutcome
from evdash.scheduling.problem import Bools

GAP_USD = 0.004
HAIR_USD = 1e-7
"""Keeps the best point itself from being ruled out by rounding."""
SOME = 1e-3
"""From this u on the request's part of an LP's point itself tells what it adds."""


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


def added_cost(relaxation: Relaxation, point: LpPoint) -> Floats:
    """What admitting each vehicle adds to the bound on P1's cost, $, (vehicles,).

    `point` is an LP's optimum, whatever the bounds on u. With K its objective less added·u at
    its own u, every choice of contracts u costs at least K + added·u.

    Take the rows that bind vehicles to one another away, and have what they limit paid for at
    their duals. What is left falls apart by vehicle: a request that is admitted pays for its own
    charge, one that is not adds nothing (the Lagrangian relaxation). An LP's reduced cost of u
    says the same only if the duals of the vehicle's own rows happen to be the best ones. Where
    u = 0 they mostly are not: the rows P ≤ p·u take what u could have, and its reduced cost is 0.
    """
    at = relaxation.columns
    prices = priced_columns(relaxation, point)
    spent, with_d = prices * point.values, at.d >= 0
    own = np.bincount(at.vehicle, spent[: at.n_pairs], minlength=len(at.u)) + spent[at.u]
    own += np.bincount(at.vehicle[with_d], spent[at.d[with_d]], minlength=len(at.u))
    u = point.values[at.u]
    unseen = np.maximum(
        point.reduced_cost[at.u], prices[at.u] + cheapest_charge(relaxation, prices)
    )
    return np.where(u > SOME, own / np.maximum(u, SOME), unseen)


def priced_columns(relaxation: Relaxation, point: LpPoint) -> Floats:
    """The cost of each column with what it takes of the shared rows at their duals, (columns,)."""
    program, rows = relaxation.program, relaxation.shared
    starts = program.matrix.indptr[rows.start : rows.stop + 1]
    entries = slice(starts[0], starts[-1])
    paid = np.repeat(point.row_dual[rows], np.diff(starts)) * program.matrix.data[entries]
    columns = program.matrix.indices[entries]
    return np.asarray(program.cost - np.bincount(columns, paid, minlength=len(program.cost)))


def cheapest_charge(relaxation: Relaxation, prices: Floats) -> Floats:
    """What a whole charge costs in the cheapest slots, P ≤ p·D alone being kept, $, (vehicles,).

    m − 1 slots at p and one at r hold it. Nothing is said, −inf, where the window has fewer:
    who cannot be served is out anyway.
    """
    at, charges = relaxation.columns, relaxation.charges
    top_kw = np.maximum(charges.top_kw, 1e-12)[at.vehicle]
    per_kw = prices[: at.n_pairs] + np.where(at.d >= 0, prices[at.d], 0.0) / top_kw
    by_slot = np.full((len(at.u), relaxation.problem.n_slots), np.inf)
    by_slot[at.vehicle, at.slot] = per_kw
    by_slot.sort(axis=1)
    place, last = np.arange(by_slot.shape[1]), charges.fewest[:, None] - 1
    power_kw = np.where(place < last, charges.top_kw[:, None], 0.0)
    power_kw = np.where(place == last, charges.rest_kw[:, None], power_kw)
    cost = np.multiply(by_slot, power_kw, out=np.zeros_like(by_slot), where=power_kw > 0)
    whole = cost.sum(axis=1)
    return np.asarray(np.where(np.isfinite(whole), whole, -np.inf))
