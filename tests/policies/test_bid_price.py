"""bid-price: it knows statistics only, keeps every promise, and says what it kept room for."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from benchmarks.race_days import FORECASTS
from evdash.checker.feeder import FeederCheck
from evdash.errors import InputError
from evdash.files.bundled import DEFAULT
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.advance import snapshot_of
from evdash.horizon.day import run_day, start_day
from evdash.horizon.inputs import prepare
from evdash.metrics.records import executed_station_kw
from evdash.metrics.service import totals
from evdash.policies import expectation
from evdash.policies.bid_price import bid_price, expected_losses, informed
from evdash.policies.expectation import best_admissions, expectation_of, sampled_days
from evdash.policies.futures import AHEAD_HOURS, MOST, sample_futures
from evdash.scheduling.p1 import p1_policy
from tests.builders import make_scenario, vehicle
from tests.policies.test_expectation import crowds


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


def test_the_same_day_again_is_the_same_day_however_many_cores_there_are(bundled, day, monkeypatch):
    monkeypatch.setattr(expectation, "ThreadPoolExecutor", partial(ThreadPoolExecutor, 1))
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
        str(refusal.reason)
        for step in day.steps
        for refusal in step.plan.refused
        if refusal.reason.kind == "kept for others"
    ]
    assert kept
    assert all("/kWh" in reason and ":00" in reason for reason in kept)
    prices = [step.plan.capacity_price_per_kwh for step in day.steps[:17]]
    assert max(price.max() for price in prices if price is not None) > 0


def test_where_nobody_is_expected_it_does_as_the_papers_rule(bundled):
    calm = bundled.arrivals.model_copy(update={"vehicles_per_day": 1e-6})
    day = run_day(start_day(bundled), informed(bundled, calm, samples=2))
    as_p1 = run_day(start_day(bundled), p1_policy())
    assert totals(day).profit >= 0.99 * totals(as_p1).profit


def test_it_departs_from_p1_only_where_the_futures_agree(bundled, day, monkeypatch):
    """Asked to be infinitely sure, it is P1 at every step."""
    assert any(step.plan.admitted != p1_policy()(_snapshot(step)).admitted for step in day.steps)
    monkeypatch.setattr("evdash.policies.bid_price.CAUTION", np.inf)
    cautious = run_day(start_day(bundled), bid_price(bundled, samples=2))
    for step in cautious.steps:
        assert step.plan.admitted == p1_policy()(_snapshot(step)).admitted


def _snapshot(step):
    return snapshot_of(step.inputs, step.before)


def test_a_day_from_file_needs_a_forecast():
    scenario = make_scenario(vehicles=[vehicle("a")])
    with pytest.raises(InputError, match=r"arrivals\.forecast"):
        bid_price(scenario)


def snapshot_after(bundled, futures, asked):
    """In the interval in which the last of these counts ask; who they are does not matter."""
    trace, (*before, here) = start_day(bundled), asked
    return replace(
        snapshot_of(trace.inputs, trace.state),
        now=len(before),
        asked=tuple(int(count) for count in before),
        requests=(None,) * int(here),
    )


def test_what_the_day_has_shown_corrects_how_many_are_expected(bundled):
    futures = sample_futures(bundled, bundled.arrivals, samples=2, seed=1)
    course = futures.expected[:20]
    as_forecast = snapshot_after(bundled, futures, np.round(course))
    assert futures.correction(as_forecast) == pytest.approx(1.0, abs=0.1)
    nobody = snapshot_after(bundled, futures, 0 * course)
    assert futures.correction(nobody) < 0.5
    crowd = snapshot_after(bundled, futures, 10 * course)
    assert futures.correction(crowd) == MOST
    known = [sum(map(len, futures.coming(s))) for s in (nobody, as_forecast, crowd)]
    assert known[0] < known[1] < known[2]


def test_a_course_that_denies_the_forecast_is_not_trusted(bundled):
    """Two hours late, or all at once: nobody is expected any more, so it falls back to P1."""
    futures = sample_futures(bundled, bundled.arrivals, samples=4, seed=1)
    course = futures.expected[:20]
    as_forecast = snapshot_after(bundled, futures, np.round(course))
    late = snapshot_after(bundled, futures, np.round(np.roll(course, 2)))
    at_once = snapshot_after(bundled, futures, (*np.zeros(19), course.sum()))
    assert futures.trust(as_forecast) == 1.0
    assert futures.trust(late) < 0.2
    assert futures.trust(at_once) < 1e-6
    assert not any(futures.coming(at_once))
    assert any(futures.coming(as_forecast))


def test_a_forecast_that_is_right_is_seldom_doubted(bundled):
    """The test's level holds: of right forecasts about one in twenty is doubted at a time."""
    futures = sample_futures(bundled, bundled.arrivals, samples=1, seed=1)
    stream = np.random.default_rng(7)
    trusted = [
        futures.trust(snapshot_after(bundled, futures, stream.poisson(futures.expected[:20])))
        for _ in range(400)
    ]
    assert np.mean(np.array(trusted) < 1.0) < 0.09


