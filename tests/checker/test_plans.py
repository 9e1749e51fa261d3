"""The checker catches a plan that is wrong by a little in any one respect."""

import dataclasses

import numpy as np
import pytest

from evdash.checker.feeder import FeederCheck
from evdash.checker.plans import plan_problems
from evdash.domain.plan import Plan
from evdash.domain.vehicles import Contract
from evdash.horizon.requests import request_for
from tests.builders import line, make_scenario, node, vehicle

LITTLE = 1e-4
#             slot       0     1    2    3
SOUND = np.array([[6.0, 10.0, 2.0, 0.0], [0.0, 5.0, 5.0, 0.0]])


@pytest.fixture(scope="module")
def scenario():
    """Two chargers, 15 kW of room, 2 to 10 kW a charger."""
    return make_scenario(
        nodes=[node("s"), node("a", load_kw=10, load_kvar=0)],
        lines=[line("s", "a", rating=25)],
        vehicles=[vehicle("x", 0, 18), vehicle("y", 1, 10, option="C2", max_kw=5)],
        station={"chargers": 2},
    )


@pytest.fixture(scope="module")
def contracts(scenario):
    return tuple(Contract(request_for(scenario, a)) for a in scenario.arrivals.vehicles)


def problems(scenario, contracts, power, now=0):
    plan = Plan(now, tuple(c.vehicle for c in contracts), np.array(power, dtype=float))
    return plan_problems(FeederCheck(scenario), contracts, plan)


def changed(*changes):
    power = SOUND.copy()
    for row, slot, kw in changes:
        power[row, slot] += kw
    return power


def test_sound_plan_passes(scenario, contracts):
    assert [c.request.deadline_interval for c in contracts] == [3, 4]
    assert problems(scenario, contracts, SOUND) == []


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ([(0, 0, LITTLE)], "x: 18.000100 kWh planned, 18.000000 kWh owed"),
        ([(0, 0, -LITTLE)], "x: 17.999900 kWh planned, 18.000000 kWh owed"),
        ([(0, 0, -LITTLE), (0, 1, LITTLE)], "x: 10.000100 kW in interval 1, at most 10 kW"),
        ([(1, 1, LITTLE), (1, 2, -LITTLE)], "y: 5.000100 kW in interval 1, at most 5 kW"),
        ([(0, 2, -LITTLE), (0, 0, LITTLE)], "x: 1.999900 kW in interval 2, at least 2 kW"),
        ([(0, 2, -2), (0, 3, 2)], "x: charges in interval 3, outside its time"),
        ([(1, 2, -4), (1, 0, 4)], "y: charges in interval 0, outside its time"),
        ([(0, 0, -6.1), (0, 2, 6.1)], "x: power is not a number of at least 0 kW"),
        ([(0, 0, np.nan)], "x: power is not a number of at least 0 kW"),
        ([(0, 0, np.inf)], "x: power is not a number of at least 0 kW"),
    ],
)
def test_plan_wrong_by_a_little_is_caught(scenario, contracts, changes, told):
    found = problems(scenario, contracts, changed(*changes))
    assert any(told in problem for problem in found), found


def test_one_charger_too_few_is_caught(scenario, contracts):
    station = scenario.station.model_copy(update={"chargers": 1})
    found = problems(scenario.replacing(station=station), contracts, SOUND)
    assert found == [f"2 vehicles charge in interval {t}, 1 chargers exist" for t in (1, 2)]


def test_a_little_more_than_the_feeder_bears_is_caught(scenario, contracts):
    rated = scenario.lines[0].model_copy(update={"rating_kva": 25 - LITTLE})
    (found,) = problems(scenario.replacing(lines=(rated,)), contracts, SOUND)
    assert found.startswith("line:s-a exceeded by 0.0001 kVA in interval 1")


def test_limits_broken_in_the_past_or_by_the_feeder_alone_are_not_the_plans(scenario, contracts):
    profile = list(scenario.profile)
    profile[0] = profile[0].model_copy(update={"load_pu": 5.0})
    late = [
        dataclasses.replace(c, delivered_kwh=d) for c, d in zip(contracts, (6.0, 0.0), strict=True)
    ]
    heavy = scenario.replacing(profile=tuple(profile))
    assert problems(heavy, late, SOUND[:, 1:], now=1) == []
    profile[3] = profile[0]
    assert problems(scenario.replacing(profile=tuple(profile)), late, SOUND[:, 1:], now=1) == []
    assert problems(heavy, contracts, SOUND) != []


def test_energy_owed_is_what_has_not_been_delivered(scenario, contracts):
    part = dataclasses.replace(contracts[0], delivered_kwh=6.0)
    power = [[0.0, 10.0, 2.0, 0.0]]
    assert problems(scenario, [part], power) == []
    assert problems(scenario, contracts[:1], power) != []
    assert problems(scenario, [part], SOUND[:1]) != []


def test_less_than_the_lower_end_may_be_owed_and_is_then_the_lower_end(scenario, contracts):
    little = dataclasses.replace(contracts[0], delivered_kwh=16.5)
    assert problems(scenario, [little], [[0.0, 1.5, 0.0, 0.0]]) == []
    assert problems(scenario, [little], [[0.0, 1.0, 0.5, 0.0]]) != []


def test_vehicle_missing_or_misplaced_is_caught(scenario, contracts):
    assert problems(scenario, contracts, SOUND[:1]) != []
    assert problems(scenario, contracts, SOUND[:, :3]) != []
    swapped = Plan(0, ("y", "x"), SOUND.copy())
    assert plan_problems(FeederCheck(scenario), contracts, swapped) != []
    unserved = problems(scenario, contracts, SOUND * [[1], [0]])
    assert unserved == ["y: 0.000000 kWh planned, 10.000000 kWh owed"]


def test_intervals_shorter_than_an_hour_count_their_energy():
    quarter = make_scenario(vehicles=[vehicle("x", 0, 4)], interval_minutes=15)
    contract = [Contract(request_for(quarter, a)) for a in quarter.arrivals.vehicles]
    assert problems(quarter, contract, [[8.0, 8.0, 0.0, 0.0]]) == []
    assert problems(quarter, contract, [[4.0, 0.0, 0.0, 0.0]]) != []
