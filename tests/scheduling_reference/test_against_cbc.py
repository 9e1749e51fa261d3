"""On intervals too large to enumerate, CBC finds the value HiGHS found, to the cent."""

import pulp
import pytest

from benchmarks.random_days import random_scenario
from evdash.domain.plan import Snapshot
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import run_day, start_day
from evdash.scheduling.equations import P1, build
from evdash.scheduling.p1 import p1_policy
from evdash.scheduling.problem import OPTIMALITY_USD, problem_of
from evdash.scheduling.reference import solve_reference
from tests.builders import PRESETS
from tests.horizon.days import snapshots

CBC_USD = 1e-3
"""What CBC's own tolerances may shift an objective by."""


def cbc_objective(snapshot: Snapshot) -> float:
    problem = problem_of(snapshot)
    model = build(problem, P1)
    model.lp.solve(pulp.PULP_CBC_CMD(msg=False, gapRel=0, gapAbs=1e-4, threads=1))
    assert model.lp.sol_status == pulp.LpSolutionOptimal
    return float(pulp.value(model.lp.objective) or 0.0)


def assert_cbc_agrees(scenario, intervals) -> None:
    trace = run_day(start_day(scenario), p1_policy(solve_reference))
    for k, snapshot in enumerate(snapshots(trace)):
        if k in intervals and snapshot.requests:
            report, other = trace.steps[k].plan.report, cbc_objective(snapshot)
            assert report.bound <= other + CBC_USD
            assert other - CBC_USD <= report.objective <= other + OPTIMALITY_USD + CBC_USD


@pytest.mark.parametrize("preset", ["summer-weekday", "negative-price", "voltage-limited"])
def test_cbc_agrees_on_the_evening_of_the_presets(preset):
    scenario = edit_scenario(read_scenario(PRESETS / preset), {"arrivals.vehicles_per_day": 60.0})
    assert_cbc_agrees(scenario, range(15, 20))


@pytest.mark.parametrize("seed", [5, 18, 31])
def test_cbc_agrees_on_random_days(seed):
    assert_cbc_agrees(random_scenario(seed), range(3, 40, 6))


@pytest.mark.long
@pytest.mark.parametrize("seed", range(100, 160))
def test_cbc_agrees_on_many_random_days(seed):
    assert_cbc_agrees(random_scenario(seed), range(100))
