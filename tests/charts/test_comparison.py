"""Runs over each other: what was executed, and nothing else, told apart by more than colour."""

import json

import numpy as np
import plotly.graph_objects as go
import pytest

from evdash.charts.comparison import (
    QUANTITIES,
    Compared,
    overlay_alt,
    overlay_figure,
    overlay_table,
)
from evdash.domain.trace import Trace
from evdash.files.bundled import PRESETS
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import start_day, step
from evdash.metrics.outlook import outlook
from evdash.metrics.records import interval_records
from evdash.scheduling.p1 import p1_policy


@pytest.fixture(scope="module")
def pair(traces: dict[str, Trace]) -> list[Compared]:
    other = start_day(read_scenario(PRESETS / "winter-weekday"))
    for _ in range(6):
        other = step(other, p1_policy())
    return [
        Compared("<b>summer</b>", traces["evening"], outlook(traces["evening"])),
        Compared("winter", other, outlook(other)),
    ]


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_overlays_are_valid_and_hold_executed_values_only(
    pair: list[Compared], quantity: str
) -> None:
    figure = overlay_figure(pair, quantity)
    json.dumps(figure, allow_nan=False)
    go.Figure(figure)
    assert figure["layout"]["yaxis"]["title"]["text"].endswith(("kW", "$/kWh", "vehicles", "pu"))
    for drawn, run in zip(figure["data"], pair, strict=True):
        assert len(drawn["y"]) == run.trace.now + 1  # the last value is held to its end
    styles = [(line["line"]["color"], line["line"]["dash"]) for line in figure["data"]]
    assert len({colour for colour, _ in styles}) == len({dash for _, dash in styles}) == 2
    assert "<b>" not in figure["data"][0]["name"]


def test_values_are_those_of_the_records(pair: list[Compared]) -> None:
    for run, drawn in zip(pair, overlay_figure(pair, "Station load")["data"], strict=True):
        records = interval_records(run.trace)
        assert drawn["y"][:-1] == pytest.approx([r.station_kw for r in records], abs=1e-6)
    for run, drawn in zip(pair, overlay_figure(pair, "Admitted")["data"], strict=True):
        counts = np.cumsum([record.admitted for record in interval_records(run.trace)])
        assert drawn["y"][:-1] == counts.tolist()


def test_days_of_other_dates_lie_over_each_other(pair: list[Compared]) -> None:
    summer, winter = overlay_figure(pair, "Headroom")["data"]
    assert pair[0].outlook.start.date() != pair[1].outlook.start.date()
    assert summer["x"][: len(winter["x"])] == winter["x"]


def test_the_table_and_the_sentence_say_the_same(pair: list[Compared]) -> None:
    rows = overlay_table(pair, "Station load")
    assert len(rows) == pair[0].trace.now
    assert rows[10]["<b>summer</b>"] == pytest.approx(pair[0].outlook.station_kw[10], abs=1e-4)
    assert rows[10]["winter"] is None
    assert "2 runs" in overlay_alt(pair, "Station load")


def test_runs_that_have_not_begun_say_so(pair: list[Compared]) -> None:
    fresh = start_day(pair[0].trace.scenario)
    run = Compared("fresh", fresh, outlook(fresh))
    for quantity in QUANTITIES:
        figure = overlay_figure([run, run], quantity)
        assert figure["layout"]["annotations"][-1]["text"] == "None of these runs has begun"
        assert "nothing yet" in overlay_alt([run], quantity)
