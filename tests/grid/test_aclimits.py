"""The AC network model, refereed by pandapower, whose code it does not share."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings

from benchmarks.ac_headroom import random_tree
from evdash.domain.breach import Breach
from evdash.domain.events import Event
from evdash.domain.scenario import Scenario
from evdash.files.bundled import PRESETS
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario
from evdash.grid.acbreaches import ac_breaches
from evdash.grid.acflow import ac_flow
from evdash.grid.aclimits import MARGIN_KVA, MARGIN_PU, AcFeeder, ac_limit_rows
from evdash.grid.reduction import limit_rows
from evdash.horizon.day import run_day, start_day, step
from evdash.horizon.happen import happen
from evdash.horizon.revise import revise
from evdash.metrics.records import executed_station_kw
from evdash.metrics.service import totals
from evdash.scheduling.p1 import p1_policy
from tests.builders import line, make_scenario, names, node, scenarios, vehicle


def judged(scenario: Scenario, station_kw: np.ndarray) -> tuple[Breach, ...]:
    """Every limit pandapower finds exceeded."""
    base = ac_flow(scenario, np.zeros(scenario.intervals))
    return ac_breaches(scenario, ac_flow(scenario, station_kw), base)


def by_station(breaches: Iterable[Breach]) -> set[tuple[int, str]]:
    return {(b.interval, str(b.element)) for b in breaches if b.by_station}


def clearly_by_station(breaches: Iterable[Breach]) -> set[tuple[int, str]]:
    """Worsened by more than two solvers can differ in."""
    clear = {"pu": 1e-5, "kVA": 1e-2, "solution missing": 0.0}
    return by_station(b for b in breaches if b.depth - b.base_depth > clear[b.unit])


def worsened(scenario: Scenario, station_kw: np.ndarray) -> set[tuple[int, str]]:
    """What pandapower finds the station to worsen: (interval, element)."""
    return by_station(judged(scenario, station_kw))


@given(scenarios(max_nodes=6))
@settings(max_examples=10)
def test_headroom_is_allowed_by_pandapower_and_a_little_more_is_not(scenario):
    rows = ac_limit_rows(scenario)
    headroom_kw, binding = rows.headroom_kw(), names(rows.binding())
    assert worsened(scenario, headroom_kw) == set()
    beyond = worsened(scenario, headroom_kw * 1.01 + 1.0)
    for t, element in enumerate(binding):
        assert (t, element) in beyond


@given(scenarios(max_nodes=6))
@settings(max_examples=10)
def test_the_certificate_agrees_with_pandapower(scenario):
    station_kw = np.linspace(0.0, 150.0, scenario.intervals)
    certificate, verdict = AcFeeder(scenario).breaches(station_kw), judged(scenario, station_kw)
    assert clearly_by_station(certificate) <= by_station(verdict)
    assert clearly_by_station(verdict) <= by_station(certificate)


@pytest.mark.parametrize(
    ("scenario", "kinds"),
    [
        (random_tree(0), {"voltage_min", "line"}),
        (random_tree(4), {"voltage_min"}),
        (read_scenario(PRESETS / "winter-weekday"), {"line"}),
        (read_scenario(PRESETS / "voltage-limited"), {"voltage_min", "line"}),
    ],
    ids=["tree 0", "tree 4", "transformer", "voltage-limited"],
)
def test_headroom_keeps_every_limit_and_two_percent_more_breaks_the_one_named(scenario, kinds):
    rows = ac_limit_rows(scenario)
    headroom_kw, binding = rows.headroom_kw(), names(rows.binding())
    assert {element.partition(":")[0] for element in binding} == kinds
    assert worsened(scenario, headroom_kw) == set()
    beyond = worsened(scenario, 1.02 * headroom_kw)
    room = np.flatnonzero(headroom_kw > 1)
    assert len(room) > scenario.intervals / 2
    assert beyond >= {(int(t), binding[t]) for t in room}


LONG = {"from_node": "s", "to_node": "a", "r_ohm": 1.2, "x_ohm": 0.9}


@pytest.mark.parametrize(
    ("element", "fields"),
    [
        ("voltage_min:b", {"lines": [LONG, line("a", "b", 3.0, 2.0)], "feeder": {}}),
        ("line:s-a", {"lines": [{**LONG, "rating_kva": 95.0}, line("a", "b")]}),
        ("node:a", {"rating": 60.0, "lines": [LONG, line("a", "b")]}),
        (
            "power_flow:a",
            {
                "feeder": {"voltage_min_pu": 0.05},
                "lines": [{**LONG, "x_ohm": 20.0}, line("a", "b")],
            },
        ),
    ],
)
def test_each_kind_of_limit_binds(element, fields):
    nodes = [
        node("s"),
        node("a", load_kw=30, rating_kva=fields.pop("rating", None)),
        node("b", load_kw=40),
    ]
    scenario = make_scenario(nodes=nodes, **fields)
    rows = ac_limit_rows(scenario)
    assert set(names(rows.binding())) == {element}
    assert (rows.headroom_kw() > 1).all()
    assert worsened(scenario, rows.headroom_kw()) == set()
    assert {e for _, e in worsened(scenario, rows.headroom_kw() * 1.02 + 0.1)} >= {element}


def test_losses_count_towards_a_transformer():
    """At the sending end the transformer carries its own losses as well."""
    scenario = read_scenario(PRESETS / "summer-weekday")
    linear, ac = limit_rows(scenario).headroom_kw(), ac_limit_rows(scenario).headroom_kw()
    assert (ac < linear).all()
    executed = ac_flow(scenario, linear)
    transformer = names(executed.lines).index("line:633-634")
    assert (executed.line_kva[:, transformer] > 500).all()


def test_a_feeder_outside_its_limits_by_itself_leaves_no_room_where_charging_worsens_it():
    nodes = [node("s"), node("a", load_kw=10), node("b", load_kw=600)]
    scenario = make_scenario(
        nodes=nodes,
        lines=[line("s", "a", 1.0, 1.0), line("a", "b", 1.0, 1.0)],
        feeder={"voltage_min_pu": 0.97},
    )
    rows = ac_limit_rows(scenario)
    assert set(names(rows.binding())) <= {"voltage_min:a", "voltage_min:b"}
    assert (rows.headroom_kw() < 0.5).all()


def test_a_base_case_without_solution_leaves_no_room():
    nodes = [node("s"), node("a", load_kw=900_000)]
    scenario = make_scenario(nodes=nodes, vehicles=[vehicle("one")])
    rows = ac_limit_rows(scenario)
    assert (rows.headroom_kw() == 0).all()
    day = run_day(start_day(scenario, "ac"), p1_policy())
    assert totals(day).admitted == 0


@pytest.mark.parametrize("network", ["ac", "lindistflow"])
def test_who_charges_where_the_feeder_has_no_solution_of_its_own_is_to_blame(network):
    """Loads a hundredfold from 18:00: AC has no solution with the station or without it."""
    trace = start_day(read_scenario(PRESETS / "summer-weekday"), network)
    while trace.now < 18:
        trace = step(trace, p1_policy())
    lost = Event(interval=18, event="load_factor", value=100)
    after = happen(trace, [lost])
    assert after.state.is_short
    scenario = after.scenario
    power = np.zeros(scenario.intervals)
    power[20] = 1.0
    base = ac_flow(scenario, np.zeros(scenario.intervals))
    for found in (
        AcFeeder(scenario).breaches(power),
        ac_breaches(scenario, ac_flow(scenario, power), base),
    ):
        missing = {b.interval: b.by_station for b in found if str(b.element) == "power_flow:634"}
        assert missing == {t: t == 20 for t in range(18, 24)}
    assert (executed_station_kw(run_day(after, p1_policy()))[18:] == 0).all()


@given(scenarios(max_nodes=6))
@settings(max_examples=12)
def test_days_keep_every_limit_in_pandapower(scenario):
    trace = run_day(start_day(scenario, "ac"), p1_policy())
    assert all(step.plan.report.status == "optimal" for step in trace.steps)
    assert totals(trace).broken == 0
    station_kw = executed_station_kw(trace)
    for breach in judged(scenario, station_kw):
        share = {"pu": 1e-4, "kVA": 1e-3 * breach.depth}.get(breach.unit, 0.0)
        assert breach.depth <= breach.base_depth + share + breach.tolerance


def test_the_linearised_model_is_optimistic_where_voltage_binds():
    """The preset is there to show it: AC refuses what linearised DistFlow allows."""
    scenario = read_scenario(PRESETS / "voltage-limited")
    scenario = edit_scenario(scenario, {"arrivals.vehicles_per_day": 120})
    linear = run_day(start_day(scenario), p1_policy())
    ac = run_day(start_day(scenario, "ac"), p1_policy())
    assert worsened(scenario, executed_station_kw(linear))
    assert worsened(scenario, executed_station_kw(ac)) == set()
    assert totals(ac).admitted < totals(linear).admitted


def test_no_plan_passes_whose_intervals_are_not_all_allowed_in_ac():
    """Handed rows that promise too much, P1 is stopped by the certificate, not by the rows."""
    scenario = read_scenario(PRESETS / "voltage-limited")
    scenario = edit_scenario(scenario, {"arrivals.vehicles_per_day": 120})
    begun = start_day(scenario, "ac")
    misled = replace(begun, inputs=replace(begun.inputs, rows=limit_rows(scenario)))
    day = run_day(misled, p1_policy())
    assert any(step.plan.report.status == "fallback" for step in day.steps)
    assert worsened(scenario, executed_station_kw(day)) == set()


def test_headroom_is_computed_once_and_kept_to_the_bit():
    scenario = read_scenario(PRESETS / "summer-weekday")
    after = step(start_day(scenario, "ac"), p1_policy())
    edited = revise(after, edit_scenario(scenario, {"option.C1.price_per_kwh": 0.5}))
    assert edited.inputs.rows is after.inputs.rows
    assert edited.inputs.network == "ac"
    scaled = revise(after, edit_scenario(scenario, {"feeder.load_scale": 0.9}))
    assert scaled.inputs.rows is not after.inputs.rows
    again = ac_limit_rows(scenario)
    assert np.array_equal(again.limit_kw, after.inputs.rows.limit_kw)


def test_the_certificate_forgives_ten_times_what_the_search_does_and_no_more():
    """So that a plan at the headroom found is never refused for what a solver rounds."""
    scenario = make_scenario(
        nodes=[node("s"), node("a", load_kw=40)], lines=[line("s", "a", rating=95.0)], price=[0.1]
    )
    feeder = AcFeeder(scenario)
    low, high = 0.0, 200.0
    while high - low > 1e-9:  # the power at which the line is loaded as rated
        middle = (low + high) / 2
        beyond = feeder.excess(np.arange(1), np.array([middle]))[0].max() > 0
        low, high = (low, middle) if beyond else (middle, high)
    for over_kw, worse, refused in (
        (-1e-6, False, False),
        (0.5 * MARGIN_KVA, False, False),
        (2 * MARGIN_KVA, True, False),
        (9 * MARGIN_KVA, True, False),
        (12 * MARGIN_KVA, True, True),
    ):
        station_kw = np.array([low + over_kw])
        assert feeder.worsened(*feeder.excess(np.arange(1), station_kw)).any() == worse
        assert bool(feeder.breaches(station_kw)) == refused


def test_so_does_it_of_voltages():
    scenario = make_scenario(
        nodes=[node("s"), node("a", load_kw=40)],
        lines=[line("s", "a", r=4.0, x=2.0)],
        feeder={"voltage_min_pu": 0.97},
        price=[0.1],
    )
    feeder = AcFeeder(scenario)
    low, high = 0.0, float(ac_limit_rows(scenario).headroom_kw()[0]) + 10
    while high - low > 1e-9:
        middle = (low + high) / 2
        beyond = feeder.excess(np.arange(1), np.array([middle]))[0].max() > 0
        low, high = (low, middle) if beyond else (middle, high)
    per_kw = feeder.excess(np.arange(1), np.array([low + 1.0]))[0].max()
    for times, worse, refused in ((0.5, False, False), (5, True, False), (12, True, True)):
        station_kw = np.array([low + times * MARGIN_PU / per_kw])
        assert feeder.worsened(*feeder.excess(np.arange(1), station_kw)).any() == worse
        assert bool(feeder.breaches(station_kw)) == refused
