"""What admitting one request costs at least, by the LP alone: no branching, a few milliseconds."""

import numpy as np

from evdash.scheduling.fast.search import CUT_ROUNDS
from evdash.scheduling.fast.solver import made_from, search_over
from evdash.scheduling.problem import Problem

SECONDS = 5.0


def lp_bound_with(problem: Problem, vehicle: str) -> float:
    """What P1's value with this request in cannot fall below, $; inf if it cannot be in.

    −inf where the LP was not solved in time: nothing is proven then.
    """
    if vehicle not in problem.vehicles:
        return np.inf
    search = search_over(made_from(problem), SECONDS)
    n = problem.vehicles.index(vehicle)
    if not search.relaxation.charges.servable[n]:
        return np.inf
    one = np.ones(1)
    search.session.bound(search.relaxation.columns.u[n : n + 1], one, one)
    point = search.relaxed(CUT_ROUNDS)
    if point is None:
        return np.inf if search.session.infeasible else -np.inf
    return point.objective
