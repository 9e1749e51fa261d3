"""What contracts would miss at the least, if limits are lowered under them: recourse.

The least is taken in this order, each as far as those before it allow: energy missing, kWh;
vehicles short; what those give up who changed their own terms, kWh; money, $. Never is a limit
of the feeder, a charger or a window given up for it.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pulp

from evdash.domain.limits import Floats
from evdash.domain.plan import Snapshot
from evdash.domain.vehicles import ENERGY_TOLERANCE_KWH
from evdash.errors import ImpossibleCommitments, Shortfall, SolverFailure
from evdash.scheduling.clean import cleaned
from evdash.scheduling.equations import (
    RECOURSE,
    RECOURSE_OBJECTIVES,
    Equation,
    Model,
    build,
    fewest_vehicles_short,
    least_money,
)
from evdash.scheduling.equations import least_given_up as most_granted
from evdash.scheduling.problem import Problem, contracts_problem
from evdash.scheduling.reference import minimise_with_highs, power_of

SECONDS = 20.0
SECONDS_A_TIE = 4.0
"""For each of the objectives after the first, which only choose among equal shortfalls."""
HAIR = 1e-6
"""How far above its least an objective may end for the sake of those after it, kWh or count."""
GAPS: Mapping[Equation, float] = {fewest_vehicles_short: 0.5, least_money: 0.005}
"""What proves the least of an objective that is not in kWh: a count, or half a cent."""
NOTICED_KWH = 10 * ENERGY_TOLERANCE_KWH
"""Shortfall below this is the solver's tolerance and none."""


@dataclass(frozen=True, slots=True)
class Recourse:
    """A schedule (vehicles, slots) in kW, what each vehicle misses under it, (vehicles,) in kWh.

    `proven` says whether no schedule misses less energy.
    """

    power_kw: Floats
    short_kwh: Floats
    proven: bool = True


def least_shortfall(problem: Problem, seconds: float = SECONDS) -> Recourse:
    """The schedule that misses least, by all objectives in their order.

    Raises SolverFailure if none was found in time.
    """
    ends = time.perf_counter() + seconds
    model = build(problem, RECOURSE, "recourse")
    proven, power = False, problem.tail_kw
    for objective in RECOURSE_OBJECTIVES:
        left = max(0.5, ends - time.perf_counter())
        if objective is not RECOURSE_OBJECTIVES[0]:
            left = min(left, SECONDS_A_TIE)
            if _nothing_missing(problem, power):
                break
        try:
            least = _minimised(model, objective, left)
        except SolverFailure:
            if objective is RECOURSE_OBJECTIVES[0]:
                raise
            break  # what was found by the objectives before it stands
        if objective is RECOURSE_OBJECTIVES[0]:
            proven = model.lp.sol_status == pulp.LpSolutionOptimal
        power = power_of(model)
        model.lp += model.lp.objective <= least + HAIR, f"least_{objective.__name__}"
    return _settled(problem, power, proven)


def _minimised(model: Model, objective: Equation, seconds: float) -> float:
    """The least value of an objective within what is held already."""
    objective(model)
    minimise_with_highs(model, seconds, absolute_gap=GAPS.get(objective, HAIR / 10))
    return float(pulp.value(model.lp.objective) or 0.0)


def _nothing_missing(problem: Problem, power_kw: Floats) -> bool:
    delivered = power_kw.sum(axis=1) * problem.interval_hours
    return bool((problem.owed_kwh - delivered <= NOTICED_KWH).all())


def _settled(problem: Problem, power_kw: Floats, proven: bool) -> Recourse:
    """Power exact within bounds for what each vehicle gets, and what it does not get."""
    delivered = power_kw.sum(axis=1) * problem.interval_hours
    gets = np.where(problem.owed_kwh - delivered <= NOTICED_KWH, problem.owed_kwh, delivered)
    gets = np.where(gets <= NOTICED_KWH, 0.0, gets)
    everyone = np.ones(problem.n_vehicles, dtype=bool)
    power_kw = cleaned(replace(problem, owed_kwh=gets), everyone, power_kw)
    return Recourse(power_kw, np.maximum(0.0, problem.owed_kwh - gets), proven)


def most_energy_for(problem: Problem, extra_kwh: float, seconds: float = SECONDS) -> Recourse:
    """As much of `extra_kwh` for the last vehicle as leaves every vehicle all the rest it is owed.

    The last vehicle's energy owed includes the extra. Raises SolverFailure if there is no such
    schedule, or none was found in time.
    """
    model = build(problem, RECOURSE, "extra")
    for short in model.short_kwh:
        short.upBound = 0.0
    model.short_kwh[-1].upBound = extra_kwh
    _minimised(model, most_granted, seconds)
    return _settled(problem, power_of(model), model.lp.sol_status == pulp.LpSolutionOptimal)


def plan_for_contracts(snapshot: Snapshot) -> Floats:
    """A schedule (contracts, slots) in kW that keeps every contract, whatever it costs.

    Raises ImpossibleCommitments with the least possible missing energy if there is none,
    SolverFailure if that could not be found out in time.
    """
    problem = contracts_problem(snapshot)
    if problem.n_vehicles == 0:
        return problem.tail_kw
    found = least_shortfall(problem)
    missing = np.flatnonzero(found.short_kwh > 0)
    if len(missing) and not found.proven:
        raise SolverFailure("whether the contracts can be kept could not be decided in time")
    if len(missing):
        raise ImpossibleCommitments(
            [Shortfall(problem.vehicles[n], float(found.short_kwh[n])) for n in missing]
        )
    return found.power_kw
