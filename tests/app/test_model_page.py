"""The Model page without a browser: every section of every preset, the study, the glossary."""

from pathlib import Path

import pytest
from streamlit.testing.v1 import AppTest

from evdash.files.bundled import bundled_scenarios
from evdash.files.scenario_folder import resolved
from evdash.studies.days_file import read_days
from evdash.ui import run as runs
from evdash.ui.glossary import GLOSSARY
from evdash.ui.model import study as studies
from evdash.ui.model.cards import GROUPS
from evdash.ui.model.paper import price_told
from evdash.ui.model.study import KEY as STUDY
from evdash.ui.model.tabs import TABS
from evdash.ui.session import KEY, Session
from evdash.ui.solving import policy

APP = Path(__file__).parents[2] / "app.py"
PRESETS = [folder.name for folder in bundled_scenarios()]
CARDS = [card for cards in GROUPS.values() for card in cards]


def opened(preset: str = PRESETS[0], steps: int = 0) -> AppTest:
    at = AppTest.from_file(str(APP), default_timeout=60)
    at.query_params["preset"] = preset
    at.run()
    run = session(at).run
    for _ in range(steps):
        run = runs.stepped(run, policy)
    session(at).take(run)
    at.switch_page("pages/model.py").run()
    assert not at.exception
    return at


def session(at: AppTest) -> Session:
    found: Session = at.session_state[KEY]
    return found


def tab(at: AppTest, name: str) -> AppTest:
    at.session_state["model_tabs"] = name
    at.run()
    assert not at.exception
    return at


def said(at: AppTest) -> str:
    return "\n".join(text.value for text in [*at.markdown, *at.caption, *at.latex])


@pytest.mark.parametrize("preset", PRESETS)
def test_every_section_of_every_preset_is_shown(preset: str) -> None:
    at = opened(preset, 20)
    for name in TABS:
        tab(at, name)


def test_before_the_first_step_the_equations_stand_alone() -> None:
    at = opened()
    assert "No interval has been decided yet" in at.info[0].value
    assert len(at.latex) == len(CARDS)
    for name in TABS:
        tab(at, name)
    at = tab(at, TABS[0])
    at.button(key="step").click().run()
    assert not at.exception
    assert len(at.latex) > len(CARDS)


def test_every_hour_vehicle_and_node_can_be_put_in() -> None:
    at = opened(steps=21)
    at.select_slider(key="model_hour").set_value("18:00").run()
    for vehicle in at.selectbox(key="model_vehicle").options[::6]:
        name = vehicle.split(" (")[0]
        at.selectbox(key="model_vehicle").set_value(name).run()
        assert not at.exception
        assert name.replace("-", "\\-") in said(at)
    for node in ("634", "675"):
        at.selectbox(key="model_node").set_value(node).run()
        assert not at.exception
        assert f"Node {node} is " in said(at)


def test_the_papers_statements_are_held_against_the_run() -> None:
    at = tab(opened(steps=24), "The paper's figures")
    text = said(at)
    steps = session(at).run.trace.steps
    peak = [step for step in steps if step.start.hour in (18, 19)]
    off = [s for s in steps if s.start.hour in (0, 1, 2, 3, 4, 5, 8, 9, 10, 11, 12, 13)]
    counts = [
        f"{sum(len(s.plan.admitted) for s in some)} of {sum(len(s.requests) for s in some)}"
        for some in (off, peak)
    ]
    assert f"{counts[0]} who asked were admitted, in its peak hours" in text
    assert f"(18:00–20:00) {counts[1]}." in text
    assert "51 vehicles whose time is up 51 got all" in text
    assert len(at.get("plotly_chart")) == 3


def test_the_study_shows_what_was_measured_and_runs_here_until_cancelled(monkeypatch) -> None:
    monkeypatch.setattr(studies, "DAYS", 3)
    at = tab(opened(), "A hundred days")
    measured = read_days()
    assert len(measured.days) == 100
    assert measured.machine["processor"] in said(at).replace("\\", "")
    assert "16.8" in said(at)
    at.button(key="run_study").click().run()
    assert not at.exception
    days = at.session_state[STUDY].days
    assert [day.seed for day in days] == [1, 2, 3]
    assert [(d.arrived, d.admitted) for d in days] == [
        (d.arrived, d.admitted) for d in measured.days[:3]
    ]
    assert at.button(key="run_study").disabled
    session(at).edit("chargers", {"station.chargers": 5})
    at.run()
    assert at.session_state[STUDY].days == ()


def test_a_list_of_vehicles_has_no_other_days() -> None:
    at = opened()
    trace = session(at).run.trace
    session(at).take(runs.open_run(None, resolved(trace.scenario, trace.inputs.arrivals)))
    tab(at, "A hundred days")
    assert at.button(key="run_study").disabled
    assert "one day only" in said(at)


def test_the_glossary_finds_words() -> None:
    at = tab(opened(), "Glossary")
    assert all(term.split(" ")[0].rstrip(",") in said(at) for term in GLOSSARY)
    at.text_input(key="glossary_search").set_value("headroom").run()
    assert "**Headroom**" in said(at)
    assert "**Seed**" not in said(at)
    at.text_input(key="glossary_search").set_value("*zzz*").run()
    assert "No word here" in said(at)


@pytest.mark.parametrize(
    ("paid", "mean", "side"),
    [(0.02, 0.03, "below"), (0.03, 0.02, "above"), (0.1, 0.1 + 1e-12, "the same as")],
)
def test_a_price_is_told_as_it_lies_beside_the_mean(paid: float, mean: float, side: str) -> None:
    assert f"on average, {side} the mean price" in price_told(paid, mean)
