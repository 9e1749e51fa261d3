"""What the fast solver does at its limits, and that its answer depends on nothing else."""

import numpy as np
import pytest

from evdash.domain.limits import LimitRows
from evdash.domain.tariff import Tariff
from evdash.errors import SolverFailure
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import run_day, start_day
from evdash.scheduling.effort import Effort
from evdash.scheduling.fast.solver import solve_fast
from evdash.scheduling.p1 import p1_policy
from evdash.scheduling.problem import OPTIMALITY_USD, Problem
from evdash.scheduling.reference import solve_reference
from tests.builders import PRESETS
from tests.scheduling.problems import HAIR, random_problem, violations


def test_without_time_the_tail_is_kept_and_nothing_is_claimed():
    rng = np.random.default_rng(0)
    for _ in range(30):
        problem = random_problem(rng, max_vehicles=12, max_slots=8)
        solution = solve_fast(problem, Effort(0.0))
        value = problem.objective(solution.admitted, solution.power_kw)
        assert violations(problem, solution) == []
        assert value <= problem.tail_objective
        assert solution.bound <= solve_reference(problem, Effort()).bound + OPTIMALITY_USD


def test_the_same_problem_has_the_same_answer():
    rng = np.random.default_rng(1)
    for _ in range(20):
        problem = random_problem(rng, max_vehicles=12, max_slots=8)
        one, other = solve_fast(problem, Effort()), solve_fast(problem, Effort())
        assert one.bound == other.bound
        assert np.array_equal(one.power_kw, other.power_kw)


def test_contracts_that_cannot_be_kept_are_a_failure():
    problem = Problem(
        vehicles=("v0",),
        n_contracts=1,
        owed_kwh=np.array([30.0]),
        intervals_left=np.array([2]),
        low_kw=np.array([3.3]),
        high_kw=np.array([11.0]),
        revenue=np.zeros(1),
        tariff=Tariff(np.ones(2), 1.0),
        chargers=1,
        rows=LimitRows((), np.empty((0, 1)), np.empty((2, 0))),
        tail_kw=np.zeros((1, 2)),
    )
    # an infeasible tail must not be taken for a plan: ask as the loop asks, with time
    problem.tail_kw[:] = 15.0
    with pytest.raises(SolverFailure):
        solve_fast(problem, Effort())


@pytest.mark.parametrize("preset", ["summer-weekday", "negative-price", "past-midnight"])
def test_a_day_is_optimal_at_every_step_with_either_solver(preset):
    scenario = edit_scenario(read_scenario(PRESETS / preset), {"arrivals.vehicles_per_day": 40.0})
    for solve in (solve_fast, solve_reference):
        trace = run_day(start_day(scenario), p1_policy(solve))
        for step in trace.steps:
            report = step.plan.report
            assert report.status == "optimal"
            assert report.bound - HAIR <= report.objective <= report.bound + OPTIMALITY_USD
