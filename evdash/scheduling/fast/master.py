"""Who gets a contract: u whole, D continuous, under all cuts. Its bound bounds P1.

By HiGHS, for where the lists of `contracts.py` grow too long.
"""

import numpy as np

from evdash.domain.limits import Floats
from evdash.errors import SolverFailure
from evdash.scheduling.fast.branch import (
    GAP_USD,
    branch,
    by_guessing,
    settled_by_reduced_costs,
)
from evdash.scheduling.fast.search import CUT_ROUNDS, Search, is_whole
from evdash.scheduling.highs import LpPoint

NODES = 2000
GUESSES_USD = (0.1, 1.0, np.inf)


def relaxation_solved(search: Search) -> LpPoint | None:
    """The LP under vehicle cuts: the first bound. Raises SolverFailure if it is infeasible."""
    root = search.relaxed(CUT_ROUNDS)
    if search.session.infeasible:
        raise SolverFailure("no schedule keeps all contracts")
    if root is not None:
        search.bound = root.objective
    return root


def contracts_chosen(search: Search, root: LpPoint) -> Floats | None:
    """u of the master, (vehicles,), whole; None if none is better than what is known.

    Lifts the bound.
    """
    if is_whole(root.values[search.relaxation.columns.u]):
        return np.asarray(np.round(root.values[search.relaxation.columns.u]))
    u, cost = None, search.cost

    def attempt(beyond: float) -> float:
        nonlocal u, cost
        settled = settled_by_reduced_costs(search, root, beyond - root.objective)
        outcome = branch(search, settled, nodes=NODES, only_u=True, absolute_gap=GAP_USD)
        if outcome.values is not None:
            found = float(search.relaxation.program.cost @ outcome.values)
            if found < cost:
                u, cost = np.round(outcome.values[search.relaxation.columns.u]), found
        return outcome.bound

    bound = by_guessing(root.objective, GUESSES_USD, lambda: cost, attempt)
    search.bound = max(search.bound, bound)
    return u
