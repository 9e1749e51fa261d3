"""Switching off without a solver: in a stated order, and never beyond a limit."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evdash.domain.elements import Element
from evdash.domain.limits import LimitRows
from evdash.domain.tariff import Tariff
from evdash.scheduling.problem import Problem
from evdash.scheduling.shed import shed
from tests.scheduling.problems import HAIR, random_problem


def station(
    tail_kw: list[list[float]],
    headroom_kw: list[float],
    chargers: int = 9,
    left: list[int] | None = None,
) -> Problem:
    """Contracts in order of arrival, 2 to 10 kW each, hourly slots."""
    tail = np.array(tail_kw)
    n, slots = tail.shape
    return Problem(
        vehicles=tuple(f"v{v}" for v in range(n)),
        n_contracts=n,
        owed_kwh=tail.sum(axis=1),
        intervals_left=np.array(left or [slots] * n),
        low_kw=np.full(n, 2.0),
        high_kw=np.full(n, 10.0),
        revenue=np.zeros(n),
        tariff=Tariff(np.full(slots, 0.1), 1.0),
        chargers=chargers,
        rows=LimitRows(
            (Element("line", "s", "a"),), np.ones((1, 1)), np.reshape(headroom_kw, (-1, 1))
        ),
        tail_kw=tail,
    )


def test_nothing_is_switched_off_where_there_is_room():
    problem = station([[5, 5], [5, 5]], [10, 10])
    assert (shed(problem) == problem.tail_kw).all()


def test_who_came_last_is_switched_off_first_and_the_last_to_go_keeps_what_is_left():
    """18 kW are plugged in and 9 can be had: v2 goes, v1 keeps the 3 kW beside v0's 6."""
    kept = shed(station([[6, 0], [6, 0], [6, 0]], [9, 0]))
    assert kept[:, 0] == pytest.approx([6.0, 3.0, 0.0])


def test_what_is_left_is_no_use_to_a_charger_that_cannot_run_so_low():
    kept = shed(station([[6, 0], [6, 0]], [7, 0]))
    assert kept[:, 0] == pytest.approx([6.0, 0.0])


@pytest.mark.parametrize("chargers", [0, 1, 2])
def test_of_too_few_chargers_the_first_to_come_keep_theirs(chargers):
    kept = shed(station([[5], [5], [5]], [99], chargers))
    assert (kept[:, 0] > 0).tolist() == [n < chargers for n in range(3)]


def test_what_was_lost_is_caught_up_with_whose_return_is_nearest_first():
    """One charger in the first hour, room for 10 kW later: v1 leaves before v2 and is served."""
    problem = station([[5, 0, 0], [5, 0, 0], [5, 0, 0]], [5, 5, 5], chargers=1, left=[3, 2, 3])
    kept = shed(problem)
    assert kept.sum(axis=1) == pytest.approx([5, 5, 5], abs=1e-6)
    assert kept[1, 1] == pytest.approx(5.0)
    assert kept[2, 2] == pytest.approx(5.0)


def test_without_any_headroom_everybody_is_switched_off():
    assert shed(station([[5, 5], [5, 5]], [0, 0])).sum() == 0


@given(st.integers(0, 10_000), st.floats(0, 1.2), st.integers(0, 8))
def test_no_limit_is_ever_exceeded_and_nobody_gets_more_than_is_owed(seed, share, chargers):
    problem = random_problem(np.random.default_rng(seed))
    rows = replace(problem.rows, limit_kw=np.maximum(0.0, share * problem.rows.limit_kw))
    problem = replace(problem, rows=rows, chargers=min(chargers, problem.chargers))
    power = shed(problem)
    running = power > 0
    lowest = np.broadcast_to(problem.low_kw[:, None], power.shape)
    assert not running[~problem.window].any()
    assert (running.sum(axis=0) <= problem.chargers).all()
    assert (power.sum(axis=0) <= rows.headroom_kw() + HAIR).all()
    assert (power[running] >= lowest[running] - HAIR).all()
    assert (power <= problem.high_kw[:, None] + HAIR).all()
    assert (power.sum(axis=1) * problem.interval_hours <= problem.owed_kwh + HAIR).all()
