"""Decision 6: among plans within a cent the earliest, and never at more than the cent."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evdash.domain.plan import Plan, Snapshot
from evdash.horizon.day import run_day, start_day, step
from evdash.scheduling.p1 import p1_policy
from evdash.scheduling.problem import OPTIMALITY_USD, TIE_USD
from evdash.scheduling.reference import solve_reference
from tests.builders import make_scenario, vehicle
from tests.horizon.days import crowded_days, small_days, snapshots, with_headroom
from tests.scheduling_reference.by_hand import earliest_possible, earliness

P1 = p1_policy(solve_reference)
HAIR = 1e-6


def energy_cost(snapshot: Snapshot, power_kw: np.ndarray) -> float:
    return float(snapshot.price_per_kwh @ power_kw.sum(axis=0)) * snapshot.interval_hours


def revenue(snapshot: Snapshot, plan: Plan) -> float:
    return sum(r.revenue for r in snapshot.requests if r.vehicle in plan.admitted)


def test_at_equal_prices_power_comes_as_early_as_it_fits():
    vehicles = [vehicle("v", need_kwh=24.0, option="C2", max_kw=9.0)]
    day = make_scenario(price=[0.1] * 6, vehicles=vehicles)
    plan = step(start_day(day), P1).steps[0].plan
    on = plan.power_kw[0] > 0
    # D is the solver's choice; with it fixed, 9 kW as long as the rest may still run at 2 kW
    assert earliness_is_least(plan.power_kw[0][on], 24.0, low=2.0, high=9.0)


def earliness_is_least(power: np.ndarray, need: float, low: float, high: float) -> bool:
    expected, left = [], need
    for later in reversed(range(len(power))):
        expected.append(min(high, left - low * later))
        left -= expected[-1]
    return power == pytest.approx(expected)


def test_less_than_a_cent_is_spent_to_be_earlier_and_more_is_not():
    def power(dearer: float) -> list[float]:
        vehicles = [vehicle("v", need_kwh=12.0, option="C2", max_kw=8.0)]
        room = with_headroom([8.0, 8.0, 0.0])
        day = make_scenario(**room, price=[0.1 + dearer, 0.1, 0.1], vehicles=vehicles)
        return step(start_day(day), P1).steps[0].plan.power_kw[0].tolist()

    assert power(0.0) == pytest.approx([8, 4, 0])
    assert power(0.001) == pytest.approx([8, 4, 0])  # 4 kWh earlier at 0.001 $: 0.4 cents
    assert power(0.02) == pytest.approx([4 + TIE_USD / 0.02, 8 - TIE_USD / 0.02, 0], abs=1e-5)


def assert_earliest_within_a_cent(scenario) -> None:
    trace = run_day(start_day(scenario), P1)
    for taken, snapshot in zip(trace.steps, snapshots(trace), strict=True):
        plan = taken.plan
        cost, gained = energy_cost(snapshot, plan.power_kw), revenue(snapshot, plan)
        tail_cost = energy_cost(snapshot, snapshot.tail_kw)
        assert cost - gained <= plan.report.bound + OPTIMALITY_USD
        assert cost - gained <= tail_cost + HAIR
        limit = min(plan.report.bound + TIE_USD, tail_cost) + gained
        least = earliest_possible(snapshot, plan, max(limit, cost))
        assert earliness(snapshot, plan.power_kw) <= least + 1e-4


@settings(max_examples=60)
@given(st.one_of(small_days(6, 5), crowded_days(5, 6)))
def test_no_plan_with_the_same_contracts_and_chargers_is_earlier(scenario):
    assert_earliest_within_a_cent(scenario)


@pytest.mark.long
@settings(max_examples=300)
@given(st.one_of(small_days(8, 8), crowded_days(8, 8)))
def test_no_plan_is_earlier_in_more_and_larger_days(scenario):
    assert_earliest_within_a_cent(scenario)
