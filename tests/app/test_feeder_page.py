"""The Feeder page without a browser: every preset, every hour, every way to look at it."""

import time
from typing import Any

import pytest
from streamlit.testing.v1 import AppTest

from evdash.ui import run as runs
from evdash.ui.reasons import told_binding, told_worths
from tests.app.test_live_page import PRESETS, clicked, figures, opened, opened_texts, session

PAGE = "pages/feeder.py"
CHARTS = {"chart_feeder", "chart_voltage_map", "chart_headroom", "chart_ac_gap"}


def feeder_page(preset: str = PRESETS[0], steps: int = 0) -> AppTest:
    at = opened(preset)
    at.switch_page(PAGE).run()
    assert not at.exception
    return clicked(at, "step", steps)


def texts(at: AppTest) -> str:
    return "\n".join(text.value for text in at.markdown)


def move(at: AppTest, hour: int) -> AppTest:
    at.select_slider[0].set_value(hour).run()
    assert not at.exception
    return at


def told(at: AppTest, words: str, seconds: float = 40.0) -> bool:
    until = time.monotonic() + seconds
    while words not in texts(at) and time.monotonic() < until:
        time.sleep(0.2)
        at.run()
        assert not at.exception
    return words in texts(at)


def changed(before: dict[str, Any], after: dict[str, Any]) -> set[str]:
    assert before.keys() == after.keys()
    return {name for name in before if before[name] != after[name]}


@pytest.mark.parametrize("preset", PRESETS)
def test_every_preset_from_start_to_end(preset: str) -> None:
    at = feeder_page(preset)
    assert set(figures(at)) == CHARTS
    assert "AC power flow checks each interval once it is over" in texts(at)
    clicked(at, "finish")
    assert session(at).run.trace.is_over
    last = session(at).run.trace.scenario.intervals - 1
    assert at.select_slider[0].value == last
    for hour in (0, last // 2, last):
        move(at, hour)
    for way in ("without", "difference"):
        at.segmented_control(key="feeder_way").set_value(way).run()
        at.segmented_control(key="map_way").set_value(way).run()
        assert not at.exception


@pytest.mark.parametrize("preset", PRESETS)
def test_every_hour_of_every_preset_in_ac(preset: str) -> None:
    """In AC one element an hour has room that is known, and in some hours another than in most."""
    at = feeder_page(preset)
    session(at).take(runs.rewired(session(at).run, "ac"))
    at.run()
    for _ in range(2):
        at = clicked(at, "step")
    ahead = session(at).run.trace
    binding = ahead.inputs.rows.binding()
    for element in dict.fromkeys(binding):
        move(at, binding.index(element))
        assert "Tightest limits" in texts(at)
    move(at, ahead.scenario.intervals - 1)


def test_moving_the_hour_redraws_the_drawing_alone() -> None:
    at = feeder_page(steps=6)
    before = figures(at)
    after = figures(move(at, 18))
    assert changed(before, after) == {"chart_feeder"}
    assert "planned to draw" in texts(at)
    assert "18:00–19:00" in texts(at)


def test_the_hour_follows_the_clock() -> None:
    at = feeder_page(steps=2)
    move(at, 12)
    at.run()
    assert at.select_slider[0].value == 12
    clicked(at, "step")
    assert at.select_slider[0].value == 2


@pytest.mark.parametrize("key", ["feeder_way", "map_way"])
def test_each_way_of_looking_changes_its_own_chart(key: str) -> None:
    at = clicked(feeder_page(), "finish")
    before = figures(at)
    chart = {"feeder_way": "chart_feeder", "map_way": "chart_voltage_map"}[key]
    for way in ("without", "difference"):
        at.segmented_control(key=key).set_value(way).run()
        assert not at.exception
        assert changed(before, figures(at)) == {chart}


def test_violations_of_the_station_in_ac_are_told_in_red() -> None:
    at = clicked(feeder_page("voltage-limited"), "finish")
    assert told(at, "By AC power flow, charging exceeds 8 limits")
    assert told(at, "pu apart")
    rows = next(f.value for f in at.dataframe if "Cause" in f.value)
    assert "AC" in set(rows["Model"])
    assert {"charging", "feeder and charging"} >= set(rows["Cause"])


def test_a_table_stands_under_every_chart() -> None:
    at = feeder_page(steps=3)
    assert len([box for box in at.expander if "table" in box.label]) == 5


def test_what_binds_and_what_more_is_worth_are_told_when_opened() -> None:
    at = feeder_page(steps=12)
    trace = session(at).run.trace
    assert set(told_binding(trace)) <= set(opened_texts(at, "told_binding"))
    assert "told_worth" not in [box.key for box in at.expander]
    clicked(at, "finish")
    told_after = told_worths(session(at).run.trace)
    assert len(told_after) == 3
    assert set(told_after) <= set(opened_texts(at, "told_worth"))
