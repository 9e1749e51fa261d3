"""The Live page without a browser: every preset, every control."""

import threading
import time
from pathlib import Path
from typing import Any

import pytest
from streamlit.testing.v1 import AppTest

from evdash.domain.trace import Trace
from evdash.explain.refusals import explain_vehicle
from evdash.files.bundled import bundled_scenarios
from evdash.files.numbers import number_text
from evdash.ui.live import decision
from evdash.ui.reasons import told_revision, told_worths
from evdash.ui.session import KEY, Session
from evdash.ui.words import plain

APP = Path(__file__).parents[2] / "app.py"
WAITING = "Being found out"
PRESETS = [folder.name for folder in bundled_scenarios()]


def opened(preset: str = PRESETS[0], steps: int = 0) -> AppTest:
    at = AppTest.from_file(str(APP), default_timeout=60)
    at.query_params["preset"] = preset
    at.run()
    return clicked(at, "step", steps)


def clicked(at: AppTest, button: str, times: int = 1) -> AppTest:
    for _ in range(times):
        at.button(key=button).click().run()
        assert not at.exception
    return at


def session(at: AppTest) -> Session:
    found: Session = at.session_state[KEY]
    return found


def now(at: AppTest) -> int:
    return session(at).run.trace.now


def figures(at: AppTest) -> dict[str, Any]:
    return {chart.proto.id.split("-")[-1]: chart.proto.spec for chart in at.get("plotly_chart")}


def edit(at: AppTest, key: str, value: float) -> AppTest:
    at.text_input(key=key).set_value(number_text(value)).run()
    assert not at.exception
    return at


@pytest.mark.parametrize("preset", PRESETS)
def test_every_preset_runs_to_its_end(preset: str) -> None:
    at = opened(preset)
    assert not at.exception
    assert len(figures(at)) == 4
    clicked(at, "step", 2)
    assert now(at) == 2
    clicked(at, "finish")
    assert session(at).run.trace.is_over
    assert any("The day is over" in text.value for text in at.markdown)
    assert at.button(key="step").disabled
    at.toggle(key="in_units").set_value(True).run()
    assert not at.exception


def test_every_step_changes_every_chart() -> None:
    at = opened(steps=14)
    before = figures(at)
    clicked(at, "step")
    after = figures(at)
    assert before.keys() == after.keys()
    assert all(before[name] != after[name] for name in before)


def test_a_run_that_changes_nothing_draws_nothing_anew() -> None:
    at = opened(steps=3)
    before = figures(at)
    at.run()
    assert figures(at) == before


def test_back_and_reset() -> None:
    at = opened(steps=3)
    clicked(at, "back")
    assert now(at) == 2
    clicked(at, "reset")
    assert now(at) == 0
    assert at.button(key="back").disabled


def test_play_steps_and_pause_stops_it() -> None:
    at = opened()
    clicked(at, "play")
    assert session(at).mode == "playing"
    assert now(at) >= 1
    clicked(at, "play")
    assert session(at).mode == "idle"


@pytest.mark.parametrize(
    ("key", "value", "read"),
    [
        ("station.chargers", 7, lambda s: s.station.chargers),
        ("arrivals.seed", 5, lambda s: s.arrivals.seed),
        ("arrivals.vehicles_per_day", 40.0, lambda s: s.arrivals.vehicles_per_day),
        ("option.C1.price_per_kwh", 0.5, lambda s: s.option[0].price_per_kwh),
        ("option.C1.average_kw", 8.0, lambda s: s.option[0].average_kw),
        ("option.C2.price_per_kwh", 0.2, lambda s: s.option[1].price_per_kwh),
        ("option.C2.average_kw", 4.0, lambda s: s.option[1].average_kw),
    ],
)
@pytest.mark.parametrize("steps", [0, 6])
def test_each_control_changes_the_scenario_from_now_on(key, value, read, steps) -> None:
    at = opened(steps=steps)
    past = session(at).run.trace.steps
    edit(at, key, value)
    run = session(at).run
    assert read(run.trace.scenario) == value
    assert read(run.opened) != value
    assert run.trace.steps == past
    assert at.text_input(key=key).value == number_text(value)
    assert any("Changed from the preset" in caption.value for caption in at.caption)
    clicked(at, "restore")
    assert read(session(at).run.trace.scenario) == read(run.opened)
    assert at.text_input(key=key).value == number_text(read(run.opened))


def test_an_impossible_edit_is_answered_and_the_widget_returns_to_the_truth() -> None:
    at = opened(steps=18)
    before = session(at).run.trace
    edit(at, "station.chargers", 0)
    assert session(at).run.trace is before
    assert at.text_input(key="station.chargers").value == "12"
    assert "would break" in at.error[0].value
    assert list(at.dataframe[0].value.columns) == ["Vehicle", "Missing, kWh"]
    at.run()
    assert at.error  # it stays until the next change
    clicked(at, "step")
    assert not at.error


def test_a_wrong_edit_is_answered_with_its_faults() -> None:
    at = opened(steps=2)
    edit(at, "option.C1.average_kw", 50.0)
    assert "max\\_kw" in at.error[0].value
    assert at.text_input(key="option.C1.average_kw").value == "9.6"


