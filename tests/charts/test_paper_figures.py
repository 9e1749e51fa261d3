"""The paper's Fig. 3 and its study, drawn from a run and from measured days."""

import json

import plotly.graph_objects as go
import pytest

from evdash.charts.completion import (
    MOST_VEHICLES,
    STEPS,
    chosen,
    completion_alt,
    completion_figure,
    completion_table,
)
from evdash.charts.days import days_alt, days_figure
from evdash.domain.trace import Trace
from evdash.metrics.outlook import outlook
from evdash.studies.days_file import read_days


def test_completion_is_valid_and_every_vehicle_reaches_all_of_it(traces: dict[str, Trace]) -> None:
    trace = traces["end"]
    figure = completion_figure(trace, outlook(trace))
    json.dumps(figure, allow_nan=False)
    go.Figure(figure)
    first, rows = chosen(trace)
    assert len(rows) == MOST_VEHICLES
    for row in rows:
        assert first <= min(row.power_kw) <= max(row.power_kw) < first + STEPS
        told = [
            line["Charged, %"]
            for line in completion_table(trace, outlook(trace))
            if line["Vehicle"] == row.request.vehicle
        ]
        assert told == sorted(told)
        assert told[-1] == pytest.approx(100)
    assert "8 vehicles" in completion_alt(trace)


def test_before_anybody_is_charged_the_chart_says_so(traces: dict[str, Trace]) -> None:
    trace = traces["start"]
    figure = completion_figure(trace, outlook(trace))
    go.Figure(figure)
    assert "Nobody" in figure["layout"]["annotations"][0]["text"]


def test_days_are_drawn_beside_what_was_published() -> None:
    series = {"Measured": [day.seconds for day in read_days().days]}
    figure = days_figure(series, (1.0, 2.0, 3.0))
    go.Figure(json.loads(json.dumps(figure, allow_nan=False)))
    assert len(figure["data"][0]["x"]) == 100
    assert figure["data"][1]["x"] == [1.0, 2.0, 3.0]
    assert "100 days" in days_alt(series)
    assert "No day" in days_figure({"Here": []}, (1, 2, 3))["layout"]["annotations"][0]["text"]
