"""What would keep every promise after all: more chargers, more headroom, later returns."""

from collections.abc import Callable
from dataclasses import replace
from math import isfinite

import numpy as np
import pulp

from evdash.domain.limits import STATION
from evdash.errors import SolverFailure
from evdash.scheduling.effort import Effort
from evdash.scheduling.equations import (
    Equation,
    Model,
    build,
    charger_count,
    charger_power,
    contracts_stay,
    energy_owed,
    feeder_limits,
    only_contracts_charge,
    station_power,
    time_of_return,
)
from evdash.scheduling.guarded import answered
from evdash.scheduling.problem import Bools, Problem
from evdash.scheduling.reference import minimise_with_highs
from evdash.scheduling.shortfall import HAIR

WORK = 3e6
"""What all remedies of one happening may take, as `Effort` counts it."""
SHARE = 0.3
"""Of what is left of it, for each question."""
CHARGING: tuple[Equation, ...] = (
    contracts_stay,
    only_contracts_charge,
    charger_power,
    time_of_return,
    energy_owed,
    station_power,
)
MORE = "more"


def relief_effort() -> Effort:
    """What may be spent on all remedies together."""
    return Effort(WORK)


def more_chargers(problem: Problem, effort: Effort) -> int | None:
    """The fewest chargers besides those there are that would do; None where none would."""

    def enough_chargers(model: Model) -> None:
        more = model.lp.add_variable(MORE, lowBound=0, cat=pulp.LpInteger)
        for t in model.slots:
            running = pulp.lpSum(model.D[n][t] for n in model.vehicles)
            model.lp += running - more <= model.data.chargers, f"chargers_{t}"
        model.lp.setObjective(more)

    found = _least(problem, (*CHARGING, feeder_limits, enough_chargers), 0.5, effort)
    return None if found is None else round(found)


def more_headroom_kw(problem: Problem, effort: Effort) -> float | None:
    """The least headroom besides what there is, alike in every slot, that would do, kW."""

    def enough_headroom(model: Model) -> None:
        more = model.lp.add_variable(MORE, lowBound=0)
        rows = model.data.rows
        for row in range(len(rows.elements)):
            coefficient = rows.coefficient[row, STATION]
            for t in model.slots:
                if isfinite(rows.limit_kw[t, row]):
                    drawn = coefficient * (model.station_kw[t] - more)
                    model.lp += drawn <= rows.limit_kw[t, row], f"limit_{row}_{t}"
        model.lp.setObjective(more)

    return _least(problem, (*CHARGING, charger_count, enough_headroom), HAIR, effort)


def later_return(problem: Problem, who: Bools, effort: Effort) -> int | None:
    """By how many slots those marked, (vehicles,), would have to wait longer; None if no wait does.

    Longer waits hold all that shorter ones do, so that halving finds the least.
    """

    def kept(slots: int) -> bool:
        later = np.where(who, np.minimum(problem.intervals_left + slots, problem.n_slots), 0)
        ends = np.maximum(problem.intervals_left, later)
        waiting = replace(problem, intervals_left=ends)
        equations = (*CHARGING, charger_count, feeder_limits, _nothing)
        return _least(waiting, equations, 1.0, effort) is not None

    return _halved(kept, int(problem.n_slots - problem.intervals_left[who].min(initial=0)))


def _halved(holds: Callable[[int], bool], most: int) -> int | None:
    if most < 1 or not holds(most):
        return None
    low, high = 0, most
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


def _nothing(model: Model) -> None:
    model.lp.setObjective(pulp.LpAffineExpression(constant=0))


def _least(
    problem: Problem, equations: tuple[Equation, ...], gap: float, effort: Effort
) -> float | None:
    """The least value of a formulation's objective; None if it has no solution, or none was found,
    which `effort` then tells."""
    share = effort.part(SHARE)
    if share.is_spent:
        share.cut()
        return None
    model = build(problem, equations, "relief")
    try:
        answered(lambda: minimise_with_highs(model, share, gap), share)
    except SolverFailure:
        return None
    return float(pulp.value(model.lp.objective) or 0.0)
