"""P1 solved as the paper writes it: PuLP builds the equations, a solver takes them whole."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import highspy
import numpy as np
import pulp

from evdash.domain.limits import Floats
from evdash.errors import SolverFailure
from evdash.scheduling.effort import Effort, Meter
from evdash.scheduling.equations import P1, Equation, Model, build
from evdash.scheduling.problem import Problem, Solution

ABSOLUTE_GAP_USD = 0.004
ROUNDING = 1e-9
ENDED = (
    highspy.HighsModelStatus.kOptimal,
    highspy.HighsModelStatus.kInfeasible,
    highspy.HighsModelStatus.kUnboundedOrInfeasible,
)
"""How a search ends that was not cut short."""


def solve_reference(
    problem: Problem, effort: Effort, equations: Sequence[Equation] = P1
) -> Solution:
    """The plain formulation on HiGHS; raises SolverFailure if no feasible point was found."""
    model = build(problem, equations)
    bound = minimise_with_highs(model, effort, ABSOLUTE_GAP_USD)
    return Solution(values(model.u) > 0.5, power_of(model), bound)


@dataclass(frozen=True, slots=True)
class _Found:
    """A point of a model, its objective and bound, and whether its search came to an end."""

    objective: float
    bound: float
    point: Mapping[str, float]
    ended: bool


def minimise_with_highs(model: Model, effort: Effort, absolute_gap: float) -> float:
    """Solve a model that is feasible by its making, and return the bound proven.

    HiGHS 1.15 is asked twice, without presolve and with it. With it, some feasible programs come
    back infeasible (its issue 3296) and a point 0.30 $ too dear as optimal (its issue 3274);
    without it, one 0.013 $ too dear: each on one random interval of P1 in some hundreds. The
    cheaper point counts, and the lower bound of those that came to their end. The first has half
    the effort: what one finds at its root may keep the other for minutes. Raises SolverFailure
    if neither found a point; `effort` then tells whether it was cut short.
    """
    asked = [
        _asked(model, effort.part(share), presolve, absolute_gap)
        for presolve, share in (("off", 0.5), ("choose", 1.0))
    ]
    found = [one for _, one in asked if one is not None]
    if not found:
        if any(status not in ENDED for status, _ in asked):
            effort.cut()
        raise SolverFailure(f"HiGHS found no plan: {pulp.LpSolution[model.lp.sol_status]}")
    best = min(found, key=lambda one: one.objective)
    model.lp.assignVarsVals(best.point)
    bound = min(one.bound for one in [one for one in found if one.ended] or found)
    proven = best.objective <= bound + absolute_gap + ROUNDING
    if not proven:
        effort.cut()
    model.lp.sol_status = pulp.LpSolutionOptimal if proven else pulp.LpSolutionIntegerFeasible
    return bound


def _asked(
    model: Model, effort: Effort, presolve: str, absolute_gap: float
) -> tuple[highspy.HighsModelStatus, _Found | None]:
    """One search within an effort: how it ended, and what it found."""
    meter = Meter(effort, len(model.lp.variables()))
    model.lp.solve(
        pulp.HiGHS(
            msg=False,
            gapRel=0.0,
            gapAbs=absolute_gap,
            threads=1,
            callbackTuple=(meter, None),
            callbacksToActivate=[highspy.cb.HighsCallbackType.kCallbackMipInterrupt],
            presolve=presolve,
            random_seed=0,
            mip_feasibility_tolerance=1e-9,
            primal_feasibility_tolerance=1e-9,
        )
    )
    highs = model.lp.solverModel
    status, info = highs.getModelStatus(), highs.getInfo()
    meter.settle()
    if info.primal_solution_status != highspy.SolutionStatus.kSolutionStatusFeasible:
        return status, None
    point = {variable.name: variable.value() for variable in model.lp.variables()}
    objective = float(pulp.value(model.lp.objective) or 0.0)
    return status, _Found(objective, float(info.mip_dual_bound), point, status in ENDED)


def power_of(model: Model) -> Floats:
    """Power of each vehicle and slot, kW, where its charger is on."""
    on = np.array([values(row) for row in model.D]) > 0.5
    power = np.array([values(row) for row in model.P])
    return np.where(on, power, 0.0)


def values(variables: Sequence[pulp.LpVariable]) -> Floats:
    """The values of PuLP variables after solving."""
    return np.array([variable.value() for variable in variables], dtype=float)
