"""Charts of many vehicles and of one say what the trace says."""

import json
from datetime import datetime
from typing import Any

import plotly.graph_objects as go
import pytest

from evdash.charts.fleet import fleet_alt, fleet_figure, fleet_table
from evdash.charts.plan_history import history_alt, history_figure, history_table
from evdash.charts.vehicle import vehicle_alt, vehicle_figure, vehicle_table
from evdash.domain.events import Event
from evdash.domain.trace import Trace
from evdash.horizon.day import run_day, start_day, step
from evdash.horizon.happen import happen
from evdash.metrics.outlook import outlook
from evdash.metrics.records import executed_power, vehicle_records
from evdash.metrics.vehicles import charging_kw, plan_history, vehicle_day
from evdash.scheduling.p1 import p1_policy
from tests.builders import make_scenario, vehicle
from tests.charts.test_figures import crowd, named, texts_in

STATUSES = {"charged": "yes", "charging": "yes", "refused": "no", "broken": "broken"}


def one_of(trace: Trace, status: str) -> str:
    return next(r.vehicle for r in vehicle_records(trace) if r.status == status)


def figures_of(trace: Trace, name: str) -> list[dict[str, Any]]:
    ahead, day = outlook(trace), vehicle_day(trace, name)
    shown = [vehicle_figure(day, ahead), fleet_figure(trace, ahead, vehicle_records(trace), name)]
    history = plan_history(trace, name)
    return [*shown, *([history_figure(history, day, ahead)] if history.decided else [])]


@pytest.mark.parametrize("status", ["charged", "charging", "refused"])
def test_figures_are_valid_plain_json_and_deterministic(traces, status) -> None:
    trace = traces["evening"]
    name = one_of(trace, status)
    for figure, again in zip(figures_of(trace, name), figures_of(trace, name), strict=True):
        text = json.dumps(figure, allow_nan=False)
        assert text == json.dumps(again)
        assert len(text) < 60_000
        go.Figure(figure)


def test_the_day_before_it_begins_has_an_empty_chart(traces) -> None:
    trace = traces["start"]
    figure = fleet_figure(trace, outlook(trace), ())
    go.Figure(figure)
    assert "nobody asked yet" in json.dumps(figure)


def test_refused_vehicles_have_their_own_bars_and_words(traces) -> None:
    trace = traces["evening"]
    ahead, records = outlook(trace), vehicle_records(trace)
    figure = fleet_figure(trace, ahead, records)
    refused = [r for r in records if r.status == "refused"]
    assert len(named(figure, "Refused")["y"]) == len(refused) > 0
    assert len(named(figure, "Promised")["y"]) == len(records) - len(refused)
    words = next(t for t in figure["data"] if t.get("mode") == "text")["text"]
    assert [word.endswith("refused") for word in words] == [r.status == "refused" for r in records]
    assert named(figure, "Refused")["marker"]["pattern"]["shape"]  # never colour alone


def test_rows_come_in_the_order_asked_for_and_the_picked_is_framed(traces) -> None:
    trace = traces["evening"]
    records = sorted(vehicle_records(trace), key=lambda r: -r.request.need_kwh)[:10]
    figure = fleet_figure(trace, outlook(trace), records, records[3].vehicle)
    assert figure["layout"]["yaxis"]["ticktext"] == [r.vehicle for r in records]
    frame = figure["layout"]["shapes"][-1]
    assert (frame["y0"], frame["y1"]) == (2.5, 3.5)
    plain = fleet_figure(trace, outlook(trace), records)
    assert len(plain["layout"]["shapes"]) == len(figure["layout"]["shapes"]) - 1


def test_beyond_sixty_a_map_shows_the_same_energy(traces) -> None:
    trace = traces["end"]
    records = vehicle_records(trace)
    assert len(records) > 60
    figure = fleet_figure(trace, outlook(trace), records)
    heat, refused = figure["data"]
    drawn = sum(power or 0.0 for row in heat["z"] for power in row)
    assert drawn == pytest.approx(sum(kw for _, _, kw in executed_power(trace)), abs=0.1)
    assert len(refused["y"]) == 3 * sum(r.status == "refused" for r in records)


def test_two_hundred_vehicles_by_ninety_six_intervals() -> None:
    trace = crowd(200, intervals=96)
    records = vehicle_records(trace)
    figure = fleet_figure(trace, outlook(trace), records, records[7].vehicle)
    rows = len(figure["data"][0]["z"])
    assert rows == 200
    assert 4 <= (figure["layout"]["height"] - 106) / rows <= 5  # pixels a row
    assert len(json.dumps(figure)) < 500_000


def test_the_table_tells_money_energy_and_answer(traces) -> None:
    trace = traces["evening"]
    records = vehicle_records(trace)
    rows = fleet_table(records, charging_kw(trace), STATUSES, outlook(trace))
    assert [row["Vehicle"] for row in rows] == [r.vehicle for r in records]
    assert sum(row["Pays, $"] for row in rows) == pytest.approx(
        sum(r.revenue for r in records), abs=0.3
    )
    now_kw = sum(row["Now, kW"] for row in rows)
    assert now_kw == pytest.approx(trace.steps[-1].station_kw, abs=0.5)
    assert all((row["Why not"] != "") == (row["Answer"] == "no") for row in rows)
    assert f"{len(records)} vehicles" in fleet_alt(records, outlook(trace))


