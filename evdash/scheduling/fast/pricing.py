"""What each request adds to the cost of any choice of contracts, by one LP's duals.

Take the rows that bind vehicles to one another away, and have what they limit paid for at their
duals. What is left falls apart by vehicle: a request that is admitted pays for its own charge,
one that is not adds nothing (the Lagrangian relaxation). An LP's reduced cost of u says the same
only if the duals of the vehicle's own rows happen to be the best ones. Where u = 0 they mostly
are not: the rows P ≤ p·u take what u could have, and its reduced cost is 0.
"""

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.fast.relaxation import Relaxation
from evdash.scheduling.highs import LpPoint

SOME = 1e-3
"""From this u on the request's part of an LP's point itself tells what it adds."""


def added_cost(relaxation: Relaxation, point: LpPoint) -> Floats:
    """What admitting each vehicle adds to the bound on P1's cost, $, (vehicles,).

    `point` is an LP's optimum, whatever the bounds on u. With K its objective less added·u at
    its own u, every choice of contracts u costs at least K + added·u.
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
