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
    least_given_up,
    least_money,
)
from evdash.scheduling.problem import Problem, contracts_problem
from evdash.scheduling.reference import minimise_with_highs, power_of

SECONDS = 20.0
SECONDS_A_TIE = 4.0
"""For each of the objectives after the first, which only choose among equal shortfalls."""
HAIR = 1e-6
"""How far above its least an objective may end for the sake of those after it, kWh or count."""
GAPS: Mapping[Equation, float] = {fewest_vehicles_short: 0.5, least_money: 0.005}
"""What proves the least of an objective that is not in kWh: a count, or half a cent."""
ROUNDING = 1e-9
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


def fits_alone(model: Model) -> None:
    """Implied by (6b), (7b) and the limits: P ≤ min(high, headroom, s/Δt)·D."""
    data, headroom = model.data, model.data.rows.headroom_kw()
    for n in model.vehicles:
        for t in model.slots:
            most = min(headroom[t], data.owed_kwh[n] / data.interval_hours)
            if most < data.high_kw[n]:
                model.lp += model.P[n][t] <= float(most) * model.D[n][t], f"fits_{n}_{t}"


def fit_at_once(model: Model) -> None:
    """Implied by (6b) and the limits: no more run than fit at their lowest powers.

    Without this the relaxation runs everybody at half the lowest power, and proofs take minutes.
    """
    lowest = np.cumsum(np.sort(model.data.low_kw))
    headroom = model.data.rows.headroom_kw() * (1 + ROUNDING) + ROUNDING
    for t in model.slots:
        most = int((lowest <= headroom[t]).sum())
        if most < min(model.data.chargers, model.data.n_vehicles):
            running = pulp.lpSum(model.D[n][t] for n in model.vehicles)
            model.lp += running <= most, f"at_once_{t}"


def least_shortfall(problem: Problem, seconds: float = SECONDS) -> Recourse:
    """The schedule that misses least, by all objectives in their order.

    Raises SolverFailure if none was found in time.
    """
    ends = time.perf_counter() + seconds
    model = build(problem, (*RECOURSE, fits_alone, fit_at_once), "recourse")
    first, *ties = RECOURSE_OBJECTIVES
    least = _minimised(model, first, seconds)
    proven, power = model.lp.sol_status == pulp.LpSolutionOptimal, power_of(model)
    for objective in ties:
        if not _open(problem, power, objective):
            continue
        model.lp += model.lp.objective <= least + HAIR, f"held_before_{objective.__name__}"
        try:
            left = min(SECONDS_A_TIE, max(0.5, ends - time.perf_counter()))
            least, power = _minimised(model, objective, left), power_of(model)
        except SolverFailure:
            break  # what was found by the objectives before it stands
    return _settled(problem, power, proven)


def _open(problem: Problem, power_kw: Floats, objective: Equation) -> bool:
    """Whether an objective after the first can still change anything."""
    missing = problem.owed_kwh - power_kw.sum(axis=1) * problem.interval_hours
    short = missing > NOTICED_KWH
    if objective is fewest_vehicles_short:
        return int(short[: problem.n_contracts].sum()) > 1
    if objective is least_given_up:
        return bool(short[problem.n_contracts :].any())
    return bool(short.any())


def _minimised(model: Model, objective: Equation, seconds: float) -> float:
    """The least value of an objective within what is held already."""
    objective(model)
    minimise_with_highs(model, seconds, absolute_gap=GAPS.get(objective, HAIR / 10))
    return float(pulp.value(model.lp.objective) or 0.0)


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
    model = build(problem, (*RECOURSE, fits_alone, fit_at_once), "extra")
    for short in model.short_kwh:
        short.upBound = 0.0
    model.short_kwh[-1].upBound = extra_kwh
    _minimised(model, least_given_up, seconds)
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