def test_one_vehicles_bars_and_battery_are_its_day(traces) -> None:
    trace = traces["evening"]
    name = one_of(trace, "charging")
    ahead, day = outlook(trace), vehicle_day(trace, name)
    figure = vehicle_figure(day, ahead)
    charged, planned = named(figure, "Charged"), named(figure, "Planned")
    assert sum(charged["y"]) + sum(planned["y"]) == pytest.approx(day.power_kw.sum(), abs=0.01)
    assert all(datetime.fromisoformat(x) < ahead.clock for x in charged["x"])
    battery = named(figure, "Battery")
    assert battery["y"][0] == pytest.approx(100 * day.request.soc_in)
    assert battery["y"][-1] == pytest.approx(100 * day.request.soc_out, abs=1e-3)
    star = figure["data"][-1]
    assert star["y"] == [pytest.approx(100 * day.request.soc_out)]
    assert datetime.fromisoformat(star["x"][0]) == ahead.times[day.request.deadline_interval]
    rows = vehicle_table(day, ahead)
    assert len(rows) == day.request.deadline_interval - day.request.arrival_interval
    assert sum(row["Power, kW"] for row in rows) == pytest.approx(day.power_kw.sum(), abs=0.05)
    assert name in vehicle_alt(day, ahead)


def test_a_promise_changed_on_the_way_is_shown_beside_the_first() -> None:
    one = vehicle("a", need_kwh=12.0, option="C2")
    trace = step(start_day(make_scenario(price=[0.1] * 6, vehicles=[one])), p1_policy())
    leaves = Event(interval=1, event="leaves_early", subject="a", until_interval=2)
    trace = happen(trace, (leaves,))
    figure = vehicle_figure(vehicle_day(trace, "a"), outlook(trace))
    first, since = figure["data"][-2:]
    assert first["name"] == "75 % promised at first by 03:00"
    assert since["x"] == ["2024-05-06T02:00"]
    assert first["marker"]["symbol"] != since["marker"]["symbol"]
    assert "agreed since by 02:00" in since["name"]


def test_a_refused_vehicle_keeps_the_battery_it_came_with(traces) -> None:
    trace = traces["evening"]
    name = one_of(trace, "refused")
    figure = vehicle_figure(vehicle_day(trace, name), outlook(trace))
    assert named(figure, "Charged")["y"] == named(figure, "Planned")["y"] == []
    assert len(set(named(figure, "Battery, not charged here")["y"])) == 1
    assert "refused" in vehicle_alt(vehicle_day(trace, name), outlook(trace))


def test_the_plans_history_is_a_line_a_decision(traces) -> None:
    trace = traces["end"]
    ahead = outlook(trace)
    for record in vehicle_records(trace):
        history = plan_history(trace, record.vehicle)
        if not history.decided:
            continue
        figure = history_figure(history, vehicle_day(trace, record.vehicle), ahead)
        heat = figure["data"][0]
        assert len(heat["z"]) == len(history.decided) == len(history_table(history, ahead))
        marks = named(figure, "Carried out")
        executed = [t for t, who, _ in executed_power(trace) if who == record.vehicle]
        assert len(marks["x"]) == len(executed)
        assert record.vehicle in history_alt(history, ahead)


def test_changes_of_a_plan_are_marked_where_they_are(traces) -> None:
    trace = traces["end"]
    ahead = outlook(trace)
    marked = 0
    for record in vehicle_records(trace):
        history = plan_history(trace, record.vehicle)
        if len(history.decided) < 2:
            continue
        figure = history_figure(history, vehicle_day(trace, record.vehicle), ahead)
        marks = named(figure, "More or less than before")
        marked += len(marks["x"])
        for y, x, symbol in zip(marks["y"], marks["x"], marks["marker"]["symbol"], strict=True):
            t = int((datetime.fromisoformat(x) - ahead.start).total_seconds() // 3600)
            more = history.power_kw[y, t] > history.power_kw[y - 1, t]
            assert symbol == ("triangle-up" if more else "triangle-down")
    assert marked > 0


@pytest.mark.parametrize("name", ["x<b>bold</b>", "a$\\alpha$", "n&amp;"])
def test_names_cannot_become_markup(name) -> None:
    scenario = make_scenario(
        options=[{"name": name, "price_per_kwh": 0.4, "average_kw": 8.0}],
        vehicles=[vehicle(name, option=name), vehicle("b", option=name, max_kw=0.5)],
    )
    trace = run_day(start_day(scenario), p1_policy())
    for vehicle_name in (name, "b"):
        for figure in figures_of(trace, vehicle_name):
            for text in texts_in(figure["data"]) + texts_in(figure["layout"]):
                assert "<b>" not in text
                assert text.count("$") < 2
