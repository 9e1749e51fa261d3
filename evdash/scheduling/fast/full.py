"""P1 as a whole under the same cuts, with what the best point rules out taken off first."""

import numpy as np

from evdash.scheduling.fast.branch import (
    GAP_USD,
    HAIR_USD,
    branch,
    settled_by_reduced_costs,
)
from evdash.scheduling.fast.search import Search
from evdash.scheduling.highs import LpPoint

NODES = 1000


def everything_open(search: Search, root: LpPoint) -> None:
    """Branch and bound over u and D; lifts the bound, offers what it finds.

    Guessing the distance of the optimum, as the master does, costs more here than it saves.
    """
    settled = settled_by_reduced_costs(search, root, search.cost - root.objective + HAIR_USD)
    outcome = branch(search, settled, nodes=NODES, absolute_gap=GAP_USD)
    if outcome.values is not None:
        search.offer(outcome.values)
    elif np.isposinf(outcome.bound):
        return  # the best point is not ruled out: "infeasible" cannot be true and proves nothing
    # what was settled can only be dearer than the best point
    search.bound = max(search.bound, min(outcome.bound, search.cost))
