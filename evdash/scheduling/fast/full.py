"""P1 as a whole under the same cuts, with what the best point rules out taken off first."""

import numpy as np

from evdash.scheduling.fast.branch import Settled, branch, cost_of_running
from evdash.scheduling.fast.search import Search
from evdash.scheduling.highs import LpPoint

GAP_USD = 0.004
NODES = 1000


def everything_open(search: Search, root: LpPoint) -> None:
    """Branch and bound over u and D; lifts the bound, offers what it finds.

    `root` is the LP without any bound on u. Where running a pair, or admitting or refusing a
    request, costs more than the gap to the best point by reduced costs, it is settled.
    """
    at, program = search.relaxation.columns, search.relaxation.program
    gap = search.cost - root.objective
    reduced = root.reduced_cost[at.u]
    lower, upper = program.lower[at.u].copy(), program.upper[at.u].copy()
    free = lower < upper
    upper[free & (reduced > gap)] = 0.0
    lower[free & (-reduced > gap)] = 1.0
    off = cost_of_running(search, root.reduced_cost) > gap
    settled = Settled(off, np.zeros_like(off), lower, upper)
    outcome = branch(search, settled, nodes=NODES, absolute_gap=GAP_USD)
    if outcome.values is not None:
        search.offer(outcome.values)
    # what was settled can only be dearer than the best point
    search.bound = max(search.bound, min(outcome.bound, search.cost))
