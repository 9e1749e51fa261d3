"""The charts say what the trace says; their specs are plain, valid and always the same."""

import base64
import json
from datetime import datetime
from typing import Any

import numpy as np
import plotly.graph_objects as go
import plotly.io as pio
import pytest

from evdash.charts.admissions import admissions_alt, admissions_figure, admissions_table
from evdash.charts.drawn import Drawn, in_the_look
from evdash.charts.legend import roomy
from evdash.charts.load import load_alt, load_table, normalised_figure, units_figure
from evdash.charts.schedule import schedule_alt, schedule_figure, schedule_table
from evdash.charts.style import GREEN, VERMILLION
from evdash.charts.voltages import (
    base_figure,
    drop_figure,
    voltages_alt,
    voltages_figure,
    voltages_table,
)
from evdash.domain.trace import Trace
from evdash.horizon.day import run_day, start_day
from evdash.metrics.outlook import outlook
from evdash.metrics.records import executed_power, interval_records, vehicle_records
from evdash.scheduling.p1 import p1_policy
from tests.builders import line, make_scenario, node, vehicle


def figures(trace: Trace) -> dict[str, dict[str, Any]]:
    ahead = outlook(trace)
    ac = {t: ahead.voltage_pu[t] - 0.001 for t in range(ahead.now)}
    return {
        "schedule": schedule_figure(trace, ahead),
        "admissions": admissions_figure(trace, ahead),
        "normalised": normalised_figure(ahead),
        "units": units_figure(ahead),
        "voltages": voltages_figure(ahead, ac),
        "voltages without": base_figure(ahead),
        "voltage drop": drop_figure(ahead),
    }


def named(figure: dict[str, Any], name: str) -> dict[str, Any]:
    return next(trace for trace in figure["data"] if trace.get("name") == name)


def test_figures_are_valid_plain_json_and_deterministic(trace: Trace) -> None:
    for name, figure in figures(trace).items():
        text = json.dumps(figure, allow_nan=False)
        go.Figure(figure)  # plotly validates every property
        assert text == json.dumps(figures(trace)[name], allow_nan=False)
        assert len(text) < 60_000


def test_every_axis_of_values_has_a_title_with_a_unit(trace: Trace) -> None:
    shown = figures(trace)
    titles = {
        name: [
            axis["title"]["text"]
            for key, axis in figure["layout"].items()
            if key.startswith(("xaxis", "yaxis"))
        ]
        for name, figure in shown.items()
    }
    assert titles["normalised"] == ["Clock time", "Share, %"]
    assert set(titles["units"]) == {"Clock time", "Station, kW", "Feeder, kW", "Price, $/kWh"}
    assert set(titles["voltages"]) == {"Clock time", "Voltage, pu", "Node"}
    assert titles["admissions"] == ["Clock time", "Vehicles per hour"]


def test_gantt_bars_are_the_energy_executed_and_planned(traces: dict[str, Trace]) -> None:
    trace = traces["evening"]
    figure = schedule_figure(trace, outlook(trace))
    charged = sum(len(named(figure, f"{option} charged")["x"]) for option in ("C1", "C2"))
    planned = sum(len(named(figure, f"{option} planned")["x"]) for option in ("C1", "C2"))
    assert charged == len(list(executed_power(trace)))
    assert planned == int((trace.state.tail_kw > 0).sum()) > 0
    assert named(figure, "C1 planned")["marker"]["pattern"]["shape"]  # never colour alone
    now = trace.scenario.time_of(trace.now)
    for option in ("C1", "C2"):
        for kind, is_past in (("charged", True), ("planned", False)):
            for base in named(figure, f"{option} {kind}")["base"]:
                assert (datetime.fromisoformat(base) < now) == is_past


def test_gantt_windows_end_at_the_promised_return(traces: dict[str, Trace]) -> None:
    trace = traces["evening"]
    windows = named(schedule_figure(trace, outlook(trace)), "Promised")
    admitted = [r for r in vehicle_records(trace) if r.status != "refused"]
    assert len(windows["x"]) == len(admitted)
    for base, length, record in zip(windows["base"], windows["x"], admitted, strict=True):
        request = record.request
        assert datetime.fromisoformat(base) == trace.scenario.time_of(request.arrival_interval)
        hours = (request.deadline_interval - request.arrival_interval) * 1.0
        assert length == hours * 3_600_000


def test_percent_complete_stands_at_every_bars_end(traces: dict[str, Trace]) -> None:
    trace = traces["end"]
    texts = [t for t in schedule_figure(trace, outlook(trace))["data"] if t.get("mode") == "text"]
    assert len(texts[0]["text"]) == 51
    assert all(text.endswith("100 %") for text in texts[0]["text"])
    rows = schedule_table(trace, outlook(trace))
    assert {row["Done, %"] for row in rows} == {100}


