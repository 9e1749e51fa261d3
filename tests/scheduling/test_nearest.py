"""The schedule nearest to a wish for the first slot, against what can be said by hand."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from evdash.checker.feeder import FeederCheck
from evdash.horizon.advance import initial_state, snapshot_of
from evdash.horizon.inputs import prepare
from evdash.scheduling.effort import Effort
from evdash.scheduling.nearest import nearest_schedule
from evdash.scheduling.problem import problem_of
from tests.builders import make_scenario, vehicle


def problem(**changes):
    scenario = make_scenario(**changes)
    return problem_of(snapshot_of(prepare(scenario), initial_state(scenario.intervals)))


def test_the_wish_is_kept_where_it_can_be_however_dear():
    asked = problem(price=(0.9, 0.1, 0.1, 0.1), vehicles=[vehicle("a", need_kwh=12.0, option="C2")])
    wished = nearest_schedule(asked, np.array([7.0]), asked.tariff, Effort())
    assert wished[0, 0] == pytest.approx(7.0)
    assert wished.sum() == pytest.approx(12.0)
    nothing = nearest_schedule(asked, np.array([0.0]), asked.tariff, Effort())
    assert nothing[0, 0] == 0.0


def test_below_the_lowest_power_it_is_off_or_at_it():
    asked = problem(vehicles=[vehicle("a", need_kwh=12.0, option="C2")])
    for wish_kw, kept_kw in ((0.4, 0.0), (1.7, 2.0)):
        found = nearest_schedule(asked, np.array([wish_kw]), asked.tariff, Effort())
        assert found[0, 0] == pytest.approx(kept_kw)


def test_none_where_not_all_can_be_served():
    asked = problem(
        station={"chargers": 1},
        price=(0.1,),
        vehicles=[vehicle(f"{n}", need_kwh=8.0) for n in range(2)],
    )
    assert nearest_schedule(asked, np.zeros(2), asked.tariff, Effort()) is None


def test_of_nobody_there_is_an_empty_schedule():
    assert nearest_schedule(problem(), np.zeros(0), np.zeros(4), Effort()).shape == (0, 4)


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    wishes=st.lists(st.integers(0, 10), min_size=3, max_size=3),
    chargers=st.integers(1, 3),
    rating=st.integers(8, 30),
)
def test_whatever_is_wished_limits_and_promises_are_kept(wishes, chargers, rating):
    changes = {
        "station": {"chargers": chargers},
        "lines": (
            {"from_node": "s", "to_node": "a", "r_ohm": 0.1, "x_ohm": 0.1, "rating_kva": rating},
        ),
        "vehicles": [
            vehicle(f"{n}", need_kwh=4.0 + 3 * n, option="C2", battery_kwh=60.0) for n in range(3)
        ],
    }
    asked = problem(**changes)
    found = nearest_schedule(asked, np.array(wishes, dtype=float), asked.tariff, Effort())
    if found is None:
        return
    assert found.sum(axis=1) == pytest.approx(asked.owed_kwh, abs=1e-6)
    assert ((found > 1e-7).sum(axis=0) <= chargers).all()
    assert not FeederCheck(make_scenario(**changes)).breaches(found.sum(axis=0) - 1e-5)