@pytest.mark.parametrize("steps", [0, 10])
def test_price_curves_take_effect_from_now_on(steps: int) -> None:
    at = opened(steps=steps)
    before = session(at).run.trace.scenario.price_per_kwh
    at.segmented_control(key="price_curve").set_value("Spike").run()
    after = session(at).run.trace.scenario.price_per_kwh
    assert (before[:steps] == after[:steps]).all()
    assert after[15] > 0.9
    assert at.segmented_control(key="price_curve").value == "Spike"
    at.segmented_control(key="price_curve").set_value("Negative").run()
    assert session(at).run.trace.scenario.price_per_kwh[12] < 0
    at.segmented_control(key="price_curve").set_value("Ordinary").run()
    assert (session(at).run.trace.scenario.price_per_kwh == before).all()


def test_another_preset_begins_another_day() -> None:
    at = opened(steps=3)
    edit(at, "station.chargers", 7)
    at.selectbox(key="preset").set_value("voltage-limited").run()
    assert not at.exception
    assert now(at) == 0
    assert at.text_input(key="station.chargers").value == "140"
    assert at.run().query_params["preset"] == "voltage-limited"


def test_tables_open_under_their_charts() -> None:
    at = opened(steps=15)
    shown = len(at.dataframe)
    for name in ("schedule", "admissions", "load", "voltages"):
        at.session_state[f"table_{name}"] = True
    at.run()
    assert not at.exception
    assert len(at.dataframe) == shown + 4


def test_an_unknown_preset_in_the_address_is_passed_over() -> None:
    at = opened("../../etc")
    assert not at.exception
    assert session(at).run.folder.name == PRESETS[0]


def test_the_network_model_is_switched_and_told() -> None:
    at = opened(steps=17)
    linear = session(at).run.trace.inputs.rows.headroom_kw()
    at.segmented_control(key="network").set_value("ac").run()
    assert not at.exception
    inputs = session(at).run.trace.inputs
    assert inputs.network == "ac"
    assert (inputs.rows.headroom_kw() < linear).all()
    assert any("from 17:00" in text.value and "Full AC" in text.value for text in at.caption)
    clicked(at, "step")
    assert session(at).run.trace.steps[-1].inputs.network == "ac"
    clicked(at, "back", 2)
    assert session(at).run.trace.inputs.network == "lindistflow"


def test_a_refusal_that_is_picked_is_explained() -> None:
    at = opened(steps=19)
    trace = session(at).run.trace
    refused = [refusal.vehicle for refusal in trace.steps[-1].plan.refused]
    picker = at.selectbox(key="why")
    assert picker.value is None
    assert list(picker.options)[: len(refused)] == refused
    picker.set_value(refused[0]).run()
    assert not at.exception
    told = explain_vehicle(trace, refused[0])
    shown = found_out(at)
    assert plain(told.detail) in shown
    assert plain(told.remedy) in shown
    clicked(at, "step", 5)
    assert at.selectbox(key="why").value == refused[0]


def test_no_step_waits_for_an_explanation(monkeypatch: pytest.MonkeyPatch) -> None:
    at, go_on = opened(steps=19), threading.Event()
    refused = session(at).run.trace.steps[-1].plan.refused[0].vehicle

    def slowly(trace: Trace, vehicle: str) -> list[str]:
        go_on.wait(600)
        return [f"{vehicle} explained at last."]

    monkeypatch.setattr(decision, "told_why", slowly)
    at.selectbox(key="why").set_value(refused).run()
    assert any(WAITING in text.value for text in at.markdown)
    clicked(at, "step", 2)
    assert now(at) == 21
    go_on.set()
    assert f"{refused} explained at last." in found_out(at)


def test_voltages_are_shown_three_ways() -> None:
    at = opened(steps=19)
    shown = set()
    for way in ("With charging", "Without", "Difference"):
        at.segmented_control(key="voltage_way").set_value(way).run()
        assert not at.exception
        shown.add(figures(at)["chart_voltages"])
    assert len(shown) == 3


def test_what_changed_and_what_more_is_worth_are_told_when_opened() -> None:
    at = opened(steps=19)
    trace = session(at).run.trace
    assert told_revision(trace)[0] in set(opened_texts(at, "told_revision"))
    clicked(at, "finish")
    told = told_worths(session(at).run.trace)
    assert len(told) == 3
    assert set(told) <= set(opened_texts(at, "told_worth"))


def opened_texts(at: AppTest, key: str) -> list[str]:
    """All paragraphs of the page after a box has been opened."""
    at.session_state[key] = True
    at.run()
    assert not at.exception
    return found_out(at)


def found_out(at: AppTest) -> list[str]:
    """All paragraphs of the page once nothing is being found out any more."""
    until = time.monotonic() + 120
    while any(WAITING in text.value for text in at.markdown) and time.monotonic() < until:
        time.sleep(0.1)
        at.run()
        assert not at.exception
    return [text.value for text in at.markdown]
