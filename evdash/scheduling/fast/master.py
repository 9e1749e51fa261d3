"""Who gets a contract: u whole, D continuous, under all cuts. Its bound bounds P1.

With few requests undecided a search of our own does best, as every one of its LPs starts from
the last basis and gets vehicle cuts of its own; where it would take too many, HiGHS takes over.
"""

import heapq

import numpy as np

from evdash.domain.limits import Floats
from evdash.errors import SolverFailure
from evdash.scheduling.fast.branch import branch, settled_by_reduced_costs
from evdash.scheduling.fast.search import CUT_ROUNDS, Search
from evdash.scheduling.highs import LpPoint

WHOLE_U = 1e-6
GAP_USD = 0.004
OWN_NODES, OWN_WORK, OWN_REQUESTS = 40, 12_000, 16
"""Own search: at most so many LPs, so many LPs times pairs of vehicle and slot, and requests."""
OWN_CUT_ROUNDS = 4
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
    """u of the master, (vehicles,), whole; None if none was found. Lifts the bound."""
    values, cost = best_first(search, root)
    if cost > search.bound + GAP_USD and not search.out_of_time:
        values = by_guessing(search, root, values, cost)
    return None if values is None else np.asarray(np.round(values[search.relaxation.columns.u]))


def is_whole(u: Floats) -> bool:
    """Whether every request is admitted or refused, none by halves."""
    return bool((np.abs(u - np.round(u)) <= WHOLE_U).all())


def best_first(search: Search, root: LpPoint) -> tuple[Floats | None, float]:
    """Branch and bound over u, lowest bound first, within a few LPs: best point and cost, $."""
    at, program = search.relaxation.columns, search.relaxation.program
    if is_whole(root.values[at.u]):
        return root.values, root.objective
    opened = [(root.objective, 0, root.values[at.u], program.lower[at.u], program.upper[at.u])]
    allowed = min(OWN_NODES, OWN_WORK // at.n_pairs)
    if (program.lower[at.u] < program.upper[at.u]).sum() > OWN_REQUESTS:
        return None, np.inf
    best, cost, solved = None, np.inf, 0
    while opened and solved < allowed and not search.out_of_time:
        bound, _, u, lower, upper = heapq.heappop(opened)
        search.bound = max(search.bound, min(bound, cost))
        if cost <= bound + GAP_USD:
            break
        n = int(np.abs(u - np.round(u)).argmax())
        for value in (np.round(u[n]), 1 - np.round(u[n])):
            fixed_lower, fixed_upper = lower.copy(), upper.copy()
            fixed_lower[n] = fixed_upper[n] = value
            search.session.bound(at.u, fixed_lower, fixed_upper)
            solved, child = solved + 1, search.relaxed(OWN_CUT_ROUNDS)
            if child is None and not search.session.infeasible:
                return best, cost  # stopped, not disproven
            if child is None:
                continue
            if not is_whole(child.values[at.u]):
                node = (child.objective, solved, child.values[at.u], fixed_lower, fixed_upper)
                heapq.heappush(opened, node)
            elif child.objective < cost:
                best, cost = child.values, child.objective
    if not opened and best is not None:
        search.bound = max(search.bound, cost)
    return best, cost


def by_guessing(search: Search, root: LpPoint, best: Floats | None, cost: float) -> Floats | None:
    """The master by HiGHS, from a guess how far above the LP the optimum lies.

    Reduced costs settle what the guess rules out, and few requests are left to branch over. A
    point within the guess proves it; none within it proves the optimum beyond it, and the next
    guess is wider. `best`, at `cost` in $, is a point known already.
    """
    for guess in GUESSES_USD:
        beyond = min(root.objective + guess, cost)
        if beyond <= search.bound:
            continue
        settled = settled_by_reduced_costs(search, root, beyond - root.objective)
        outcome = branch(search, settled, nodes=NODES, only_u=True, absolute_gap=GAP_USD)
        if np.isinf(beyond) and outcome.values is None:
            break  # the tail is a point of P1: with nothing ruled out, "infeasible" proves nothing
        search.bound = max(search.bound, min(outcome.bound, beyond))
        if outcome.values is not None:
            found = float(search.relaxation.program.cost @ outcome.values)
            if found < cost:
                best, cost = outcome.values, found
        if outcome.bound < beyond or cost <= search.bound + GAP_USD or search.out_of_time:
            break
    return best
