"""The arrival generator: right on average, reproducible, and one stream for each interval."""

from collections import Counter
from datetime import datetime, timedelta

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from evdash.domain.arrivals import Arrival
from evdash.domain.scenario import Scenario
from evdash.files.overrides import edit_scenario
from evdash.horizon.arrivals import arrivals_of, draw_arrivals, minute_rates
from tests.builders import generator, make_scenario

SHARE = [float(1 + hour % 5) for hour in range(24)]
RARELY = 1e-4
"""A right generator fails a test with a chance below this; the seeds are fixed besides."""


def drawn_day(minutes: int = 60, hours: int = 24, **changes) -> Scenario:
    fields = {key: changes.pop(key) for key in ("start", "arrivals_until") if key in changes}
    return make_scenario(
        price=[0.1] * (hours * 60 // minutes),
        interval_minutes=minutes,
        arrivals=generator(hourly_share=SHARE, **changes),
        **fields,
    )


def days(count: int, **changes) -> list[tuple[Arrival, ...]]:
    scenario = drawn_day(**changes)
    return [draw_arrivals(scenario, scenario.arrivals, seed) for seed in range(count)]


@pytest.mark.parametrize("minutes", [60, 15, 5])
def test_each_clock_hour_gets_its_share(minutes):
    drawn = days(30, minutes=minutes, vehicles_per_day=180.0)
    hours = Counter(a.arrival.hour for day in drawn for a in day)
    expected = 30 * 180 * np.array(SHARE) / sum(SHARE)
    counts = np.array([hours[hour] for hour in range(24)])
    chi_square = float(((counts - expected) ** 2 / expected).sum())
    assert stats.chi2.sf(chi_square, df=24) > RARELY


def test_the_number_of_a_day_is_poisson():
    counts = np.array([len(day) for day in days(200, vehicles_per_day=30.0)])
    # mean 30 and variance 30; the dispersion statistic is chi-square with n - 1 degrees
    assert abs(counts.mean() - 30) < 4 * np.sqrt(30 / 200)
    dispersion = counts.var(ddof=1) * 199 / 30
    assert RARELY < stats.chi2.sf(dispersion, df=199) < 1 - RARELY


def test_hours_do_not_move_together():
    table = np.zeros((150, 24))
    for row, day in zip(table, days(150, vehicles_per_day=60.0), strict=True):
        np.add.at(row, [a.arrival.hour for a in day], 1)
    neighbours = [np.corrcoef(table[:, h], table[:, h + 1])[0, 1] for h in range(23)]
    assert np.abs(neighbours).max() < 4 / np.sqrt(150)


def test_minutes_models_options_and_states_of_charge_follow_their_distributions():
    drawn = [a for day in days(60, vehicles_per_day=200.0) for a in day]
    minutes = np.bincount([a.arrival.minute for a in drawn], minlength=60)
    assert stats.chisquare(minutes).pvalue > RARELY
    small = sum(a.battery_kwh == 30.0 for a in drawn)
    assert stats.binomtest(small, len(drawn), 2 / 3).pvalue > RARELY
    first = sum(a.option == "C1" for a in drawn)
    assert stats.binomtest(first, len(drawn), 0.5).pvalue > RARELY
    soc_out = np.array([a.soc_out for a in drawn])
    assert stats.kstest(soc_out, stats.uniform(0.8, 0.2).cdf).statistic < 0.03
    # below 0.8 nothing was redrawn, so that there the beta distribution shows itself
    beta = stats.beta(2.3, 1.7)
    soc_in = np.array([a.soc_in for a in drawn])
    for level in (0.2, 0.4, 0.6):
        expected = np.mean(beta.cdf(level) / beta.cdf(soc_out))
        assert abs((soc_in < level).mean() - expected) < 0.02


def test_the_same_seed_gives_the_same_day_and_another_one_another():
    assert arrivals_of(drawn_day(seed=7)) == arrivals_of(drawn_day(seed=7))
    assert arrivals_of(drawn_day(seed=7)) != arrivals_of(drawn_day(seed=8))


def test_vehicles_are_named_in_order_of_time():
    drawn = arrivals_of(drawn_day(minutes=15))
    assert [a.arrival for a in drawn] == sorted(a.arrival for a in drawn)
    assert [a.vehicle for a in drawn] == [f"PEV-{n:03d}" for n in range(1, len(drawn) + 1)]


@pytest.mark.parametrize("minutes", [5, 15, 60])
def test_changing_a_later_hour_leaves_the_earlier_vehicles_as_they_were(minutes):
    later = [*SHARE]
    later[20], later[22] = later[20] + 3, later[22] - 3  # the sum stays, so the rates before do
    before = arrivals_of(drawn_day(minutes))
    after = arrivals_of(edit_scenario(drawn_day(minutes), {"arrivals.hourly_share": later}))
    eight = datetime(2024, 5, 6, 20)

    def until_eight(drawn):
        return [a for a in drawn if a.arrival < eight]

    assert until_eight(before) == until_eight(after)
    assert before != after


def test_a_longer_horizon_leaves_the_vehicles_within_the_shorter_as_they_were():
    short, long_ = arrivals_of(drawn_day(hours=12)), arrivals_of(drawn_day(hours=24))
    assert long_[: len(short)] == short


@given(
    minutes=st.sampled_from([5, 6, 10, 12, 15, 20, 30, 60]),
    offset=st.integers(0, 24 * 60 - 1),
    until=st.integers(0, 100),
    low=st.floats(0.01, 1.0),
    seed=st.integers(0, 2**63 - 1),
)
def test_whatever_is_drawn_is_a_valid_arrival(minutes, offset, until, low, seed):
    start = datetime(2024, 5, 6) + timedelta(minutes=offset)
    intervals = 6 * 60 // minutes
    scenario = drawn_day(
        minutes,
        hours=6,
        start=start,
        arrivals_until=min(until, intervals),
        vehicles_per_day=150.0,
        soc_out=[low, min(1.0, low + 0.2)],
        seed=seed,
    )
    end = scenario.time_of(scenario.arrivals_end)
    for a in arrivals_of(scenario):
        assert start <= a.arrival < end
        assert a.arrival.second == a.arrival.microsecond == 0
        assert 0 <= a.soc_in < a.soc_out <= 1
        assert round(low, 3) <= a.soc_out <= min(1.0, low + 0.2) + 5e-4


def test_an_interval_across_the_hour_draws_from_both_hours():
    scenario = drawn_day(60, hours=6, start=datetime(2024, 5, 6, 0, 40), vehicles_per_day=24.0)
    rates = minute_rates(scenario, scenario.arrivals, 0)
    per_hour = 24 * np.array(SHARE) / sum(SHARE)
    assert rates[:20] == pytest.approx(per_hour[0] / 60)
    assert rates[20:] == pytest.approx(per_hour[1] / 60)


def test_nobody_arrives_where_nobody_is_expected():
    assert arrivals_of(drawn_day(vehicles_per_day=0.0)) == ()
    assert arrivals_of(drawn_day(arrivals_until=0)) == ()
