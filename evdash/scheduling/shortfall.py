"""What contracts would miss at the least, if limits are lowered under them: recourse.

The least is taken in this order, each as far as those before it allow: energy missing, kWh;
vehicles short; what those give up who changed their own terms, kWh; money, $. Never is a limit
of the feeder, a charger or a window given up for it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import pulp

from evdash.domain.limits import Floats
from evdash.domain.plan import Snapshot
from evdash.domain.vehicles import ENERGY_TOLERANCE_KWH
from evdash.errors import ImpossibleCommitments, Shortfall, SolverFailure
from evdash.scheduling.clean import cleaned
from evdash.scheduling.effort import Effort
from evdash.scheduling.equations import (
    RECOURSE,
    RECOURSE_OBJECTIVES,
    Equation,
    Model,
    build,
    fewest_vehicles_short,
    least_given_up,
    least_missing_energy,
    least_money,
)
from evdash.scheduling.guarded import answered
from evdash.scheduling.problem import Bools, Problem, contracts_problem
from evdash.scheduling.reference import minimise_with_highs, power_of

WORK = 6e6
"""What one step may spend on all of it, as `Effort` counts: a processor half a minute at most."""
FIRST_SHARE, TIE_SHARE = 0.6, 0.4
"""Of the effort: for the energy missing; of what is left, for each of the objectives after it."""
HAIR = 1e-6
"""How far above its least an objective may end for the sake of those after it, kWh or count."""
GAPS: Mapping[Equation, float] = {fewest_vehicles_short: 0.5, least_money: 0.005}
"""What proves the least of an objective that is not in kWh: a count, or half a cent."""
ROUNDING = 1e-9
NOTICED_KWH = 10 * ENERGY_TOLERANCE_KWH
"""Shortfall below this is the solver's tolerance and none."""
HELD_KW = 1e-7
"""A limit exceeded by no more is kept; the checker allows ten times as much."""


@dataclass(frozen=True, slots=True)
class Recourse:
    """A schedule (vehicles, slots) in kW, what each vehicle misses under it, (vehicles,) in kWh.

    `proven` says whether no schedule misses less energy, `fewest` whether of those that miss
    as little none leaves fewer vehicles short.
    """

    power_kw: Floats
    short_kwh: Floats
    proven: bool = True
    fewest: bool = True


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


def step_effort() -> Effort:
    """What one step may spend on the contracts there are."""
    return Effort(WORK)


def least_shortfall(problem: Problem, effort: Effort) -> Recourse:
    """The schedule that misses least, by all objectives in their order.

    Raises SolverFailure if none was found within the effort.
    """
    model = build(problem, (*RECOURSE, fits_alone, fit_at_once), "recourse")
    first, *ties = RECOURSE_OBJECTIVES
    least = _minimised(model, first, effort.part(FIRST_SHARE))
    power, proven = power_of(model), {first: _is_proven(model)}
    if not _short(problem, power).any():
        return replace(_settled(problem, power), proven=proven[first])
    for objective in ties:
        model.lp += model.lp.objective <= least + HAIR, f"held_before_{objective.__name__}"
        known = _at_its_least(problem, power, objective)
        if known is not None:
            objective(model)  # to be held before those after it
            least = known
            continue
        proven[objective] = False
        try:
            least, power = _minimised(model, objective, effort.part(TIE_SHARE)), power_of(model)
        except SolverFailure:
            break  # what was found by the objectives before it stands
        proven[objective] = _is_proven(model)
    fewest = proven.get(fewest_vehicles_short, True)
    return replace(_settled(problem, power), proven=proven[first], fewest=fewest)


def _is_proven(model: Model) -> bool:
    return bool(model.lp.sol_status == pulp.LpSolutionOptimal)


def _short(problem: Problem, power_kw: Floats) -> Bools:
    """Which vehicles a schedule leaves short, (vehicles,)."""
    missing = problem.owed_kwh - power_kw.sum(axis=1) * problem.interval_hours
    return np.asarray(missing > NOTICED_KWH)


def _at_its_least(problem: Problem, power_kw: Floats, objective: Equation) -> float | None:
    """The value of an objective after the first, where the schedule there is cannot be bettered.

    Energy that is missing is missing to one at least; nobody can give up less than nothing.
    """
    short = _short(problem, power_kw)
    firm, own = short[: problem.n_contracts].sum(), short[problem.n_contracts :].sum()
    if objective is fewest_vehicles_short and firm <= 1:
        return float(firm)
    return 0.0 if objective is least_given_up and own == 0 else None


def _minimised(model: Model, objective: Equation, effort: Effort) -> float:
    """The least value of an objective within what is held already."""
    objective(model)
    minimise_with_highs(model, effort, absolute_gap=GAPS.get(objective, HAIR / 10))
    return float(pulp.value(model.lp.objective) or 0.0)


