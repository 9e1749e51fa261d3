"""The feeder's drawings say what the trace says, on small feeders and on large ones."""

import json
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import plotly.graph_objects as go
import pytest
from hypothesis import given

from evdash.charts.ac_gap import ac_gap_alt, ac_gap_figure, ac_gap_table
from evdash.charts.feeder import feeder_figure
from evdash.charts.feeder_layout import layout_of
from evdash.charts.feeder_moment import (
    Moment,
    feeder_alt,
    feeder_table,
    lines_table,
    loading_told,
    percent_told,
)
from evdash.charts.headroom import headroom_alt, headroom_figure, headroom_table
from evdash.charts.voltage_map import map_figure
from evdash.domain.breach import Breach
from evdash.domain.elements import Element
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.horizon.day import run_day, start_day
from evdash.metrics.ac import AcPoint
from evdash.metrics.feeder import day_breaches, flows, gaps
from evdash.metrics.outlook import outlook
from evdash.scheduling.p1 import p1_policy
from tests.builders import line, make_scenario, node, trees, vehicle
from tests.charts.test_figures import named, texts_in

EVENING = 18


def moment(trace: Trace, interval: int = EVENING, **fields: Any) -> Moment:
    ahead = outlook(trace)
    return Moment(
        trace.scenario, ahead, flows(trace, ahead), layout_of(trace.scenario), interval, **fields
    )


def in_ac(trace: Trace, interval: int, *breaches: Breach) -> AcPoint:
    """Something like AC: a little lower, and a little more in the lines."""
    ahead = outlook(trace)
    kva = 1.02 * flows(trace, ahead).line_kva[interval]
    return AcPoint(ahead.voltage_pu[interval] - 0.01, kva, breaches)


def breach(element: str, depth: float, unit: str = "kVA", interval: int = EVENING) -> Breach:
    return Breach(interval, Element.read(element), depth, 0.0, unit, 1e-6)


def figures_of(trace: Trace) -> list[dict[str, Any]]:
    ahead = outlook(trace)
    ac = {t: ahead.voltage_pu[t] - 0.002 for t in range(ahead.now)}
    last = trace.scenario.intervals - 1
    order = layout_of(trace.scenario).order
    return [
        *(feeder_figure(moment(trace, last, way=way)) for way in ("with", "without", "difference")),
        feeder_figure(moment(trace, last, ac=in_ac(trace, last))),
        *(map_figure(ahead, ac, order, way) for way in ("with", "without", "difference")),
        headroom_figure(ahead),
        ac_gap_figure(ahead, gaps(ahead, ac)),
    ]


def test_figures_are_valid_plain_json_and_deterministic(trace: Trace) -> None:
    for figure, again in zip(figures_of(trace), figures_of(trace), strict=True):
        text = json.dumps(figure, allow_nan=False)
        assert text == json.dumps(again)
        assert len(text) < 60_000
        go.Figure(figure)


def drawn_nodes(figure: dict[str, Any]) -> dict[str, float]:
    """Voltage by node as the hover text says it."""
    found = {}
    for kind in ("Node", "Source", "Charging station"):
        for told in named(figure, kind)["hovertext"]:
            name, _, rest = told.removeprefix("Node ").partition(": ")
            found[name] = float(rest.split()[0])
    return found


def test_nodes_carry_their_voltages_and_stand_at_their_coordinates(traces) -> None:
    trace = traces["end"]
    ahead = outlook(trace)
    figure = feeder_figure(moment(trace))
    shown = drawn_nodes(figure)
    assert shown.pop("650") == 1.02
    expected = dict(zip(ahead.nodes, ahead.voltage_pu[EVENING], strict=True))
    assert shown == pytest.approx(expected, abs=1e-4)
    station = named(figure, "Charging station")
    assert (station["x"], station["y"]) == ([400.0], [300.0])  # nodes.csv of node 634
    assert layout_of(trace.scenario).is_given


def test_without_charging_and_the_difference_add_up(traces) -> None:
    trace = traces["end"]
    with_it, without, drop = (
        drawn_nodes(feeder_figure(moment(trace, way=way)))
        for way in ("with", "without", "difference")
    )
    assert drop["634"] > 1e-4
    for name in with_it:
        assert without[name] - drop[name] == pytest.approx(with_it[name], abs=2e-4)


def test_the_tightest_element_is_marked(traces) -> None:
    trace = traces["end"]
    assert str(outlook(trace).binding[EVENING]) == "line:633-634"
    halo = named(feeder_figure(moment(trace)), "Tightest limit")
    assert halo["x"] == [350.0, 400.0]  # from node 633 to node 634
    assert halo["mode"] == "lines"


def test_lines_are_classed_by_loading(traces) -> None:
    trace = traces["end"]
    shown = moment(trace)
    figure = feeder_figure(shown)
    rows = {row["Line"]: row for row in lines_table(shown)}
    loading = rows["633–634"]["Loading, %"]
    assert 80 < loading <= 100
    assert named(figure, "80–100 %")["x"][:2] == [350.0, 400.0]
    assert rows["671–692"]["Loading, %"] is None
    widths = [t["line"]["width"] for t in figure["data"] if t.get("mode") == "lines"][1:]
    assert len(set(widths)) == len(widths) > 2  # never colour alone


