"""The schedule that misses least keeps every limit to the bit that floating point leaves."""

from dataclasses import replace

import numpy as np
import pytest

from evdash.domain.limits import LimitRows
from evdash.domain.tariff import Tariff
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


def one_charger_for_two(slots: int, second_stays: int, dearer: float, *, turned: bool) -> Problem:
    """One who needs every slot there is, and one there for some of them who pays `dearer`.

    Whoever has the charger, as much energy is missing.
    """
    order = [1, 0] if turned else [0, 1]
    return Problem(
        vehicles=("all day", "for a while"),
        n_contracts=2,
        owed_kwh=np.array([10.0 * slots, 10.0 * (second_stays + 1)])[order],
        intervals_left=np.array([slots, second_stays])[order],
        low_kw=np.full(2, 1.4),
        high_kw=np.full(2, 10.0),
        revenue=np.array([10.0 * slots, dearer * 10.0 * (second_stays + 1)])[order],
        tariff=Tariff(np.full(slots, 0.1), 1.0),
        chargers=1,
        rows=LimitRows((), np.empty((0, 1)), np.empty((slots, 0))),
        tail_kw=np.zeros((2, slots)),
    )


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("dearer", [0.5, 1.0, 2.0])
def test_no_money_makes_a_second_vehicle_short(dearer, turned):
    """Where one is short already, fewer there cannot be; that is held, too."""
    for slots in range(2, 8):
        for stays in range(1, slots):
            problem = one_charger_for_two(slots, stays, dearer, turned=turned)
            found = least_shortfall(problem, step_effort())
            assert found.short_kwh.sum() == pytest.approx(10.0 * (stays + 1))
            assert (found.short_kwh > 0).sum() == 1, (slots, stays)


def test_no_driver_gives_up_for_money_what_can_be_had():
    """One promise is short whatever is done; another driver changed its terms and pays little."""
    for pays in (0.0, 0.05, 1.0):
        both = one_charger_for_two(4, 2, pays, turned=False)
        problem = replace(both, n_contracts=1, chargers=2, owed_kwh=np.array([50.0, 20.0]))
        found = least_shortfall(problem, step_effort())
        assert found.short_kwh == pytest.approx([10.0, 0.0])
