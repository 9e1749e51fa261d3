"""The schedule that misses least keeps every limit to the bit that floating point leaves."""

from dataclasses import replace

import numpy as np
import pytest

from evdash.errors import SolverFailure
from evdash.scheduling.problem import Problem
from evdash.scheduling.shortfall import Recourse, least_shortfall, most_energy_for, step_effort
from tests.scheduling.problems import random_problem

TOLERANCE_KW, TOLERANCE_KWH = 1e-7, 1e-6
"""A tenth of what the checker allows."""


def scarce(seed: int) -> Problem:
    """Contracts of which not all can be kept; those in the second half changed their own terms."""
    rng = np.random.default_rng(seed)
    problem = random_problem(rng)
    rows = replace(problem.rows, limit_kw=rng.uniform(0.2, 1.0) * problem.rows.limit_kw)
    return replace(
        problem,
        n_contracts=(problem.n_vehicles + 1) // 2,
        chargers=max(1, problem.chargers // 2),
        rows=rows,
        revenue=0.3 * problem.owed_kwh,
    )


def problems_of(problem: Problem, found: Recourse) -> list[str]:
    power, running = found.power_kw, found.power_kw > 0
    lowest = np.broadcast_to(problem.low_kw[:, None], power.shape)
    gets = problem.owed_kwh - found.short_kwh
    broken = {
        "headroom": (power.sum(axis=0) > problem.rows.headroom_kw() + TOLERANCE_KW).any(),
        "chargers": (running.sum(axis=0) > problem.chargers).any(),
        "window": running[~problem.window].any(),
        "lowest": (power[running] < lowest[running] - TOLERANCE_KW).any(),
        "highest": (power > problem.high_kw[:, None] + TOLERANCE_KW).any(),
        "energy": (abs(power.sum(axis=1) * problem.interval_hours - gets) > TOLERANCE_KWH).any(),
    }
    return [name for name, is_broken in broken.items() if is_broken]


@pytest.mark.parametrize("first", range(0, 60, 20))
def test_nothing_is_exceeded_by_the_hair_between_two_objectives(first):
    for seed in range(first, first + 20):
        problem = scarce(seed)
        assert problems_of(problem, least_shortfall(problem, step_effort())) == [], seed


def test_more_is_granted_within_every_limit_to_the_last_bit():
    granted = 0
    for seed in range(20):
        problem = scarce(seed)
        kept = least_shortfall(problem, step_effort())
        owed = problem.owed_kwh - kept.short_kwh
        owed[-1] += 5.0
        low = np.minimum(problem.low_kw, owed / problem.interval_hours)
        asked = replace(problem, owed_kwh=owed, low_kw=low)
        try:
            found = most_energy_for(asked, 5.0, step_effort())
        except SolverFailure:
            continue  # a lowest power that is larger for the larger need leaves no room
        assert problems_of(asked, found) == [], seed
        granted += 1
    assert granted > 10
