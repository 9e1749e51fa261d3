"""The fast solver against the paper's formulation, interval by interval, to the cent."""

from unittest.mock import patch

import numpy as np
import pytest

from benchmarks.random_days import random_scenario
from evdash.domain.elements import Element
from evdash.domain.limits import LimitRows
from evdash.domain.tariff import Tariff
from evdash.horizon.day import run_day, start_day
from evdash.scheduling.effort import Effort
from evdash.scheduling.fast import solver
from evdash.scheduling.fast.solver import solve_fast
from evdash.scheduling.p1 import p1_policy
from evdash.scheduling.problem import OPTIMALITY_USD, Problem
from evdash.scheduling.reference import ABSOLUTE_GAP_USD, solve_reference
from tests.scheduling.problems import HAIR, random_problem, violations


def assert_agrees(problem: Problem) -> None:
    """Feasible, within a cent of its own bound, and the bound below the reference's optimum.

    Whether contracts are searched in lists or, as where those grow too long, by HiGHS.
    """
    reference = solve_reference(problem, Effort())
    other = problem.objective(reference.admitted, reference.power_kw)
    assert other - reference.bound <= ABSOLUTE_GAP_USD + HAIR
    for stages in (solver.STAGES, solver.STAGES[1:]):
        with patch.object(solver, "STAGES", stages):
            fast = solve_fast(problem, Effort())
        value = problem.objective(fast.admitted, fast.power_kw)
        assert violations(problem, fast) == []
        assert fast.bound <= other + HAIR
        assert value <= fast.bound + OPTIMALITY_USD
        assert reference.bound - HAIR <= value <= other + OPTIMALITY_USD + HAIR


@pytest.mark.parametrize("seed", range(10))
def test_random_intervals(seed):
    rng = np.random.default_rng(seed)
    for _ in range(100):
        assert_agrees(random_problem(rng))


@pytest.mark.parametrize("seed", range(2))
def test_contracts_without_slack(seed):
    rng = np.random.default_rng([7, seed])
    for _ in range(60):
        assert_agrees(random_problem(rng, slack=0.0))


@pytest.mark.long
@pytest.mark.parametrize("seed", range(100, 130))
def test_many_random_intervals(seed):
    rng = np.random.default_rng(seed)
    for _ in range(200):
        assert_agrees(random_problem(rng, max_vehicles=12, max_slots=8))


@pytest.mark.long
@pytest.mark.parametrize("seed", range(100))
def test_whole_random_days(seed):
    def both(problem: Problem, effort: Effort):
        assert_agrees(problem)
        return solve_fast(problem, effort)

    run_day(start_day(random_scenario(seed)), p1_policy(both))


def test_the_interval_highs_presolve_gets_wrong():
    rng = np.random.default_rng(117)
    problem = [random_problem(rng, max_vehicles=12, max_slots=8) for _ in range(50)][-1]
    assert_agrees(problem)
    # what CBC finds; with its presolve, HiGHS 1.15.1 calls 2.1646 optimal
    assert solve_fast(problem, Effort()).bound == pytest.approx(1.8617371, abs=1e-5)


def one_vehicle(**changes) -> Problem:
    """One request of 12 kWh over two cheap-then-dear hours; fields as changed."""
    fields = {
        "vehicles": ("v0",),
        "n_contracts": 0,
        "owed_kwh": np.array([12.0]),
        "intervals_left": np.array([2]),
        "low_kw": np.array([3.3]),
        "high_kw": np.array([11.0]),
        "revenue": np.array([4.2]),
        "tariff": Tariff(np.array([0.05, 0.1]), 1.0),
        "chargers": 1,
        "rows": LimitRows((Element("line", "a", "b"),), np.ones((1, 1)), np.full((2, 1), 20.0)),
        "tail_kw": np.zeros((1, 2)),
    }
    return Problem(**(fields | changes))


def test_the_rest_of_a_charge_runs_at_the_lowest_power():
    problem = one_vehicle()
    solution = solve_fast(problem, Effort())
    # 11 + 1 kWh would be cheaper, but a charger that runs gives at least 3.3 kW
    assert solution.power_kw[0] == pytest.approx([8.7, 3.3])
    assert solution.bound == pytest.approx(8.7 * 0.05 + 3.3 * 0.1 - 4.2)


@pytest.mark.parametrize(
    "changes",
    [
        {"chargers": 0},
        {"rows": LimitRows((Element("line", "a", "b"),), np.ones((1, 1)), np.zeros((2, 1)))},
        {"tariff": Tariff(np.array([0.5, 0.6]), 1.0)},
        {"intervals_left": np.array([0])},
        {"owed_kwh": np.array([13.0]), "low_kw": np.array([8.0])},
        {"owed_kwh": np.array([23.0])},
    ],
    ids=["no charger", "no headroom", "a loss", "no time", "between", "too much"],
)
def test_who_cannot_be_served_or_would_cost_is_left_out(changes):
    problem = one_vehicle(**changes)
    solution = solve_fast(problem, Effort())
    assert not solution.admitted.any()
    assert solution.bound == pytest.approx(0.0, abs=HAIR)
    assert_agrees(problem)


@pytest.mark.parametrize(
    "changes",
    [
        {"tariff": Tariff(np.array([-0.1, -0.3]), 1.0)},
        {"owed_kwh": np.array([0.02]), "low_kw": np.array([0.02]), "revenue": np.array([0.007])},
        {"owed_kwh": np.array([11.0])},
        {"owed_kwh": np.array([22.0])},
        {"rows": LimitRows((), np.empty((0, 1)), np.empty((2, 0)))},
        {"tariff": Tariff(np.array([0.05, 0.1]), 0.25), "owed_kwh": np.array([4.0])},
    ],
    ids=["paid to charge", "small need", "one whole slot", "no slack", "no limits", "quarters"],
)
def test_who_can_be_served_at_a_gain_is_taken(changes):
    problem = one_vehicle(**changes)
    assert solve_fast(problem, Effort()).admitted.all()
    assert_agrees(problem)
