"""Rules of precedence keep the limits and every contract; no rule shows the damage."""

import pytest
from hypothesis import HealthCheck, given, settings

from evdash.checker.feeder import FeederCheck
from evdash.horizon.day import run_day, start_day
from evdash.metrics.records import executed_station_kw
from evdash.metrics.service import totals
from evdash.policies.registry import RULES
from tests.builders import make_scenario, scenarios, vehicle

WITHIN_LIMITS = ("fcfs", "edf", "llf")


def day(scenario, name):
    rule, trace = RULES[name], start_day(scenario)
    return run_day(trace, rule.make(trace.inputs), decide=rule.decide)


@pytest.mark.parametrize("name", WITHIN_LIMITS)
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(scenario=scenarios(max_vehicles=8))
def test_a_rule_breaks_neither_limit_nor_promise_nor_needs_the_fallback(name, scenario):
    trace = day(scenario, name)
    assert totals(trace).broken == 0
    assert {step.plan.report.status for step in trace.steps} == {"feasible"}
    breaches = FeederCheck(scenario).breaches(executed_station_kw(trace))
    assert not [breach for breach in breaches if breach.by_station]
    for step in trace.steps:
        assert (step.plan.charging <= scenario.station.chargers).all()


def two_for_one_charger(**second):
    return make_scenario(
        station={"chargers": 1, "max_kw": 10.0},
        vehicles=[
            vehicle("slow", need_kwh=20.0, option="C2"),
            vehicle("quick", need_kwh=10.0, option="C1", **second),
        ],
    )


def test_first_come_turns_away_whom_earliest_deadline_serves():
    scenario = two_for_one_charger(max_kw=10.0)
    assert next(step.plan.admitted for step in day(scenario, "fcfs").steps) == ("slow",)
    assert day(scenario, "edf").steps[0].plan.admitted == ("slow", "quick")


def test_without_coordination_everyone_charges_at_once_and_limits_break():
    scenario = make_scenario(
        lines=({"from_node": "s", "to_node": "a", "r_ohm": 0.1, "x_ohm": 0.1, "rating_kva": 12.0},),
        vehicles=[vehicle(f"{n}", need_kwh=10.0) for n in range(5)],
    )
    trace = day(scenario, "uncoordinated")
    first = trace.steps[0].plan
    assert first.admitted == tuple("01234")
    assert first.power_kw[:, 0] == pytest.approx([10.0] * 5)
    breaches = FeederCheck(scenario).breaches(executed_station_kw(trace))
    assert [str(b.element) for b in breaches if b.by_station] == ["line:s-a"]
