"""P1 solved exactly and fast: relaxation, tree or master, recourse, at last everything at once.

Every stage works on one program, held open in HiGHS. A point is proven once it costs no more
than TIE_USD above the bound, and the stages end there. Limits are numbers of branch-and-bound
nodes, so that the answer is the same on every machine; time is only the last safety.
"""

import time

import numpy as np

from evdash.scheduling.fast.charges import charges_of
from evdash.scheduling.fast.full import everything_open
from evdash.scheduling.fast.master import contracts_chosen, relaxation_solved
from evdash.scheduling.fast.recourse import schedule_for
from evdash.scheduling.fast.relaxation import Relaxation, relaxation_of
from evdash.scheduling.fast.relevance import charger_slots
from evdash.scheduling.fast.search import WHOLE_U, Search
from evdash.scheduling.fast.tree import search_contracts
from evdash.scheduling.highs import LpPoint, Session
from evdash.scheduling.problem import Problem, Solution

REQUESTS = 60
"""With more requests undecided they are a knapsack, which HiGHS does faster than the tree."""


def solve_fast(problem: Problem, seconds: float) -> Solution:
    """A point of P1 and a proven bound, within a cent of each other unless a limit was met."""
    return solved(made_from(problem), seconds)


def solved(relaxation: Relaxation, seconds: float) -> Solution:
    """The same for a relaxation however made."""
    search = search_over(relaxation, seconds)
    root = relaxation_solved(search)
    # a request worth less than the cent of proof is not turned away for it
    if root is None or (search.proven and nobody_new(relaxation, root)):
        return search.solution()
    few = undecided(relaxation) <= REQUESTS
    first, *others = (search_contracts, *AT_ONCE) if few else AT_ONCE
    first(search, root)
    for stage in others:
        if search.proven or search.out_of_time:
            break
        stage(search, root)
    return search.solution()


def search_over(relaxation: Relaxation, seconds: float) -> Search:
    """A solve not yet begun: the last plan's tail is the best point known."""
    problem = relaxation.problem
    return Search(
        relaxation=relaxation,
        session=Session(relaxation.program),
        ends=time.perf_counter() + seconds,
        admitted=np.arange(problem.n_vehicles) < problem.n_contracts,
        power_kw=problem.tail_kw,
        cost=problem.tail_objective,
    )


def master_and_recourse(search: Search, root: LpPoint) -> None:
    """The contracts all at once by HiGHS, then their schedule."""
    u = contracts_chosen(search, root)
    if u is not None:
        schedule_for(search, u)


AT_ONCE = (master_and_recourse, everything_open)


def undecided(relaxation: Relaxation) -> int:
    """How many requests could be served."""
    u, program = relaxation.columns.u, relaxation.program
    return int((program.lower[u] < program.upper[u]).sum())


def nobody_new(relaxation: Relaxation, root: LpPoint) -> bool:
    """Whether the LP admits no part of any request."""
    requests = relaxation.columns.u[relaxation.problem.n_contracts :]
    return bool((root.values[requests] <= WHOLE_U).all())


def made_from(problem: Problem) -> Relaxation:
    """The relaxation of a problem, chargers only where they can bind."""
    charges, headroom_kw = charges_of(problem), problem.rows.headroom_kw()
    slots = charger_slots(problem, charges, headroom_kw)
    return relaxation_of(problem, charges, headroom_kw, slots)
