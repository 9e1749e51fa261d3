"""From arrival to request: when it takes part, how much it needs, by when, or why not."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evdash.domain.refusal import RefusalReason
from evdash.domain.scenario import Scenario
from evdash.domain.vehicles import Request
from evdash.horizon.day import run_day, start_day
from evdash.horizon.requests import promised_intervals
from evdash.scheduling.p1 import p1_policy
from tests.builders import make_scenario, vehicle

PRICES_OF_A_DAY = [0.1] * 24


def requests_of(scenario: Scenario) -> dict[str, Request]:
    return {r.vehicle: r for group in start_day(scenario).inputs.requests for r in group}


def request(scenario_vehicle, **scenario) -> Request:
    return next(iter(requests_of(make_scenario(vehicles=[scenario_vehicle], **scenario)).values()))


@pytest.mark.parametrize(
    ("hour", "interval"),
    [(0, 0), (1 / 60, 1), (8 + 20 / 60, 9), (8 + 59 / 60, 9), (9, 9), (9 + 1 / 60, 10)],
)
def test_who_comes_within_an_interval_takes_part_from_the_next(hour, interval):
    asked = request(vehicle("v", hour=hour), price=PRICES_OF_A_DAY)
    assert asked.arrival_interval == interval


def test_in_quarter_hours_twenty_past_is_half_past():
    asked = request(vehicle("v", hour=8 + 20 / 60), price=[0.1] * 96, interval_minutes=15)
    assert asked.arrival_interval == 8 * 4 + 2


def test_who_comes_after_the_last_interval_has_begun_is_refused_for_that():
    scenario = make_scenario(price=PRICES_OF_A_DAY, vehicles=[vehicle("v", hour=23 + 20 / 60)])
    trace = run_day(start_day(scenario), p1_policy())
    assert [r.vehicle for r in trace.inputs.requests[24]] == ["v"]
    asked = trace.inputs.requests[24][0]
    assert asked.arrival_interval == 24
    assert asked.refusal == RefusalReason("after the end")
    assert all(not step.requests for step in trace.steps)


def test_the_need_is_drawn_from_the_grid():
    asked = request(
        vehicle("v", battery_kwh=40.0, soc_in=0.2, soc_out=0.8), station={"efficiency": 0.8}
    )
    assert asked.need_kwh == pytest.approx(0.6 * 40 / 0.8)
    assert asked.revenue == pytest.approx(30 * 0.4)


def test_five_intervals_are_five_where_floating_point_says_six():
    assert (0.8 - 0.2) * 40 / 4.8 > 5
    asked = request(
        vehicle("v", battery_kwh=40.0, soc_in=0.2, soc_out=0.8, option="slow"),
        price=[0.1] * 8,
        options=[{"name": "slow", "price_per_kwh": 0.3, "average_kw": 4.8}],
    )
    assert asked.deadline_interval == 5


@given(
    st.integers(1, 200), st.sampled_from([3.3, 4.8, 7.2, 9.6]), st.sampled_from([1, 0.25, 1 / 3])
)
def test_a_whole_number_of_intervals_is_promised_as_that_number(count, average_kw, hours):
    """However the kWh were rounded on the way: 0.1-steps, thirds, sums of parts."""
    for need in (count * average_kw * hours, sum([average_kw * hours] * count)):
        assert promised_intervals(need, average_kw, 20.0, hours) == count
    assert (
        promised_intervals(count * average_kw * hours + 1e-3, average_kw, 20.0, hours) == count + 1
    )


def test_a_slow_vehicle_gets_the_time_its_own_power_needs():
    asked = request(vehicle("v", need_kwh=12.0, max_kw=4.0), price=[0.1] * 8)
    assert asked.max_kw == 4.0
    assert asked.deadline_interval == 3


def test_a_fast_vehicle_is_limited_by_the_station():
    assert request(vehicle("v", max_kw=22.0)).max_kw == 10.0


def test_the_deadline_is_clipped_at_the_horizon():
    asked = request(vehicle("v", hour=2, need_kwh=16.0, option="C2"))
    assert (asked.arrival_interval, asked.deadline_interval) == (2, 4)
    assert not asked.refusal


def test_too_late_to_be_served_before_the_horizon_ends():
    asked = request(vehicle("v", hour=2, need_kwh=25.0, option="C2"))
    assert str(asked.refusal) == (
        "there is too little time before the horizon's end: 25.0 kWh takes 3 intervals at 10 kW "
        "and only 2 are left"
    )


def test_next_to_no_energy_is_still_promised_an_interval():
    assert promised_intervals(1e-9, 8.0, 10.0, 1.0) == 1


@pytest.mark.parametrize(
    ("attainable", "need_kwh"),
    [
        *((True, kwh) for kwh in (5.0, 6.0, 7.0, 12.0, 14.0, 18.0, 24.0)),
        *((False, kwh) for kwh in (7.5, 11.9, 14.1, 17.9, 15.0)),
    ],
)
def test_what_lies_between_whole_intervals_is_unattainable(attainable, need_kwh):
    asked = request(
        vehicle("v", need_kwh=need_kwh),
        price=[0.1] * 9,
        station={"min_kw": 6.0, "max_kw": 7.0},
        options=[{"name": "C1", "price_per_kwh": 0.4, "average_kw": 3.0}],
    )
    assert (asked.refusal is None) is attainable
    assert attainable or asked.refusal.kind == "unattainable"
