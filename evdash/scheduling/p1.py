"""The paper's policy: P1 solved at every interval."""

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from evdash.domain.limits import Floats
from evdash.domain.plan import Plan, Policy, Refusal, Snapshot, SolveReport
from evdash.errors import SolverFailure
from evdash.scheduling.clean import cleaned
from evdash.scheduling.earliest import earliest_first
from evdash.scheduling.effort import Effort
from evdash.scheduling.fast.solver import solve_fast
from evdash.scheduling.guarded import answered
from evdash.scheduling.problem import (
    OPTIMALITY_USD,
    TIE_USD,
    Bools,
    Problem,
    Solution,
    problem_of,
)
from evdash.scheduling.refused import LEFT_OUT, reasoned

WORK = 2e7
"""What an interval may take, as `Effort` counts: a processor 7 to 30 s."""
EARLIEST_WORK = 1e7
"""The same for the linear program that makes a plan the earliest, which has never come near it."""
REASON_WORK = 5e6
"""The same for each small P1 that says why somebody was refused."""
ROUNDING_USD = 1e-8

Solver = Callable[[Problem, Effort], Solution]
Choice = Callable[[Problem, Bools, Floats, float], Floats]
"""Which of the plans that are worth the same: from who is admitted, powers and bound."""


def p1_policy(solve: Solver = solve_fast, work: float = WORK) -> Policy:
    """The policy that maximises the profit of what is known now, with so much work.

    It says of everyone it refuses why, as far as that can be proven.
    """
    return reasoned(p1_plans(solve, work), p1_answers(work=REASON_WORK))


def p1_plans(solve: Solver = solve_fast, work: float = WORK) -> Policy:
    """The same plans without asking why anybody is refused."""
    return partial(_decided, solve, work, _earlier)


def p1_answers(solve: Solver = solve_fast, work: float = WORK) -> Policy:
    """The same answers and the same value to the cent, any plan: where nobody is to follow it."""
    return partial(_decided, solve, work, _as_found)


def _decided(solve: Solver, work: float, choice: Choice, snapshot: Snapshot) -> Plan:
    began = time.perf_counter()
    problem = problem_of(snapshot)
    if problem.n_vehicles:
        effort = Effort(work)
        solution = usable(answered(partial(solve, problem, effort), effort), problem)
    else:
        solution = _nothing(problem)
    return plan_of(snapshot, problem, solution, began, choice=choice)


def usable(solution: Solution, problem: Problem) -> Solution:
    """The solution, if it is made of numbers; SolverFailure otherwise.

    Whether those keep promises and limits is for the checker to say.
    """
    shape = (problem.n_vehicles, problem.n_slots)
    if solution.power_kw.shape != shape or solution.admitted.shape != shape[:1]:
        raise SolverFailure("the solver's answer is to another problem")
    if not np.isfinite(solution.power_kw).all():
        raise SolverFailure("the solver's answer holds what is not a number")
    if np.isnan(solution.bound):
        return replace(solution, bound=-np.inf)
    return solution


def plan_of(
    snapshot: Snapshot,
    problem: Problem,
    solution: Solution,
    began: float,
    *,
    choice: Choice,
) -> Plan:
    """A clean plan from a solution, or the tail if that is cheaper; of equal ones by `choice`."""
    admitted, power_kw = solution.admitted, cleaned(problem, solution.admitted, solution.power_kw)
    if problem.tail_objective <= problem.objective(admitted, power_kw):
        admitted, power_kw = _contracts_only(problem), problem.tail_kw
    reached = problem.objective(admitted, power_kw)
    # a bound that a point undercuts by more than the cent of proof is none
    bound = min(solution.bound, reached) if solution.bound <= reached + OPTIMALITY_USD else -np.inf
    power_kw = choice(problem, admitted, power_kw, bound)
    objective = problem.objective(admitted, power_kw)
    if objective < bound - ROUNDING_USD:  # the plan chosen undercuts it, if by no more than a cent
        bound = objective
    under_contract = np.flatnonzero(admitted)
    return Plan(
        now=snapshot.now,
        vehicles=tuple(problem.vehicles[n] for n in under_contract),
        power_kw=power_kw[under_contract],
        admitted=tuple(problem.vehicles[n] for n in under_contract[problem.n_contracts :]),
        refused=refusals(snapshot, problem, admitted),
        report=SolveReport(
            status="optimal" if objective <= bound + OPTIMALITY_USD else "feasible",
            objective=objective,
            bound=bound if np.isfinite(bound) else None,
            seconds=time.perf_counter() - began,
        ),
    )


def refusals(snapshot: Snapshot, problem: Problem, admitted: Bools) -> tuple[Refusal, ...]:
    """Who is turned down, and why."""
    taken = {problem.vehicles[n] for n in np.flatnonzero(admitted)}
    return tuple(
        Refusal(request.vehicle, request.refusal or LEFT_OUT)
        for request in snapshot.requests
        if request.vehicle not in taken
    )


def _earlier(problem: Problem, admitted: Bools, power_kw: Floats, bound: float) -> Floats:
    """Decision 6: the earliest plan within a cent of the bound and never dearer than the tail."""
    revenue = float(problem.revenue @ admitted)
    limit = max(
        min(bound + TIE_USD, problem.tail_objective) + revenue, problem.tariff.cost(power_kw)
    )
    try:
        effort = Effort(EARLIEST_WORK)
        moved = partial(earliest_first, problem, power_kw > 0, power_kw, limit, effort)
        earlier = answered(moved, effort)
    except SolverFailure:
        return power_kw
    earlier = cleaned(problem, admitted, earlier)
    return earlier if problem.tariff.cost(earlier) <= limit + ROUNDING_USD else power_kw


def _as_found(_problem: Problem, _admitted: Bools, power_kw: Floats, _bound: float) -> Floats:
    return power_kw


def _contracts_only(problem: Problem) -> Bools:
    return np.arange(problem.n_vehicles) < problem.n_contracts


def _nothing(problem: Problem) -> Solution:
    return Solution(_contracts_only(problem), problem.tail_kw, 0.0)