def test_nodes_outside_limits_are_marked_by_shape_for_each_model(traces) -> None:
    trace = traces["end"]
    ahead = outlook(trace)
    low = ahead.voltage_pu.copy()
    place = ahead.nodes.index("652")
    low[EVENING, place] = 0.96
    shown = replace(
        moment(trace, ac=in_ac(trace, EVENING, breach("voltage_min:611", 0.02, "pu"))),
        outlook=replace(ahead, voltage_pu=low),
        linear=(breach("voltage_min:652", 0.01, "pu"),),
    )
    figure = feeder_figure(shown)
    linear, by_ac = named(figure, "Outside limits"), named(figure, "Outside limits in AC")
    assert (linear["x"], linear["y"]) == ([100.0], [0.0])
    assert (by_ac["x"], by_ac["y"]) == ([0.0], [100.0])
    assert linear["marker"]["symbol"] != by_ac["marker"]["symbol"]
    assert feeder_table(shown)[0]["Node"] == "652"


def test_tables_and_words_tell_the_same(traces) -> None:
    trace = traces["evening"]
    shown = moment(trace)
    rows = feeder_table(shown)
    lowest = outlook(trace).voltage_pu[EVENING].min()
    assert rows[0]["With charging, pu"] == pytest.approx(lowest, abs=1e-5)
    assert f"{lowest:.4f}" in feeder_alt(shown)
    assert len(lines_table(shown)) == len(trace.scenario.lines)


def test_the_map_has_every_node_once_and_contours_at_limits(traces) -> None:
    trace = traces["end"]
    ahead = outlook(trace)
    order = layout_of(trace.scenario).order
    assert sorted(order) == sorted(ahead.nodes)
    low = replace(ahead, voltage_min_pu=float(np.median(ahead.voltage_pu)))
    figure = map_figure(low, {}, order, "with")
    heat = figure["data"][0]
    assert heat["z"][order.index("652")] == pytest.approx(
        ahead.voltage_pu[:, ahead.nodes.index("652")], abs=1e-5
    )
    limit = next(t for t in figure["data"] if t["type"] == "contour")
    assert limit["contours"]["start"] == limit["contours"]["end"] == low.voltage_min_pu
    calm = map_figure(replace(ahead, voltage_min_pu=0.5, voltage_max_pu=1.5), {}, order, "with")
    assert [t["type"] for t in calm["data"]] == ["heatmap"]


def test_headroom_has_a_look_for_each_element(traces) -> None:
    trace = traces["end"]
    ahead = outlook(trace)
    two = (Element("line", "633", "634"),) * 12 + (Element("voltage_min", "652"),) * 12
    figure = headroom_figure(replace(ahead, binding=two))
    first, second = (named(figure, name) for name in ("rating of 633-634", "voltage at 652"))
    assert first["y"] + second["y"] == pytest.approx(list(ahead.headroom_kw), abs=1e-3)
    assert first["marker"]["pattern"]["shape"] != second["marker"]["pattern"]["shape"]
    rows = headroom_table(ahead)
    assert [row["Station, kW"] for row in rows] == pytest.approx(list(ahead.station_kw), abs=0.06)
    assert f"{ahead.headroom_kw.min():.0f} kW" in headroom_alt(ahead)


def test_a_feeder_that_limits_nothing_says_so() -> None:
    trace = run_day(start_day(make_scenario(lines=[line("s", "a", r=0.0)])), p1_policy())
    figure = headroom_figure(outlook(trace))
    assert "no limit" in json.dumps(figure)
    assert "no limit" in headroom_alt(outlook(trace))


def test_ac_below_the_limit_is_red_and_crossed(traces) -> None:
    trace = traces["end"]
    ahead = outlook(trace)
    ac = {17: ahead.voltage_pu[17], 18: ahead.voltage_pu[18] - 0.02}
    found = gaps(ahead, ac)
    figure = ac_gap_figure(ahead, found)
    low = named(figure, "AC below the lowest allowed")
    assert low["x"] == ["2020-07-15T18:30"]
    assert low["marker"]["symbol"] == "x"
    assert [row["AC below the lowest allowed"] for row in ac_gap_table(ahead, found)] == [
        "no",
        "yes",
    ]
    assert "0.0200 pu" in ac_gap_alt(ahead, found)
    assert "no interval" in ac_gap_alt(ahead, ())


@given(trees(max_nodes=30, rated=False))
def test_a_tree_gives_every_node_its_own_place_and_draws_no_line_through_another(tree) -> None:
    layout = layout_of(make_scenario(**tree))
    assert not layout.is_given
    assert len(set(layout.places.values())) == len(tree["nodes"])
    assert sorted(layout.order) == sorted(n["node"] for n in tree["nodes"] if n["node"] != "s")
    places = set(layout.places.values())
    for row, way in zip(tree["lines"], layout.ways, strict=True):
        ends = {layout.places[row["from_node"]], layout.places[row["to_node"]]}
        assert {way[0], way[-1]} == ends
        assert not (places - ends) & set(points_on(way))


