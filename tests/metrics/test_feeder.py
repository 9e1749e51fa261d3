"""Loading, violations and the gap to AC against code and sums that share nothing with them."""

import numpy as np
import pytest
from hypothesis import given

from evdash.checker.feeder import FeederCheck
from evdash.domain.breach import Breach
from evdash.domain.elements import Element
from evdash.files.bundled import PRESETS
from evdash.files.scenario_folder import read_scenario
from evdash.grid.radial import radial_feeder
from evdash.horizon.day import run_day, start_day, step
from evdash.metrics.feeder import (
    day_breaches,
    flows,
    gaps,
    tightest,
)
from evdash.metrics.outlook import outlook, station_rating_kw
from evdash.metrics.verdict import violations
from evdash.scheduling.p1 import p1_policy
from tests.builders import line, make_scenario, node, scenarios, vehicle


@given(scenarios())
def test_flows_are_those_of_the_walk_from_the_leaves(scenario) -> None:
    trace = run_day(start_day(scenario), p1_policy())
    ahead = outlook(trace)
    found = flows(trace, ahead)
    check = FeederCheck(scenario)
    loaded = check.sweep(ahead.station_kw)
    base = check.sweep(np.zeros(scenario.intervals))
    for child, row in check.line_of.items():
        for sweep, kva in ((loaded, found.line_kva), (base, found.base_line_kva)):
            expected = np.hypot(sweep.flow_kw[child], sweep.flow_kvar[child])
            assert kva[:, row] == pytest.approx(expected, abs=1e-6)


def breach(element: str, interval: int, depth: float, base: float = 0.0) -> Breach:
    return Breach(interval, Element.read(element), depth, base, "pu", 1e-6)


def test_violations_are_told_apart_by_their_cause() -> None:
    found = violations(
        [
            breach("voltage_min:a", 3, 0.01),
            breach("voltage_min:a", 4, 0.03),
            breach("voltage_min:a", 5, 0.02, base=0.01),
            breach("voltage_max:b", 1, 0.02, base=0.02),
        ]
    )
    assert [(str(v.element), v.cause, v.intervals) for v in found] == [
        ("voltage_min:a", "station", (3, 4)),
        ("voltage_min:a", "both", (5,)),
        ("voltage_max:b", "feeder", (1,)),
    ]
    assert (found[0].worst, found[0].depth) == (4, 0.03)
    assert violations([]) == ()


def test_a_feeder_outside_its_limits_by_itself_is_not_the_stations_doing() -> None:
    """Node b hangs on its own line, which charging at a cannot reach; its load is too much."""
    scenario = make_scenario(
        nodes=[node("s"), node("a"), node("b", load_kw=300)],
        lines=[line("s", "a", r=0.5), line("s", "b", r=5.0, rating=200)],
        feeder={"voltage_min_pu": 0.95},
        vehicles=[vehicle("v")],
    )
    trace = run_day(start_day(scenario), p1_policy())
    found = violations(day_breaches(trace, outlook(trace).station_kw))
    assert {str(v.element) for v in found} == {"voltage_min:b", "line:s-b"}
    assert {v.cause for v in found} == {"feeder"}
    assert all(v.depth == v.base_depth and len(v.intervals) == 4 for v in found)


def test_p1_never_causes_a_violation_of_the_model_it_keeps() -> None:
    scenario = make_scenario(
        price=[0.1] * 6,
        nodes=[node("s"), node("a", load_kw=30)],
        lines=[line("s", "a", rating=52)],
        station={"chargers": 5},
        vehicles=[vehicle(f"v{n}", hour=n / 3) for n in range(9)],
    )
    trace = run_day(start_day(scenario), p1_policy())
    assert any(step.plan.refused for step in trace.steps)  # the rating does bind
    assert all(
        v.cause == "feeder" for v in violations(day_breaches(trace, outlook(trace).station_kw))
    )


def test_the_tightest_limits_come_first_and_set_the_headroom() -> None:
    scenario = make_scenario(
        nodes=[node("s"), node("a", load_kw=30)], lines=[line("s", "a", rating=100)]
    )
    trace = step(start_day(scenario), p1_policy())
    ahead = outlook(trace)
    for t in range(4):
        limits = tightest(trace, t, 5)
        assert limits[0] == (ahead.binding[t], pytest.approx(ahead.headroom_kw[t]))
        assert [kw for _, kw in limits] == sorted(kw for _, kw in limits)
    free = start_day(make_scenario(lines=[line("s", "a", r=0.0)]))
    assert tightest(free, 0, 5) == ()


def test_in_ac_the_one_limit_that_is_known_is_told_and_no_endless_room() -> None:
    trace = start_day(read_scenario(PRESETS / "voltage-limited"), "ac")
    rows = trace.inputs.rows
    assert len(rows.elements) > 1
    for t in range(trace.scenario.intervals):
        assert tightest(trace, t, 5) == ((rows.binding()[t], rows.headroom_kw()[t]),)


def test_the_gap_to_ac_is_at_the_node_where_they_differ_most() -> None:
    trace = start_day(
        make_scenario(
            nodes=[node("s"), node("a"), node("b")], lines=[line("s", "a"), line("a", "b")]
        )
    )
    ahead = outlook(trace)
    ac = {
        0: ahead.voltage_pu[0] - np.array([0.001, 0.004]),
        1: np.array([np.nan, np.nan]),
        2: ahead.voltage_pu[2] + np.array([0.002, 0.0]),
    }
    first, second = gaps(ahead, ac)
    assert (first.interval, first.node, first.difference) == (0, "b", pytest.approx(0.004))
    assert first.lowest_linear - first.lowest_ac == pytest.approx(0.004)
    assert (second.interval, second.node, second.difference) == (2, "a", pytest.approx(-0.002))


@pytest.mark.parametrize(
    ("own", "way", "expected"),
    [
        (90.0, 40.0, 90.0),
        (None, 40.0, 40.0),
        (0.0, 40.0, 40.0),  # a rating of nothing is none to measure a load against
        (None, 0.0, 1.0),
        (None, None, 30.0),
    ],
)
def test_the_stations_load_is_measured_against_the_nearest_rating(own, way, expected):
    scenario = make_scenario(
        nodes=[node("s"), node("a", rating_kva=own)],
        lines=[line("s", "a", rating=way)],
        station={"chargers": 3, "max_kw": 10.0},
    )
    assert station_rating_kw(scenario, radial_feeder(scenario)) == expected
