"""bid-price: it knows statistics only, keeps every promise, and says what it kept room for."""

from dataclasses import replace

import numpy as np
import pytest

from evdash.checker.feeder import FeederCheck
from evdash.errors import InputError
from evdash.files.bundled import DEFAULT
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.advance import snapshot_of
from evdash.horizon.day import run_day, start_day
from evdash.horizon.inputs import prepare
from evdash.metrics.records import executed_station_kw
from evdash.metrics.totals import totals
from evdash.policies.bid_price import anticipating, bid_price
from evdash.policies.futures import MOST, sample_futures
from evdash.scheduling.p1 import p1_policy
from tests.builders import make_scenario, vehicle


@pytest.fixture(scope="module")
def bundled():
    return read_scenario(DEFAULT)


@pytest.fixture(scope="module")
def day(bundled):
    return run_day(start_day(bundled), bid_price(bundled, samples=4))


def test_it_keeps_every_promise_and_limit(bundled, day):
    assert totals(day).broken == 0
    breaches = FeederCheck(bundled).breaches(executed_station_kw(day))
    assert not [breach for breach in breaches if breach.by_station]
    assert {step.plan.report.status for step in day.steps} == {"feasible"}


def test_the_same_day_again_is_the_same_day(bundled, day):
    again = run_day(start_day(bundled), bid_price(bundled, samples=4))
    for one, other in zip(day.steps, again.steps, strict=True):
        assert one.plan.admitted == other.plan.admitted
        assert np.array_equal(one.plan.power_kw, other.plan.power_kw)


def test_nothing_it_decides_hangs_on_who_really_comes_later(bundled, day):
    """Others come from 12:00 on: what it decided before stays as it was."""
    noon = 12
    other = edit_scenario(bundled, {"arrivals.vehicles_per_day": 30.0})
    changed, policy = start_day(bundled), bid_price(bundled, samples=4)
    late = prepare(other)
    mixed = changed.inputs.requests[: noon + 1] + late.requests[noon + 1 :]
    trace = run_day(_with_requests(changed, mixed), policy)
    for one, same in zip(day.steps[: noon + 1], trace.steps, strict=False):
        assert one.plan.admitted == same.plan.admitted
        assert np.array_equal(one.plan.power_kw, same.plan.power_kw)


def _with_requests(trace, requests):
    return replace(trace, inputs=replace(trace.inputs, requests=requests))


def test_a_refusal_says_what_the_room_was_kept_for(day):
    kept = [
        refusal.reason
        for step in day.steps
        for refusal in step.plan.refused
        if refusal.reason.startswith("kept for others")
    ]
    assert kept
    assert all("$/kWh" in reason and ":00" in reason for reason in kept)
    prices = [step.plan.capacity_price_per_kwh for step in day.steps[:17]]
    assert max(price.max() for price in prices if price is not None) > 0


def test_where_nobody_is_expected_it_does_as_the_papers_rule(bundled):
    calm = bundled.arrivals.model_copy(update={"vehicles_per_day": 1e-6})
    policy = anticipating(bundled, sample_futures(bundled, calm, samples=2, seed=1))
    expecting_nobody = totals(run_day(start_day(bundled), policy)).profit
    assert expecting_nobody >= 0.99 * totals(run_day(start_day(bundled), p1_policy())).profit


def test_a_day_from_file_needs_a_forecast():
    scenario = make_scenario(vehicles=[vehicle("a")])
    with pytest.raises(InputError, match=r"arrivals\.forecast"):
        bid_price(scenario)


def test_what_the_day_has_shown_corrects_what_is_expected(bundled):
    futures = sample_futures(bundled, bundled.arrivals, samples=2, seed=1)
    trace = start_day(bundled)
    snapshot = snapshot_of(trace.inputs, trace.state)
    expected = futures.expected[:13].sum()
    as_forecast = replace(snapshot, now=12, asked=(round(expected),), requests=())
    assert futures.correction(as_forecast) == pytest.approx(1.0, abs=0.05)
    nobody = replace(as_forecast, asked=(0,))
    assert futures.correction(nobody) < 0.7
    crowd = replace(as_forecast, asked=(round(10 * expected),))
    assert futures.correction(crowd) == MOST
    known = {
        n: sum(map(len, futures.coming(s)))
        for n, s in (("few", nobody), ("forecast", as_forecast), ("many", crowd))
    }
    assert known["few"] < known["forecast"] < known["many"]


def test_futures_follow_the_statistics(bundled):
    futures = sample_futures(bundled, bundled.arrivals, samples=30, seed=5)
    drawn = np.mean([sum(len(group) for group in day) for day in futures.days]) / MOST
    asked = sum(1 for group in prepare(bundled).requests for r in group if not r.refusal)
    assert 0.7 * asked < drawn < 1.3 * asked
