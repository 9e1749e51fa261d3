"""Who gets a contract: u whole, D continuous, under all cuts. Its bound bounds P1."""

import numpy as np

from evdash.domain.limits import Floats
from evdash.errors import SolverFailure
from evdash.scheduling.fast.branch import branch, settled_by_reduced_costs
from evdash.scheduling.fast.search import CUT_ROUNDS, Search
from evdash.scheduling.highs import LpPoint

WHOLE_U = 1e-6
GAP_USD = 0.004
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
    """u of the master, (vehicles,), whole; None if none was found. Lifts the bound.

    Guesses how far above the LP the optimum lies, settles what reduced costs then rule out and
    branches over the few requests left. A point within the guess proves the guess; none within
    it proves the optimum beyond it, and the next guess is wider.
    """
    at = search.relaxation.columns
    u = root.values[at.u]
    if (np.abs(u - np.round(u)) <= WHOLE_U).all():
        return np.asarray(np.round(u))
    best: Floats | None = None
    for guess in GUESSES_USD:
        beyond = root.objective + guess
        settled = settled_by_reduced_costs(search, root, guess)
        outcome = branch(search, settled, nodes=NODES, only_u=True, absolute_gap=GAP_USD)
        search.bound = max(search.bound, min(outcome.bound, beyond))
        if outcome.values is not None:
            best = outcome.values
            if search.relaxation.program.cost @ best <= beyond:
                break
        if outcome.bound < beyond or search.proven or search.out_of_time:
            break
    return None if best is None else np.asarray(np.round(best[at.u]))