def test_more_vehicles_than_bars_can_show_become_a_heat_map() -> None:
    trace = crowd(200, intervals=96)
    figure = schedule_figure(trace, outlook(trace))
    heat = figure["data"][0]
    assert heat["type"] == "heatmap"
    assert len(heat["z"]) == 200
    assert len(figure["layout"]["yaxis"]["tickvals"]) < 70  # every n-th label
    drawn = sum(power or 0.0 for row in heat["z"] for power in row)
    executed = sum(power for _, _, power in executed_power(trace))
    assert drawn == pytest.approx(executed, abs=0.1)
    assert len(json.dumps(figure)) < 2_500_000


def test_admissions_are_counted_per_interval(trace: Trace) -> None:
    ahead = outlook(trace)
    figure = admissions_figure(trace, ahead)
    records = interval_records(trace)
    assert [n or 0 for n in named(figure, "Admitted")["y"]] == [r.admitted for r in records]
    assert [n or 0 for n in named(figure, "Refused")["y"]] == [r.refused for r in records]
    assert [n or 0 for n in named(figure, "Asked")["y"]] == [r.arrived for r in records]
    assert [row["Asked"] for row in admissions_table(trace, ahead)] == [r.arrived for r in records]


def test_load_is_normalised_as_in_the_paper(traces: dict[str, Trace]) -> None:
    trace = traces["end"]
    ahead = outlook(trace)
    assert ahead.station_rating_kw == 500  # the transformer's
    figure = normalised_figure(ahead)
    station = named(figure, "Station")["y"][:-1]
    records = interval_records(trace)
    assert station == pytest.approx([100 * r.station_kw / 500 for r in records], abs=1e-4)
    assert max(named(figure, "Feeder load")["y"]) == pytest.approx(100)
    assert max(named(figure, "Price")["y"]) == pytest.approx(100)


def test_load_in_units_is_the_records(traces: dict[str, Trace]) -> None:
    trace = traces["evening"]
    figure = units_figure(outlook(trace))
    records = interval_records(trace)
    assert named(figure, "Station")["y"][:-1] == pytest.approx([r.station_kw for r in records])
    assert named(figure, "Headroom")["y"][: trace.now] == pytest.approx(
        [r.headroom_kw for r in records]
    )
    rows = load_table(outlook(trace))
    assert [row[""] for row in rows] == ["executed"] * 19 + ["planned"] * 5


def test_lines_hold_each_value_until_its_interval_ends(trace: Trace) -> None:
    load = named(normalised_figure(outlook(trace)), "Feeder load")
    assert len(load["x"]) == len(load["y"]) == 25
    assert load["y"][-1] == load["y"][-2]
    assert load["line"]["shape"] == "hv"


def test_voltages_outside_limits_are_marked(traces: dict[str, Trace]) -> None:
    ahead = outlook(traces["end"])
    figure = voltages_figure(ahead, {})
    assert not [t for t in figure["data"] if "Outside" in t.get("name", "")]
    low = ahead.voltage_pu[18].copy()
    low[3] = 0.96
    marks = named(voltages_figure(ahead, {18: low}), "Outside limits in AC")
    assert marks["y"] == [3]
    assert marks["x"] == ["2020-07-15T18:30"]
    assert voltages_table(ahead, {18: low})[18]["Lowest by AC, pu"] == 0.96


def test_the_lowest_voltage_in_ac_is_red_where_the_linearised_one_is_not(
    traces: dict[str, Trace],
) -> None:
    ahead = outlook(traces["end"])
    assert ahead.voltage_pu.min() > ahead.voltage_min_pu
    low = ahead.voltage_pu[18].copy()
    low[3] = ahead.voltage_min_pu - 0.001
    figure = voltages_figure(ahead, {17: ahead.voltage_pu[17], 18: low})
    kept = named(figure, "Lowest node, AC")
    below = named(figure, "Lowest node, AC, below its limit")
    assert (len(kept["y"]), kept["marker"]["color"]) == (1, GREEN)
    assert below["y"] == pytest.approx([low[3]], abs=1e-6)
    assert below["marker"]["color"] == VERMILLION


def test_an_interval_without_ac_solution_is_left_out(traces: dict[str, Trace]) -> None:
    ahead = outlook(traces["end"])
    nothing = np.full(len(ahead.nodes), np.nan)
    figure = voltages_figure(ahead, {18: nothing})
    json.dumps(figure, allow_nan=False)
    assert named(figure, "Lowest node, AC")["y"] == []


