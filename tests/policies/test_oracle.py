"""The oracle: exact, and above every policy that keeps the limits."""

import pulp
import pytest
from hypothesis import HealthCheck, given, settings

from evdash.horizon.day import run_day, start_day
from evdash.horizon.inputs import prepare
from evdash.metrics.service import totals
from evdash.policies.oracle import foresee, oracle
from evdash.policies.registry import RULES
from tests.builders import make_scenario, scenarios, vehicle

CENT = 0.01


def best_profit_by_hand(inputs):
    """The best day by a formulation of its own, straight from the scenario and its requests."""
    scenario, headroom = inputs.scenario, inputs.rows.headroom_kw()
    hours, price = scenario.interval_hours, scenario.price_per_kwh
    requests = [r for group in inputs.requests[:-1] for r in group if not r.refusal]
    if not requests:
        return 0.0
    model, worth, load, running = pulp.LpProblem("day", pulp.LpMaximize), [], {}, {}
    for n, request in enumerate(requests):
        admitted = model.add_variable(f"u{n}", cat=pulp.LpBinary)
        energy = []
        for t in range(request.arrival_interval, request.deadline_interval):
            power = model.add_variable(f"p{n}_{t}", lowBound=0)
            on = model.add_variable(f"d{n}_{t}", cat=pulp.LpBinary)
            model += power <= request.max_kw * on
            model += power >= min(request.min_kw, request.need_kwh / hours) * on
            model += on <= admitted
            energy.append(power * hours)
            worth.append(-price[t] * hours * power)
            load.setdefault(t, []).append(power)
            running.setdefault(t, []).append(on)
        model += pulp.lpSum(energy) == request.need_kwh * admitted
        worth.append(request.revenue * admitted)
    for t, powers in load.items():
        if headroom[t] < float("inf"):
            model += pulp.lpSum(powers) <= headroom[t]
        model += pulp.lpSum(running[t]) <= scenario.station.chargers
    model += pulp.lpSum(worth)
    model.solve(pulp.PULP_CBC_CMD(msg=False, gapAbs=1e-4))
    assert model.sol_status == pulp.LpSolutionOptimal
    return pulp.value(model.objective)


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(scenario=scenarios(max_vehicles=6))
def test_the_best_day_is_the_best_and_is_carried_out(scenario):
    inputs = prepare(scenario)
    foresight, by_hand = foresee(inputs), best_profit_by_hand(inputs)
    assert foresight.most_profit >= by_hand - 1e-6
    trace = start_day(scenario)
    day = run_day(trace, oracle(trace.inputs))
    assert totals(day).profit == pytest.approx(by_hand, abs=2 * CENT)
    assert totals(day).broken == 0
    assert {step.plan.report.status for step in day.steps} == {"feasible"}


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(scenario=scenarios(max_vehicles=6))
def test_no_policy_within_the_limits_earns_more(scenario):
    trace = start_day(scenario)
    most = foresee(trace.inputs).most_profit
    for name in ("p1", "fcfs", "edf", "llf"):
        earned = totals(run_day(trace, RULES[name].make(trace.inputs))).profit
        assert earned <= most + CENT


def test_it_leaves_room_for_a_better_payer_who_comes_later():
    """One charger: the paper's rule takes the first who asks, the oracle waits for the second."""
    scenario = make_scenario(
        station={"chargers": 1, "max_kw": 10.0},
        price=(0.1, 0.1, 0.1, 0.1),
        vehicles=[
            vehicle("first", hour=0, need_kwh=40.0, option="C2", battery_kwh=80.0),
            vehicle("second", hour=1, need_kwh=30.0, battery_kwh=60.0, option="C1"),
        ],
        options=(
            {"name": "C1", "price_per_kwh": 0.9, "average_kw": 10.0},
            {"name": "C2", "price_per_kwh": 0.2, "average_kw": 10.0},
        ),
    )
    trace = start_day(scenario)
    served = [step.plan.admitted for step in run_day(trace, oracle(trace.inputs)).steps]
    assert served[:2] == [(), ("second",)]
    greedy = [step.plan.admitted for step in run_day(trace, RULES["p1"].make(trace.inputs)).steps]
    assert greedy[0] == ("first",)
