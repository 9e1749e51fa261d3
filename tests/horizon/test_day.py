"""The moving horizon over random days: every promise, every limit, nobody sees the future."""

import copy

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.random_days import random_scenario
from benchmarks.soundness import contracts_made, problems_of_day, without_times
from evdash.domain.scenario import Scenario
from evdash.domain.trace import State, Trace
from evdash.domain.vehicles import Contract
from evdash.horizon.advance import advance
from evdash.horizon.day import run_day, start_day, step
from evdash.horizon.inputs import prepare
from evdash.scheduling.p1 import p1_policy
from tests.builders import make_scenario, scenarios, vehicle
from tests.horizon.days import crowded_days, small_days

P1 = p1_policy()
DAYS = st.one_of(crowded_days(max_intervals=6), small_days(max_intervals=6, max_vehicles=6))


def by_hand(trace: Trace, policy=P1) -> Trace:
    while not trace.is_over:
        trace = step(trace, policy)
    return trace


def with_vehicles(scenario: Scenario, vehicles) -> Scenario:
    arrivals = scenario.arrivals.model_copy(update={"vehicles": tuple(vehicles)})
    return scenario.replacing(arrivals=arrivals)


@settings(max_examples=80)
@given(DAYS)
def test_every_promise_and_limit_is_kept(scenario):
    trace = run_day(start_day(scenario), P1)
    assert problems_of_day(trace) == []
    assert {s.plan.report.status for s in trace.steps} == {"optimal"}


@settings(max_examples=40)
@given(scenarios(max_vehicles=5))
def test_every_promise_and_limit_is_kept_on_random_feeders(scenario):
    assert problems_of_day(run_day(start_day(scenario), P1)) == []


@pytest.mark.parametrize("seed", [2, 4, 9, 15, 17, 24])
def test_every_promise_and_limit_is_kept_on_longer_days(seed):
    trace = run_day(start_day(random_scenario(seed)), P1)
    assert contracts_made(trace)
    assert problems_of_day(trace) == []


@pytest.mark.long
@settings(max_examples=500)
@given(st.one_of(small_days(8, 10), crowded_days(8, 8)))
def test_every_promise_and_limit_is_kept_in_many_days(scenario):
    assert problems_of_day(run_day(start_day(scenario), P1)) == []


@settings(max_examples=60)
@given(small_days(max_intervals=5, max_vehicles=6), st.integers(0, 4), st.integers(0, 3))
def test_no_decision_is_changed_by_who_comes_later(scenario, k, kept):
    """Remove some of the later arrivals and change the rest: earlier steps stay to the bit."""
    whole = run_day(start_day(scenario), P1)
    known = [r.vehicle for group in whole.inputs.requests[: k + 1] for r in group]
    earlier = [a for a in whole.inputs.arrivals if a.vehicle in known]
    later = [a for a in whole.inputs.arrivals if a.vehicle not in known][:kept]
    changed = [a.model_copy(update={"soc_in": a.soc_in / 2, "option": "C1"}) for a in later]
    other = run_day(start_day(with_vehicles(scenario, [*earlier, *changed])), P1)
    assert without_times(other)[: k + 1] == without_times(whole)[: k + 1]


def test_that_test_can_tell_a_future_known_from_one_unknown():
    """With two chargers' worth of later arrivals the very same scenario does go differently."""
    scenario = make_scenario(vehicles=[vehicle("a"), vehicle("b", hour=1), vehicle("c", hour=2)])
    whole = run_day(start_day(scenario), P1)
    fewer = run_day(start_day(with_vehicles(scenario, scenario.arrivals.vehicles[:1])), P1)
    assert without_times(fewer)[1:] != without_times(whole)[1:]


@settings(max_examples=40)
@given(DAYS)
def test_running_the_day_is_stepping_by_hand_and_deterministic(scenario):
    told: list[int] = []
    trace = run_day(start_day(scenario), P1, on_step=lambda t: told.append(t.now))
    assert told == list(range(1, scenario.intervals + 1))
    assert trace.is_over
    assert without_times(by_hand(start_day(scenario))) == without_times(trace)
    assert [s.interval for s in trace.steps] == list(range(scenario.intervals))
    for before, after in zip(trace.steps, trace.steps[1:], strict=False):
        assert before.after is after.before


def frozen(state: State) -> tuple[object, ...]:
    return (state.now, copy.deepcopy(state.contracts), state.tail_kw.tobytes())


@settings(max_examples=30)
@given(DAYS)
def test_nothing_given_is_ever_changed(scenario):
    trace = start_day(scenario)
    rows = trace.inputs.rows.limit_kw.copy()
    seen: list[tuple[Trace, int, object]] = []
    while not trace.is_over:
        seen.append((trace, len(trace.steps), frozen(trace.state)))
        trace = step(trace, P1)
    for given_trace, steps, state in seen:
        assert len(given_trace.steps) == steps
        assert frozen(given_trace.state) == state
    assert (trace.inputs.rows.limit_kw == rows).all()
    assert trace.inputs == trace.steps[0].inputs


@settings(max_examples=40)
@given(DAYS)
def test_advancing_delivers_one_interval_and_counts_down(scenario):
    """(10) by itself: s falls by what was charged, a by one, the option stays."""
    trace = run_day(start_day(scenario), P1)
    for taken in trace.steps:
        plan, state = taken.plan, frozen(taken.before)
        after = advance(taken.before, plan, taken.requests, scenario.interval_hours)
        assert frozen(taken.before) == state
        assert after.now == taken.before.now + 1
        owed = {c.vehicle: c.request.need_kwh - c.delivered_kwh for c in taken.before.contracts}
        owed |= {r.vehicle: r.need_kwh for r in taken.requests if r.vehicle in plan.admitted}
        asked = {c.vehicle: c.request for c in taken.before.contracts}
        asked |= {r.vehicle: r for r in taken.requests}
        charged = dict(zip(plan.vehicles, plan.power_kw[:, 0], strict=True))
        left = {v: owed[v] - charged[v] * scenario.interval_hours for v in plan.vehicles}
        open_now = {v for v, kwh in left.items() if kwh > 1e-6}
        assert {c.vehicle for c in after.contracts} == open_now
        for contract, tail in zip(after.contracts, after.tail_kw, strict=True):
            row = plan.vehicles.index(contract.vehicle)
            assert contract.owed_kwh == pytest.approx(left[contract.vehicle], abs=1e-9)
            assert contract.request == asked[contract.vehicle]
            assert (tail == plan.power_kw[row, 1:]).all()


def test_a_contract_past_its_deadline_leaves_as_it_stands():
    scenario = make_scenario(vehicles=[vehicle("v", need_kwh=8.0)])
    asked = prepare(scenario).requests[0][0]
    state = State(0, (Contract(asked, delivered_kwh=2.0),), np.zeros((1, 4)))
    plan = run_day(start_day(scenario), P1).steps[0].plan
    late = type(plan)(now=0, vehicles=("v",), power_kw=np.array([[3.0, 0.0, 0.0, 0.0]]))
    assert asked.deadline_interval == 1
    assert advance(state, late, (), 1.0).contracts == ()
