"""Who gets a contract: u whole, D continuous, under all cuts. Its bound bounds P1."""

import numpy as np

from evdash.domain.limits import Floats
from evdash.errors import SolverFailure
from evdash.scheduling.fast.search import CUT_ROUNDS, Search
from evdash.scheduling.highs import LpPoint, whole

WHOLE_U = 1e-6
GAP_USD = 0.004
NODES = 2000


def relaxation_solved(search: Search) -> LpPoint | None:
    """The LP under vehicle cuts: the first bound. Raises SolverFailure if it is infeasible."""
    root = search.relaxed(CUT_ROUNDS)
    if search.session.infeasible:
        raise SolverFailure("no schedule keeps all contracts")
    if root is not None:
        search.bound = root.objective
    return root


def contracts_chosen(search: Search, root: LpPoint) -> Floats | None:
    """u of the master, (vehicles,), whole; None if none was found. Lifts the bound."""
    at, program = search.relaxation.columns, search.relaxation.program
    u = root.values[at.u]
    if (np.abs(u - np.round(u)) > WHOLE_U).any():
        mask = np.zeros(at.total, dtype=bool)
        mask[at.u] = program.lower[at.u] < program.upper[at.u]
        outcome = search.session.branched(
            whole(mask), search.seconds_left, nodes=NODES, absolute_gap=GAP_USD
        )
        search.bound = max(search.bound, outcome.bound)
        if outcome.values is None:
            return None
        u = outcome.values[at.u]
    return np.asarray(np.round(u))
