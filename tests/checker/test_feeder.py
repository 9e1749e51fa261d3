"""The checker walks the feeder; the grid multiplies matrices; both must say the same."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evdash.checker.feeder import FeederCheck
from evdash.grid.lindistflow import base_injections, line_flows, voltage_sq_pu, with_station
from evdash.grid.radial import radial_feeder
from evdash.grid.reduction import limit_rows
from tests.builders import line, make_scenario, node, scenarios

BEYOND_KW = 0.1  # well beyond every tolerance of the checker


@given(scenario=scenarios(max_vehicles=0), station_kw=st.floats(0, 500))
def test_voltages_and_flows_are_those_of_the_grid(scenario, station_kw):
    station = np.full(scenario.intervals, station_kw)
    feeder = radial_feeder(scenario)
    moved = with_station(scenario, feeder, base_injections(scenario, feeder), station)
    squared, flows = voltage_sq_pu(scenario, feeder, moved), line_flows(feeder, moved)
    check = FeederCheck(scenario)
    sweep = check.sweep(station)
    for i, name in enumerate(feeder.nodes):
        row = check.line_of[name]
        assert sweep.voltage_sq_pu[name] == pytest.approx(squared[:, i], abs=1e-12)
        assert sweep.flow_kw[name] == pytest.approx(flows.active_kw[:, row], abs=1e-9)
        assert sweep.flow_kvar[name] == pytest.approx(flows.reactive_kvar[:, row], abs=1e-9)


@given(
    scenario=scenarios(max_vehicles=0),
    row=st.integers(0, 30),
    away_kw=st.sampled_from([-BEYOND_KW, BEYOND_KW, 50.0]),
)
def test_station_breaks_exactly_the_elements_whose_rows_are_exceeded(scenario, row, away_kw):
    rows = limit_rows(scenario)
    if not rows.elements:
        station = np.full(scenario.intervals, 1000.0)
    else:
        tight = rows.limit_kw[:, row % len(rows.elements)]
        station = np.maximum(0.0, np.maximum(0.0, tight) + away_kw)
    room = np.maximum(0.0, rows.limit_kw)
    # a tie of another row with this station power is for neither side to decide
    clear = np.abs(room - station[:, None]) > BEYOND_KW / 2
    check = FeederCheck(scenario)
    blamed = {(b.interval, b.element) for b in check.breaches(station) if b.by_station}
    expected = {
        (t, element)
        for t in range(scenario.intervals)
        for i, element in enumerate(rows.elements)
        if station[t] > room[t, i]
    }
    unclear = {(int(t), rows.elements[i]) for t, i in np.argwhere(~clear)}
    assert blamed - unclear == expected - unclear


@given(scenario=scenarios(max_vehicles=0), station_kw=st.floats(0, 500))
def test_what_is_not_the_stations_doing_was_there_without_it(scenario, station_kw):
    check = FeederCheck(scenario)
    own = {(b.interval, b.element) for b in check.breaches(np.zeros(scenario.intervals))}
    found = check.breaches(np.full(scenario.intervals, station_kw))
    assert {(b.interval, b.element) for b in found if not b.by_station} <= own
    assert not any(b.by_station for b in check.breaches(np.zeros(scenario.intervals)))


def test_a_breach_tells_where_when_and_by_how_much():
    scenario = make_scenario(
        nodes=[node("s"), node("a", load_kw=30, load_kvar=40)],
        lines=[line("s", "a", rating=50)],
        load=[0.5, 1.0],
        price=[0.1, 0.1],
    )
    (breach,) = FeederCheck(scenario).breaches(np.array([5.0, 12.0]))
    assert (breach.interval, str(breach.element), breach.unit) == (1, "line:s-a", "kVA")
    assert (breach.depth, breach.base_depth) == (pytest.approx(8), 0)  # 42 kW and 40 kvar: 58


def test_lines_whose_names_coincide_are_kept_apart():
    scenario = make_scenario(
        nodes=[node("s"), node("s-a"), node("a-b"), node("b", load_kw=100, load_kvar=0)],
        # both are called line:s-a-b; the first is broken by itself, the station is on the second
        lines=[line("s", "s-a"), line("s-a", "b", rating=40), line("s", "a-b", rating=10)],
        station={"node": "a-b"},
        price=[0.1],
    )
    check = FeederCheck(scenario)
    assert [b.by_station for b in check.breaches(np.array([9.0]))] == [False]
    assert sorted(b.by_station for b in check.breaches(np.array([20.0]))) == [False, True]


def test_charging_worsens_even_a_collapsed_voltage():
    scenario = make_scenario(nodes=[node("s"), node("a", load_kw=200_000)], price=[0.1])
    check = FeederCheck(scenario)
    assert check.base.voltage_sq_pu["a"][0] < 0
    assert [b.by_station for b in check.breaches(np.array([0.0]))] == [False]
    assert [b.by_station for b in check.breaches(np.array([50.0]))] == [True]