def test_it_looks_no_further_ahead_than_bears_on_now(bundled):
    futures = sample_futures(bundled, bundled.arrivals, samples=4, seed=1)
    snapshot = snapshot_after(bundled, futures, (0,))
    arrivals = [r.arrival_interval for day in futures.coming(snapshot) for r in day]
    assert 0 < min(arrivals) <= max(arrivals) <= AHEAD_HOURS


@pytest.mark.long
@pytest.mark.parametrize("wrong", FORECASTS)
def test_no_wrong_forecast_makes_it_earn_less_than_p1_in_the_mean(bundled, wrong):
    gained = []
    for seed in range(1, 7):
        scenario = edit_scenario(bundled, {"arrivals.seed": seed})
        misled = informed(scenario, FORECASTS[wrong](scenario.arrivals))
        base = totals(run_day(start_day(scenario), p1_policy())).profit
        gained.append(totals(run_day(start_day(scenario), misled)).profit - base)
    assert np.mean(gained) > 0


def test_futures_follow_the_statistics(bundled):
    futures = sample_futures(bundled, bundled.arrivals, samples=30, seed=5)
    drawn = np.mean([sum(len(group) for group in day) for day in futures.days]) / MOST
    asked = sum(1 for group in prepare(bundled).requests for r in group if not r.refusal)
    assert 0.7 * asked < drawn < 1.3 * asked


def test_hardly_anybody_is_refused_without_a_reason_of_its_own(bundled):
    """A slope told next to nothing of what one more vehicle costs: it said so of every third."""
    scarce = edit_scenario(bundled, {"station.chargers": 6})
    day = run_day(start_day(scarce), bid_price(scarce, samples=4))
    reasons = [refusal.reason for step in day.steps for refusal in step.plan.refused]
    kept = [reason for reason in reasons if reason.kind == "kept for others"]
    assert len(kept) > 10
    assert all(reason.loss > 0 for reason in kept)
    assert sum(reason.kind == "left out" for reason in reasons) <= len(kept) / 5


@settings(max_examples=10, suppress_health_check=[HealthCheck.too_slow])
@given(crowds())
def test_the_loss_told_is_that_of_the_futures_with_it_and_without(crowd):
    snapshot, futures = crowd
    asking = tuple(request for request in snapshot.requests if not request.refusal)
    days = sampled_days(snapshot, futures, len(asking))
    best = best_admissions(days, len(asking))
    admitted = tuple(r.vehicle for r, yes in zip(asking, best.admitted, strict=True) if yes)
    losses = expected_losses(days, asking, best, admitted)
    assert losses.keys() == {r.vehicle for r in asking} - set(admitted)
    for n, request in enumerate(asking):
        if request.vehicle in losses:
            u = best.admitted.copy()
            u[n] = 1.0
            fresh = sampled_days(snapshot, futures, len(asking))
            before, found = best_admissions(fresh, len(asking)), expectation_of(fresh, u)
            loss = losses[request.vehicle]
            if found is None:
                assert np.isnan(loss)
            else:
                assert found.cost - before.cost == pytest.approx(loss)
                assert loss > -0.0101  # no other set is a cent better
