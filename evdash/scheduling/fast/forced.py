"""What admitting one request takes at least, by the LP alone: no branching, a few milliseconds."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.sparse import csr_matrix, hstack

from evdash.domain.limits import Floats
from evdash.scheduling.effort import Effort
from evdash.scheduling.fast.relaxation import Relaxation, limited_slots, made_from
from evdash.scheduling.fast.search import CUT_ROUNDS
from evdash.scheduling.fast.solver import search_over
from evdash.scheduling.highs import LinearProgram, Session
from evdash.scheduling.problem import Problem

WORK = 1e7
"""What a question may take, as `Effort` counts: only a safety."""


def lp_bound_with(problem: Problem, vehicle: str) -> float:
    """What P1's value with this request in cannot fall below, $; inf if it cannot be in.

    −inf where the LP took too much work: nothing is proven then.
    """
    if vehicle not in problem.vehicles:
        return np.inf
    search = search_over(made_from(problem), Effort(WORK))
    n = problem.vehicles.index(vehicle)
    if not search.relaxation.charges.servable[n]:
        return np.inf
    u, program = search.relaxation.columns.u, search.relaxation.program
    point = search.relaxed(_with(program.lower[u], n), program.upper[u], CUT_ROUNDS)
    if point is None:
        return np.inf if search.session.infeasible else -np.inf
    return point.objective


def least_headroom_kw(problem: Problem, vehicle: str, slots: Sequence[int]) -> float:
    """With less than this more headroom in each of `slots` no plan holds contracts and request, kW.

    inf if none does with any; 0 where the LP took too much work: nothing is proven then.
    """
    if vehicle not in problem.vehicles:
        return np.inf
    relaxation = made_from(problem)
    n = problem.vehicles.index(vehicle)
    if not relaxation.charges.servable[n]:
        return np.inf
    session = Session(_headroom_bought(relaxation, n, slots))
    point = session.relaxed(Effort(WORK))
    if point is None:
        return np.inf if session.infeasible else 0.0
    return point.objective


def _with(lower: Floats, one: int) -> Floats:
    """Lower bounds with that of one u at 1: its vehicle is in."""
    lower = lower.copy()
    lower[one] = 1.0
    return lower


def _headroom_bought(relaxation: Relaxation, n: int, slots: Sequence[int]) -> LinearProgram:
    """The least of one more column, added to the headroom in `slots`, with vehicle `n` in."""
    at, program = relaxation.columns, relaxation.program
    limited = limited_slots(at, relaxation.charges, relaxation.headroom_kw)
    feeder_rows = relaxation.shared.start + np.arange(len(limited))
    bought = feeder_rows[np.isin(limited, slots)]
    ones = (np.full(len(bought), -1.0), (bought, np.zeros(len(bought), dtype=np.intp)))
    row_upper = program.row_upper.copy()
    # what else is shared counts on the headroom as it is, or is said by D, too
    n_crowded = int(relaxation.charger_slots.sum())
    row_upper[relaxation.shared.start + len(limited) + n_crowded : relaxation.shared.stop] = np.inf
    return replace(
        program,
        cost=np.append(np.zeros(at.total), 1.0),
        matrix=csr_matrix(hstack([program.matrix, csr_matrix(ones, shape=(len(row_upper), 1))])),
        row_upper=row_upper,
        lower=np.append(_with(program.lower, at.u[n]), 0.0),
        upper=np.append(program.upper, np.inf),
    )
