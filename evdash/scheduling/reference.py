"""P1 solved as the paper writes it: PuLP builds the equations, a solver takes them whole."""

import time
from collections.abc import Sequence

import numpy as np
import pulp

from evdash.domain.limits import Floats
from evdash.errors import SolverFailure
from evdash.scheduling.equations import P1, Equation, Model, build
from evdash.scheduling.problem import Problem, Solution

ABSOLUTE_GAP_USD = 0.004


def solve_reference(
    problem: Problem, seconds: float, equations: Sequence[Equation] = P1
) -> Solution:
    """The plain formulation on HiGHS; raises SolverFailure if no feasible point was found."""
    began = time.perf_counter()
    model = build(problem, equations)
    left = max(0.1, seconds - (time.perf_counter() - began))
    bound = minimise_with_highs(model, left, ABSOLUTE_GAP_USD)
    return Solution(values(model.u) > 0.5, power_of(model), bound)


def minimise_with_highs(model: Model, seconds: float, absolute_gap: float) -> float:
    """Solve a model that is feasible by its making, and return the bound proven.

    HiGHS 1.15 is asked twice, without presolve and with it. With it, some feasible programs come
    back infeasible (its issue 3296) and a point 0.30 $ too dear as optimal (its issue 3274);
    without it, one 0.013 $ too dear: each on one random interval of P1 in some hundreds. The
    cheaper point counts, and the lower bound of those that found one. The first has half the
    time: what one finds at its root may keep the other for minutes.
    """
    began, found = time.perf_counter(), []
    for presolve, share in (("off", 0.5), ("choose", 1.0)):
        left = max(0.1, share * (seconds - (time.perf_counter() - began)))
        model.lp.solve(
            pulp.HiGHS(
                msg=False,
                timeLimit=left,
                gapRel=0.0,
                gapAbs=absolute_gap,
                threads=1,
                presolve=presolve,
                random_seed=0,
                mip_feasibility_tolerance=1e-9,
                primal_feasibility_tolerance=1e-9,
            )
        )
        status = model.lp.sol_status
        if status in (pulp.LpSolutionOptimal, pulp.LpSolutionIntegerFeasible):
            point = {variable.name: variable.value() for variable in model.lp.variables()}
            bound = float(model.lp.solverModel.getInfo().mip_dual_bound)
            found.append((float(pulp.value(model.lp.objective) or 0.0), bound, status, point))
    if not found:
        raise SolverFailure(f"HiGHS found no plan: {pulp.LpSolution[model.lp.sol_status]}")
    _, _, model.lp.sol_status, point = min(found, key=lambda one: one[0])
    model.lp.assignVarsVals(point)
    return min(bound for _, bound, _, _ in found)


def power_of(model: Model) -> Floats:
    """Power of each vehicle and slot, kW, where its charger is on."""
    on = np.array([values(row) for row in model.D]) > 0.5
    power = np.array([values(row) for row in model.P])
    return np.where(on, power, 0.0)


def values(variables: Sequence[pulp.LpVariable]) -> Floats:
    """The values of PuLP variables after solving."""
    return np.array([variable.value() for variable in variables], dtype=float)
