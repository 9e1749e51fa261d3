"""Transformer ageing against values worked by hand from IEEE C57.91's formulas."""

import math

import numpy as np
import pytest

from evdash.metrics.ageing import (
    Thermal,
    ageing,
    ageing_factor,
    oil_time_constant,
    ultimate_rises,
)

LINEAR = Thermal(oil_exponent=1.0, winding_exponent=1.0)


def test_ageing_is_normal_at_110_degrees():
    assert float(ageing_factor(np.array(110.0))) == 1.0


@pytest.mark.parametrize(
    ("hot_spot_c", "factor"),
    # worked to 30 digits in decimal arithmetic
    [(80.0, 0.0358495), (98.0, 0.281738), (117.0, 2.019707), (120.0, 2.708925), (140.0, 17.19946)],
)
def test_ageing_factor_worked_by_hand(hot_spot_c, factor):
    assert float(ageing_factor(np.array(hot_spot_c))) == pytest.approx(factor, rel=2e-6)


def test_life_is_lost_twice_as_fast_about_seven_degrees_hotter():
    factors = ageing_factor(np.arange(90.0, 140.0))
    ratio = factors[7:] / factors[:-7]
    assert ((ratio > 1.8) & (ratio < 2.3)).all()
    assert (np.diff(factors) > 0).all()


def test_rated_load_around_the_clock_costs_an_hour_an_hour():
    day = ageing(np.full(24, 500.0), 500.0, 1.0)
    assert day.hot_spot_c == pytest.approx(np.full(24 * 60, 110.0), abs=1e-9)
    assert day.equivalent_factor == pytest.approx(1.0, abs=1e-9)
    assert day.life_lost_hours == pytest.approx(24.0)
    assert day.life_lost_percent == pytest.approx(100 * 24 / 180_000)


def test_without_load_the_oil_settles_at_what_the_core_warms_it():
    # (1/6)^0.8 of 55 K over 30 °C, and nothing in the winding
    day = ageing(np.zeros(24), 500.0, 1.0)
    assert day.highest_c == pytest.approx(30 + 55 * (1 / 6) ** 0.8)


def test_rises_at_half_load_worked_by_hand():
    oil, winding = ultimate_rises(np.array([0.5]), Thermal())
    assert oil[0] == pytest.approx(55 * 0.375**0.8)  # (0.25·5 + 1)/6 = 0.375
    assert winding[0] == pytest.approx(25 * 0.25**0.8)


def test_a_step_back_and_forth_follows_the_closed_form():
    """Two intervals of 2 h by turns, all exponents 1: a cycle known in closed form."""
    hours, low, high = 2.0, 0.2, 1.2
    day = ageing(np.array([100 * low, 100 * high]), 100.0, hours, LINEAR)
    rises = ultimate_rises(np.array([low, high]), LINEAR)
    end = 0.0
    for (down, up), constant in zip(rises, (3.0, 0.08), strict=True):
        fade = math.exp(-hours / constant)
        after_low = down + (up - down) * fade * (1 - fade) / (1 - fade**2)
        minute = math.exp(-(hours - 0.5 / 60) / constant)
        end += up + (after_low - up) * minute
    assert day.hot_spot_c[-1] == pytest.approx(30 + end, abs=1e-6)


def test_the_oil_is_slower_to_warm_than_rated_from_no_load():
    thermal = Thermal()
    # u = 1, i = 0.5: 3 h · 0.5/(1 − 0.5^1.25)
    assert oil_time_constant(55.0, 27.5, thermal) == pytest.approx(3 * 0.5 / (1 - 0.5**1.25))
    assert oil_time_constant(55.0, 27.5, LINEAR) == 3.0
    assert oil_time_constant(55.0, 55.0, thermal) == 3.0


def test_a_hotter_day_and_a_heavier_load_cost_more_and_finer_intervals_the_same():
    load = 400 + 150 * np.sin(np.arange(24) / 24 * 2 * np.pi)
    base = ageing(load, 500.0, 1.0)
    assert ageing(load, 500.0, 1.0, Thermal(ambient_c=37)).life_lost_hours > base.life_lost_hours
    assert ageing(1.1 * load, 500.0, 1.0).life_lost_hours > base.life_lost_hours
    quarters = ageing(np.repeat(load, 4), 500.0, 0.25, LINEAR)
    whole = ageing(load, 500.0, 1.0, LINEAR)
    assert quarters.life_lost_hours == pytest.approx(whole.life_lost_hours, rel=1e-9)
