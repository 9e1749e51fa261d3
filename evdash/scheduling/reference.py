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

    HiGHS 1.15's presolve calls some feasible mixed-integer programs infeasible (its issue
    3296), among them one in some thousand intervals of P1; it is then asked again without.
    """
    for presolve in ("choose", "off"):
        model.lp.solve(
            pulp.HiGHS(
                msg=False,
                timeLimit=seconds,
                gapRel=0.0,
                gapAbs=absolute_gap,
                threads=1,
                random_seed=0,
                mip_feasibility_tolerance=1e-9,
                primal_feasibility_tolerance=1e-9,
                presolve=presolve,
            )
        )
        if model.lp.sol_status in (pulp.LpSolutionOptimal, pulp.LpSolutionIntegerFeasible):
            return float(model.lp.solverModel.getInfo().mip_dual_bound)
    raise SolverFailure(f"HiGHS found no plan: {pulp.LpSolution[model.lp.sol_status]}")


def power_of(model: Model) -> Floats:
    """Power of each vehicle and slot, kW, where its charger is on."""
    on = np.array([values(row) for row in model.D]) > 0.5
    power = np.array([values(row) for row in model.P])
    return np.where(on, power, 0.0)


def values(variables: Sequence[pulp.LpVariable]) -> Floats:
    """The values of PuLP variables after solving."""
    return np.array([variable.value() for variable in variables], dtype=float)
