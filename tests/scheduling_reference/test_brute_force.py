"""P1 against every possible u and D, tried one by one, with scipy's LP for P."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evdash.horizon.day import run_day, start_day
from evdash.scheduling.p1 import p1_policy
from evdash.scheduling.problem import OPTIMALITY_USD
from evdash.scheduling.reference import solve_reference
from tests.horizon.days import crowded_days, small_days, snapshots
from tests.scheduling_reference.by_hand import HAIR, best_objective


def assert_every_step_is_optimal(scenario) -> None:
    trace = run_day(start_day(scenario), p1_policy(solve_reference))
    for step, snapshot in zip(trace.steps, snapshots(trace), strict=True):
        report, best = step.plan.report, best_objective(snapshot)
        revenue = sum(r.revenue for r in step.requests if r.vehicle in step.plan.admitted)
        price = snapshot.price_per_kwh * snapshot.interval_hours
        worth = float(price @ step.plan.power_kw.sum(axis=0)) - revenue
        assert report.status == "optimal"
        assert report.objective == pytest.approx(worth, abs=1e-9)
        assert report.bound <= best + HAIR
        assert best - HAIR <= worth <= best + OPTIMALITY_USD + HAIR


@settings(max_examples=40)
@given(st.one_of(small_days(), crowded_days(3, 3)))
def test_no_plan_of_any_kind_is_worth_more(scenario):
    assert_every_step_is_optimal(scenario)


@pytest.mark.long
@settings(max_examples=200)
@given(st.one_of(small_days(5, 4), crowded_days(3, 4)))
def test_no_plan_of_any_kind_is_worth_more_in_more_and_larger_days(scenario):
    assert_every_step_is_optimal(scenario)
