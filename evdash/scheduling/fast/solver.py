"""P1 solved exactly and fast: relaxation, contracts, recourse; what stays open all at once.

Every stage works on one program, held open in HiGHS. A point is proven once it costs no more
than TIE_USD above the bound, and the stages end there. Limits are numbers of branch-and-bound
nodes and of linear programs, and the effort at last, so that the answer is the same on every
machine.
"""

import numpy as np

from evdash.scheduling.effort import Effort
from evdash.scheduling.fast.charges import charges_of
from evdash.scheduling.fast.contracts import search_contracts
from evdash.scheduling.fast.full import everything_open
from evdash.scheduling.fast.master import contracts_chosen, relaxation_solved
from evdash.scheduling.fast.recourse import schedule_for
from evdash.scheduling.fast.relaxation import Relaxation, relaxation_of
from evdash.scheduling.fast.relevance import charger_slots
from evdash.scheduling.fast.search import WHOLE_U, Search
from evdash.scheduling.highs import LpPoint, Session
from evdash.scheduling.problem import Problem, Solution


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


def master_and_recourse(search: Search, root: LpPoint) -> None:
    """The contracts all at once by HiGHS, then their schedule."""
    u = contracts_chosen(search, root)
    if u is not None:
        schedule_for(search, u)


STAGES = (search_contracts, master_and_recourse, everything_open)


def nobody_new(relaxation: Relaxation, root: LpPoint) -> bool:
    """Whether the LP admits no part of any request."""
    requests = relaxation.columns.u[relaxation.problem.n_contracts :]
    return bool((root.values[requests] <= WHOLE_U).all())


def made_from(problem: Problem) -> Relaxation:
    """The relaxation of a problem, chargers only where they can bind."""
    charges, headroom_kw = charges_of(problem), problem.rows.headroom_kw()
    slots = charger_slots(problem, charges, headroom_kw)
    return relaxation_of(problem, charges, headroom_kw, slots)