def test_alternative_texts_say_what_is_drawn(trace: Trace) -> None:
    ahead = outlook(trace)
    assert "vehicles under contract" in schedule_alt(trace, ahead)
    assert f"{len(vehicle_records(trace))}" in admissions_alt(trace, ahead) or trace.is_over
    assert "kW" in load_alt(ahead)
    assert "pu" in voltages_alt(ahead)


def test_no_rating_and_no_limit_can_be_drawn_too() -> None:
    trace = run_day(crowd(0, intervals=4), p1_policy())
    for figure in figures(trace).values():
        go.Figure(figure)
        json.dumps(figure, allow_nan=False)


def test_dates_are_told_where_the_day_crosses_midnight() -> None:
    trace = crowd(3, intervals=30, minutes=60)
    axis = admissions_figure(trace, outlook(trace))["layout"]["xaxis"]
    assert "%d" in axis["tickformat"]
    assert (
        "%d"
        not in admissions_figure(crowd(1, intervals=8), outlook(crowd(1, intervals=8)))["layout"][
            "xaxis"
        ]["tickformat"]
    )


@pytest.mark.parametrize("name", ["x<b>bold</b>", "a$\\alpha$", "b%{y}", "n&amp;"])
def test_names_cannot_become_markup(name: str) -> None:
    """Plotly reads a subset of HTML and, between dollars, LaTeX."""
    option = {"name": name, "price_per_kwh": 0.4, "average_kw": 8.0}
    trace = run_day(
        start_day(
            make_scenario(
                nodes=[node("s"), node(name)],
                lines=[line("s", name)],
                station={"node": name},
                options=[option],
                vehicles=[vehicle(name, option=name)],
            )
        ),
        p1_policy(),
    )
    for figure in figures(trace).values():
        go.Figure(figure)
        for text in texts_in(figure["data"]) + texts_in(figure["layout"]):
            assert "<b>" not in text
            assert text.count("$") < 2
            if "hovertemplate" not in text:
                assert "n&amp; " not in text


def texts_in(part: Any) -> list[str]:
    if isinstance(part, dict):
        return [t for key, value in part.items() for t in texts_in(value)]
    if isinstance(part, list | tuple):
        return [t for value in part for t in texts_in(value)]
    return [part] if isinstance(part, str) else []


def crowd(number: int, intervals: int, minutes: int = 15) -> Trace:
    """Many vehicles, all admitted and served as they come, run to the end."""
    hours = intervals * minutes / 60
    scenario = make_scenario(
        price=[0.1] * intervals,
        interval_minutes=minutes,
        station={"chargers": 400},
        feeder={"voltage_min_pu": 0.01},
        nodes=[node("s"), node("a")],
        lines=[line("s", "a", r=1e-6, x=1e-6)],
        vehicles=[
            vehicle(f"PEV-{n:03d}", hour=(hours - 3) * n / max(1, number), need_kwh=5.0)
            for n in range(number)
        ],
    )
    return run_day(start_day(scenario), p1_policy())


def test_the_three_voltages_add_up(trace: Trace) -> None:
    """Without charging, less the drop, is what there is with charging."""
    shown = figures(trace)
    maps = {
        name: np.array(next(t for t in shown[name]["data"] if t["type"] == "heatmap")["z"])
        for name in ("voltages", "voltages without", "voltage drop")
    }
    with_charging = maps["voltages without"] - maps["voltage drop"]
    assert np.allclose(with_charging, maps["voltages"], atol=2e-5)
    assert (maps["voltage drop"].max() > 1e-4) == bool(trace.steps)
    assert maps["voltage drop"].min() >= 0


def test_what_is_handed_over_unchecked_is_what_plotly_itself_would_write(trace: Trace) -> None:
    for name, drawn in figures(trace).items():
        layout = in_the_look(roomy(drawn, None))
        own = json.loads(pio.to_json(go.Figure({**drawn, "layout": layout})))
        given = json.loads(pio.to_json(Drawn(drawn).to_dict(), validate=False))
        assert isinstance(given["layout"].pop("datarevision"), int)
        own["layout"].pop("template")
        assert plainly(given) == plainly(own), name


def plainly(value: Any) -> Any:
    """Without plotly's shorthand for arrays, colour scales by name or in full, empty lists."""
    if isinstance(value, dict) and "bdata" in value:
        numbers = np.frombuffer(base64.b64decode(value["bdata"]), dtype=value["dtype"])
        shape = [int(n) for n in str(value.get("shape", len(numbers))).split(",")]
        return numbers.astype(float).reshape(shape).tolist()
    if isinstance(value, dict):
        return {
            key: plainly(one) for key, one in value.items() if key != "colorscale" and one != []
        }
    if isinstance(value, list):
        return [plainly(one) for one in value]
    return value