def _settled(problem: Problem, power_kw: Floats) -> Recourse:
    """Power exact within bounds and limits, and what each vehicle does not get under it.

    What is missing by no more than the solver's tolerance is delivered after all. Where that
    takes more than a limit leaves, as the hair between two objectives may have been spent there,
    powers are shifted by a linear program with everybody's charger on and off as found.
    """
    found = _snapped(problem, power_kw, NOTICED_KWH)
    if _is_within(problem, found.power_kw):
        return found
    for may_be_short in (found.short_kwh > 0, np.ones(problem.n_vehicles, dtype=bool)):
        try:
            shifted = _shifted(problem, found.power_kw > 0, may_be_short)
        except SolverFailure:
            continue
        return _snapped(problem, shifted, ROUNDING)
    return found


def _snapped(problem: Problem, power_kw: Floats, nothing_kwh: float) -> Recourse:
    """Power exact within bounds; what is missing by `nothing_kwh` at most is not missing."""
    delivered = power_kw.sum(axis=1) * problem.interval_hours
    gets = np.where(problem.owed_kwh - delivered <= nothing_kwh, problem.owed_kwh, delivered)
    gets = np.where(gets <= nothing_kwh, 0.0, gets)
    everyone = np.ones(problem.n_vehicles, dtype=bool)
    power_kw = cleaned(replace(problem, owed_kwh=gets), everyone, power_kw)
    return Recourse(power_kw, np.maximum(0.0, problem.owed_kwh - gets))


def _is_within(problem: Problem, power_kw: Floats) -> bool:
    """Whether a schedule keeps the limits of the feeder."""
    return bool((power_kw.sum(axis=0) <= problem.rows.headroom_kw() + HELD_KW).all())


def _shifted(problem: Problem, running: Bools, may_be_short: Bools) -> Floats:
    """The schedule that misses least with just these chargers on, (vehicles, slots)."""
    model = build(problem, RECOURSE, "shift")
    for n in model.vehicles:
        model.short_kwh[n].upBound = None if may_be_short[n] else 0.0
        for t in model.slots:
            model.D[n][t].bounds(int(running[n, t]), int(running[n, t]))
    for objective in (least_missing_energy, least_given_up, least_money):
        least = _minimised(model, objective, Effort())
        model.lp += model.lp.objective <= least + ROUNDING, f"held_{objective.__name__}"
    return power_of(model)


def most_energy_for(problem: Problem, extra_kwh: float, effort: Effort) -> Recourse:
    """As much of `extra_kwh` for the last vehicle as leaves every vehicle all the rest it is owed.

    The last vehicle's energy owed includes the extra. Raises SolverFailure if there is no such
    schedule, or none was found within the effort.
    """
    model = build(problem, (*RECOURSE, fits_alone, fit_at_once), "extra")
    for short in model.short_kwh:
        short.upBound = 0.0
    model.short_kwh[-1].upBound = extra_kwh
    _minimised(model, least_given_up, effort)
    return replace(_settled(problem, power_of(model)), proven=_is_proven(model))


def usable(found: Recourse, problem: Problem) -> Recourse:
    """What was found, if it is an answer to the problem that is true to itself.

    Whether it keeps limits is for the checker to say. Raises SolverFailure.
    """
    shapes = found.power_kw.shape, found.short_kwh.shape
    if shapes != (problem.window.shape, problem.owed_kwh.shape):
        raise SolverFailure("the solver's answer is to another problem")
    delivered = found.power_kw.sum(axis=1) * problem.interval_hours
    apart = np.abs(problem.owed_kwh - delivered - found.short_kwh)
    if not apart.max(initial=0.0) <= NOTICED_KWH:  # also where it is no number
        raise SolverFailure("the solver's answer does not deliver what it says")
    return found


def plan_for_contracts(snapshot: Snapshot) -> Floats:
    """A schedule (contracts, slots) in kW that keeps every contract, whatever it costs.

    Raises ImpossibleCommitments with the least possible missing energy if there is none,
    SolverFailure if that could not be found out within a step's effort.
    """
    problem = contracts_problem(snapshot)
    if problem.n_vehicles == 0:
        return problem.tail_kw
    effort = step_effort()
    found = usable(answered(partial(least_shortfall, problem, effort), effort), problem)
    missing = np.flatnonzero(found.short_kwh > 0)
    if len(missing) and not found.proven:
        raise SolverFailure("whether the contracts can be kept could not be decided")
    if len(missing):
        raise ImpossibleCommitments(
            [Shortfall(problem.vehicles[n], float(found.short_kwh[n])) for n in missing]
        )
    return found.power_kw
