"""Cleaning: what a solver gives to its tolerance becomes exact, within bounds to the bit."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from evdash.horizon.day import run_day, start_day
from evdash.scheduling.clean import cleaned
from evdash.scheduling.p1 import p1_policy
from evdash.scheduling.problem import Problem, problem_of
from evdash.scheduling.reference import solve_reference
from tests.builders import make_scenario, vehicle
from tests.horizon.days import crowded_days, small_days, snapshots

P1 = p1_policy(solve_reference)


def assert_exact(problem: Problem, admitted: np.ndarray, power_kw: np.ndarray) -> None:
    low, high = problem.low_kw[:, None], problem.high_kw[:, None]
    running = power_kw > 0
    assert ((power_kw == 0) | (power_kw >= low)).all()
    assert (power_kw <= high).all()
    assert not (running & ~problem.window).any()
    assert not running[~admitted].any()
    delivered = power_kw.sum(axis=1) * problem.interval_hours
    assert np.allclose(delivered, np.where(admitted, problem.owed_kwh, 0.0), rtol=0, atol=1e-9)


@settings(max_examples=40)
@given(st.one_of(small_days(6, 5), crowded_days(5, 6)), st.integers(0, 10_000))
def test_a_plan_shaken_within_solver_tolerance_is_put_right(scenario, seed):
    shake = np.random.default_rng(seed)
    trace = run_day(start_day(scenario), P1)
    for taken, snapshot in zip(trace.steps, snapshots(trace), strict=True):
        problem = problem_of(snapshot)
        admitted = np.array([name in taken.plan.vehicles for name in problem.vehicles], bool)
        exact = np.zeros((problem.n_vehicles, problem.n_slots))
        exact[admitted] = taken.plan.power_kw
        if problem.n_vehicles:
            noise = shake.uniform(-1e-7, 1e-7, exact.shape)
            assert_exact(problem, admitted, cleaned(problem, admitted, exact + noise))


def test_energy_to_correct_goes_where_there_is_room():
    vehicles = [vehicle("v", need_kwh=10.0, option="C2")]
    trace = start_day(make_scenario(vehicles=vehicles))
    problem = problem_of(snapshots(run_day(trace, P1))[0])
    short = np.array([[10 - 1e-7, 0.0, 0.0, 0.0]])
    long_ = np.array([[10 + 1e-7, 0.0, 0.0, 0.0]])
    split = np.array([[2 - 1e-7, 8.0 - 1e-7, 0.0, 0.0]])
    for power_kw in (short, long_, split):
        assert_exact(problem, np.array([True]), cleaned(problem, np.array([True]), power_kw))


@settings(max_examples=40)
@given(st.one_of(small_days(6, 5), crowded_days(5, 6)))
def test_delivered_and_tail_add_up_to_the_need_at_every_step(scenario):
    trace = run_day(start_day(scenario), P1)
    for taken in trace.steps:
        tail = taken.after.tail_kw.sum(axis=1) * scenario.interval_hours
        for contract, planned in zip(taken.after.contracts, tail, strict=True):
            assert abs(contract.delivered_kwh + planned - contract.request.need_kwh) <= 1e-6
