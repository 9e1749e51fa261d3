"""P1 solved exactly and fast: relaxation, contracts, schedules; what stays open all at once.

Every stage works on one program, held open in HiGHS. A point is proven once it costs no more
than TIE_USD above the bound, and the stages end there. Limits are numbers of branch-and-bound
nodes and of linear programs, and the effort at last, so that the answer is the same on every
machine.
"""

import numpy as np

from evdash.domain.limits import Floats
from evdash.errors import SolverFailure
from evdash.scheduling.effort import Effort
from evdash.scheduling.fast.branch import (
    GAP_USD,
    HAIR_USD,
    branch,
    by_guessing,
    settled_by_reduced_costs,
)
from evdash.scheduling.fast.contracts import search_contracts
from evdash.scheduling.fast.relaxation import Relaxation, made_from
from evdash.scheduling.fast.schedules import schedule_for
from evdash.scheduling.fast.search import CUT_ROUNDS, WHOLE_U, Search, is_whole
from evdash.scheduling.highs import LpPoint, Session
from evdash.scheduling.problem import Problem, Solution

MASTER_NODES, NODES = 2000, 1000
GUESSES_USD = (0.1, 1.0, np.inf)


def solve_fast(problem: Problem, effort: Effort) -> Solution:
    """A point of P1 and a proven bound, within a cent of each other unless a limit was met."""
    return solved(made_from(problem), effort)


def solved(relaxation: Relaxation, effort: Effort) -> Solution:
    """The same for a relaxation however made."""
    search = search_over(relaxation, effort)
    root = relaxation_solved(search)
    # a request worth less than the cent of proof is not turned away for it
    if root is None or (search.proven and nobody_new(relaxation, root)):
        return search.solution()
    for stage in STAGES:
        stage(search, root)
        if search.proven or search.effort.is_spent:
            break
    return search.solution()


def search_over(relaxation: Relaxation, effort: Effort) -> Search:
    """A solve not yet begun: the last plan's tail is the best point known."""
    problem = relaxation.problem
    return Search(
        relaxation=relaxation,
        session=Session(relaxation.program),
        effort=effort,
        admitted=np.arange(problem.n_vehicles) < problem.n_contracts,
        power_kw=problem.tail_kw,
        cost=problem.tail_objective,
    )


def relaxation_solved(search: Search) -> LpPoint | None:
    """The LP under vehicle cuts: the first bound. Raises SolverFailure if it is infeasible."""
    at, program = search.relaxation.columns, search.relaxation.program
    root = search.relaxed(program.lower[at.u], program.upper[at.u], CUT_ROUNDS)
    if search.session.infeasible:
        raise SolverFailure("no schedule keeps all contracts")
    if root is not None:
        search.bound = root.objective
    return root


def nobody_new(relaxation: Relaxation, root: LpPoint) -> bool:
    """Whether the LP admits no part of any request."""
    requests = relaxation.columns.u[relaxation.problem.n_contracts :]
    return bool((root.values[requests] <= WHOLE_U).all())


def master_and_schedule(search: Search, root: LpPoint) -> None:
    """The contracts all at once by HiGHS, then their schedule."""
    u = contracts_chosen(search, root)
    if u is not None:
        schedule_for(search, u)


def contracts_chosen(search: Search, root: LpPoint) -> Floats | None:
    """u of the master, (vehicles,), whole; None if none is better than what is known.

    Who gets a contract: u whole, D continuous, under all cuts, by HiGHS, for where the lists of
    `contracts.py` grow too long. Its bound bounds P1 and is lifted.
    """
    if is_whole(root.values[search.relaxation.columns.u]):
        return np.asarray(np.round(root.values[search.relaxation.columns.u]))
    u, cost = None, search.cost

    def attempt(beyond: float) -> float:
        nonlocal u, cost
        settled = settled_by_reduced_costs(search, root, beyond - root.objective)
        outcome = branch(search, settled, nodes=MASTER_NODES, only_u=True, absolute_gap=GAP_USD)
        if outcome.values is not None:
            found = float(search.relaxation.program.cost @ outcome.values)
            if found < cost:
                u, cost = np.round(outcome.values[search.relaxation.columns.u]), found
        return outcome.bound

    bound = by_guessing(root.objective, GUESSES_USD, lambda: cost, attempt)
    search.bound = max(search.bound, bound)
    return u


def everything_open(search: Search, root: LpPoint) -> None:
    """P1 as a whole under the same cuts: lifts the bound, offers what it finds.

    What the best point rules out is taken off first. Guessing the distance of the optimum, as
    the master does, costs more here than it saves.
    """
    settled = settled_by_reduced_costs(search, root, search.cost - root.objective + HAIR_USD)
    outcome = branch(search, settled, nodes=NODES, absolute_gap=GAP_USD)
    if outcome.values is not None:
        search.offer(outcome.values)
    elif np.isposinf(outcome.bound):
        return  # the best point is not ruled out: "infeasible" cannot be true and proves nothing
    # what was settled can only be dearer than the best point
    search.bound = max(search.bound, min(outcome.bound, search.cost))


STAGES = (search_contracts, master_and_schedule, everything_open)