def points_on(way: tuple[tuple[float, float], ...]) -> list[tuple[float, float]]:
    """All places of the grid a way passes."""
    found = []
    for (x0, y0), (x1, y1) in pairwise(way):
        steps = int(max(abs(x1 - x0), abs(y1 - y0)))
        found += [
            (x0 + (x1 - x0) * n / max(1, steps), y0 + (y1 - y0) * n / max(1, steps))
            for n in range(steps + 1)
        ]
    return found


def chain(n: int) -> Scenario:
    names = [f"n{i}" for i in range(n)]
    return make_scenario(
        price=[0.1] * 24,
        nodes=[node("s"), *(node(name, load_kw=1) for name in names)],
        lines=[line(a, b, r=1e-4) for a, b in zip(["s", *names], names, strict=False)],
        station={"node": names[n // 2]},
    )


def test_a_feeder_of_five_hundred_nodes_stays_small_and_thinly_labelled() -> None:
    trace = run_day(start_day(chain(500)), p1_policy())
    figure = feeder_figure(moment(trace))
    texts = [text for t in figure["data"] for text in t.get("text", []) if text]
    assert 2 <= len(texts) < 20
    assert len(json.dumps(figure)) < 250_000
    heat = map_figure(outlook(trace), {}, layout_of(trace.scenario).order, "with")
    assert len(heat["layout"]["yaxis"]["tickvals"]) < 60
    assert heat["layout"]["height"] <= 640


def test_names_cannot_become_markup() -> None:
    name = "a<i>$x$"
    scenario = make_scenario(
        nodes=[node("s"), node(name)],
        lines=[line("s", name, rating=50)],
        station={"node": name},
        vehicles=[vehicle("v")],
    )
    trace = run_day(start_day(scenario), p1_policy())
    for figure in figures_of(trace):
        for text in texts_in(figure["data"]) + texts_in(figure["layout"]):
            assert "<i>" not in text
            assert "$" not in text


@pytest.mark.parametrize(
    ("share", "is_over", "told"),
    [
        (1.0188, True, "102 %"),
        (1.0, False, "100 %"),
        (0.996, False, "100 %"),
        (1.004, True, "100.40 %"),
        (1.00001, True, "just over 100 %"),
        (float("inf"), True, "rated 0 kVA"),
    ],
)
def test_a_loading_is_never_rounded_to_the_other_side(
    share: float, is_over: bool, told: str
) -> None:
    assert percent_told(share, is_over=is_over) == told


def test_a_line_over_its_rating_in_ac_alone_is_drawn_and_told_as_such(traces) -> None:
    trace = traces["end"]
    row = [one.name for one in trace.scenario.lines].index("633-634")
    ac = in_ac(trace, EVENING, breach("line:633-634", 9.4))
    ac.line_kva[row] = 509.4
    shown = moment(trace, ac=ac)
    figure = feeder_figure(shown)
    assert named(figure, "Over its rating")["x"][:2] == [350.0, 400.0]
    assert "80–100 %" not in {drawn.get("name") for drawn in figure["data"]}
    assert loading_told(shown, row) == "100 %, AC 102 %"
    assert any("100 %<br>AC 102 %" in drawn.get("text", ()) for drawn in figure["data"])
    assert any(
        "509.4 kVA by AC power flow (100 %, AC 102 %)" in text
        for drawn in figure["data"]
        for text in drawn.get("hovertext") or ()
    )
    assert "Outside limits, AC: rating of 633-634." in feeder_alt(shown)
    cells = next(one for one in lines_table(shown) if one["Line"] == "633–634")
    assert (cells["Loading, %"], cells["Loading by AC, %"]) == (99.8, 101.9)
    assert cells["Over its rating"] == "AC"
    without = moment(trace, ac=ac, way="without")
    assert "Over its rating" not in {one.get("name") for one in feeder_figure(without)["data"]}


def test_a_node_over_its_own_rating_is_marked_too(traces) -> None:
    trace = traces["end"]
    figure = feeder_figure(moment(trace, linear=(breach("node:634:export", 5.0),)))
    assert named(figure, "Outside limits")["x"] == [400.0]


def test_a_line_is_held_against_the_rating_then_in_force() -> None:
    """60 kW at a power factor of 0.9 flow all day; the rating falls from 100 to 50 kVA at 02:00."""
    event = {"interval": 2, "event": "rating", "subject": "line:s-a", "value": 50.0}
    scenario = make_scenario(
        nodes=[node("s"), node("a", load_kw=60)], lines=[line("s", "a", rating=100)], events=[event]
    )
    trace = run_day(start_day(scenario), p1_policy())
    breaches = day_breaches(trace, outlook(trace).station_kw)
    for interval, told, over in ((1, "67 %", False), (3, "133 %", True)):
        linear = tuple(one for one in breaches if one.interval == interval)
        shown = moment(trace, interval, linear=linear)
        assert loading_told(shown, 0) == told
        names = {one.get("name") for one in feeder_figure(shown)["data"]}
        assert ("Over its rating" in names) == over
