"""A bound is never above the objective it is told with."""

import numpy as np
import pytest

from evdash.horizon.advance import snapshot_of
from evdash.horizon.day import start_day
from evdash.scheduling.p1 import plan_of
from evdash.scheduling.problem import Solution, problem_of
from tests.builders import make_scenario, vehicle


def test_a_plan_that_undercuts_a_bound_by_less_than_a_cent_lowers_it():
    trace = start_day(
        make_scenario(price=(0.1, 0.1005, 0.1), vehicles=[vehicle("V", need_kwh=16.0, option="C2")])
    )
    snapshot = snapshot_of(trace.inputs, trace.state)
    problem = problem_of(snapshot)
    dear, cheap = np.array([[8.0, 8.0, 0.0]]), np.array([[8.0, 0.0, 8.0]])
    admitted = np.array([True])
    reached = problem.objective(admitted, dear)
    assert problem.objective(admitted, cheap) == pytest.approx(reached - 0.004)
    solution = Solution(admitted, dear, reached)
    plan = plan_of(snapshot, problem, solution, 0.0, choice=lambda *_: cheap)
    assert plan.report.bound == plan.report.objective == problem.objective(admitted, cheap)
