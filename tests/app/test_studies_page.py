"""The Studies page without a browser: every question of every scenario, and what a study shows."""

import time
from pathlib import Path

import pytest
from streamlit.testing.v1 import AppTest

from evdash.domain.study import Seeds
from evdash.files.bundled import DEFAULT, bundled_scenarios
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario
from evdash.studies.crew import Crew
from evdash.studies.engine import run_study
from evdash.studies.folder import StudyFolder
from evdash.studies.questions import QUESTIONS
from evdash.studies.reading import lay_out, parse_study
from evdash.studies.shelf import Shelf
from evdash.studies.stand import Stand, read_stand, write_stand
from evdash.ui.studies.ask import read_values
from evdash.ui.studies.words import duration

APP = Path(__file__).parents[2] / "app.py"
OWNER = "a-study-link-of-a-test"
PRESETS = [folder.name for folder in bundled_scenarios()]


@pytest.fixture
def store(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("EVDASH_STORE", str(tmp_path))
    return tmp_path


def opened(preset: str = PRESETS[0], owner: str = "") -> AppTest:
    at = AppTest.from_file(str(APP), default_timeout=120)
    at.query_params["preset"] = preset
    if owner:
        at.query_params["studies"] = owner
    at.run()
    at.switch_page("pages/studies.py").run()
    assert not at.exception
    return at


def told(at: AppTest) -> str:
    parts = [*at.markdown, *at.caption, *at.info, *at.error]
    return "\n".join(element.value for element in parts)


def kept_study(store: Path, name: str, number: int = 1) -> StudyFolder:
    """A small study of a question, done, on the shelf of OWNER."""
    scenario = edit_scenario(
        read_scenario(DEFAULT), {"arrivals.vehicles_per_day": 6.0, "station.chargers": 2}
    )
    study = QUESTIONS[name].study(scenario)
    study = study.model_copy(update={"seeds": Seeds(count=2), "referee_every": 0})
    runs = lay_out(study, scenario)
    folder = StudyFolder(store / "studies" / OWNER / f"{number}")
    folder.begin(runs)
    end = run_study(runs, folder.results, Crew(1))
    write_stand(folder, Stand("done", 0.0, end.total, end.done, end.failed))
    return folder


@pytest.mark.parametrize("preset", PRESETS)
def test_every_question_of_a_scenario_is_ready_to_start(store, preset) -> None:
    at = opened(preset)
    assert "Ask what one day cannot tell" in told(at)
    for name in [*QUESTIONS, "own"]:
        at.selectbox(key="question").set_value(name).run()
        assert not at.exception
        assert not at.error
        assert "about" in told(at)
        assert not at.button(key="start_study").disabled


def test_wrong_values_are_told_and_cannot_be_started(store) -> None:
    at = opened()
    field = next(one for one in at.text_input if one.key.startswith("study_values_chargers"))
    field.set_value("6, many, -1").run()
    assert "found 'many'" in at.error[0].value.replace("\\", "")
    assert "found -1" in at.error[0].value.replace("\\", "")
    assert at.button(key="start_study").disabled
    field = next(one for one in at.text_input if one.key.startswith("study_values_chargers"))
    field.set_value("6, 8").run()
    assert not at.error
    assert "40 runs" in told(at)


def test_the_file_can_be_edited_in_place(store) -> None:
    at = opened()
    area = at.text_area[0]
    study = parse_study(area.value)
    assert study.axis[0].key == "station.chargers"
    area.set_value(area.value.replace("count = 20", "count = 3")).run()
    assert "18 runs" in told(at)
    at.text_area[0].set_value("name = ").run()
    assert "text that is not TOML" in at.error[0].value.replace("\\", "")


def test_start_keeps_the_study_and_begins_one_only(store, monkeypatch) -> None:
    begun = []

    def launch(folder, queue) -> int:
        write_stand(folder, Stand("starting", time.time()))
        begun.append(folder)
        return 0

    monkeypatch.setattr("evdash.studies.waiting.launch", launch)
    at = opened()
    at.button(key="start_study").click().run()
    assert not at.exception
    assert len(begun) == 1
    assert begun[0].read().study.axis[0].key == "station.chargers"
    assert at.button(key="start_study").disabled
    assert "One study at a time" in told(at)
    at.button(key="cancel_study").click().run()
    assert (begun[0].path / "stop").exists()
    owner = at.query_params["studies"]
    owner = owner[0] if isinstance(owner, list) else owner
    assert begun[0].path.parent.name == owner
    again = opened(owner=owner)
    assert "How many chargers" in told(again)
    stranger = opened()
    assert "How many chargers" not in told(stranger)
    assert not stranger.button(key="start_study").disabled


CHARTS = {
    "chargers": 1,
    "transformer": 1,
    "site": 2,
    "upgrade": 1,
    "sure": 1,
}


@pytest.mark.parametrize("name", CHARTS)
def test_a_study_is_drawn_as_what_it_varies_asks_for(store, name) -> None:
    folder = kept_study(store, name)
    at = opened(owner=OWNER)
    charts = at.get("plotly_chart")
    assert len(charts) == CHARTS[name]
    assert "have ended" in told(at)
    metrics = at.selectbox(key="study_metric_1")
    assert len(metrics.options) == len(folder.read().study.metrics)
    for option in ("profit", "least_headroom_kw"):
        at.selectbox(key="study_metric_1").set_value(option).run()
        assert not at.exception
    if name != "sure":
        at.toggle(key="study_paired_1").set_value(True).run()
        assert not at.exception
        assert at.get("plotly_chart")
    keys = [one.key for one in at.get("download_button")]
    assert {"download_runs.csv", "download_study"} <= set(keys)


def test_an_interrupted_study_says_so_and_can_be_resumed(store, monkeypatch) -> None:
    folder = kept_study(store, "upgrade")
    write_stand(folder, Stand("running", 0.0, 10, 4, 0))
    monkeypatch.setattr("evdash.studies.waiting.launch", lambda folder, queue: 0)
    at = opened(owner=OWNER)
    assert not at.button(key="resume_study").disabled
    stand = read_stand(folder)
    assert stand is not None
    assert stand.state == "interrupted"
    at.button(key="resume_study").click().run()
    assert not at.exception


def test_results_of_another_version_are_not_shown(store, monkeypatch) -> None:
    kept_study(store, "upgrade")
    monkeypatch.setattr("evdash.studies.reading.code_of", lambda policy: "another")
    at = opened(owner=OWNER)
    assert "another version" in told(at)
    assert not at.get("plotly_chart")


def test_values_are_read_as_numbers_where_they_are() -> None:
    assert read_values("1, 2.5, 634a, , C1") == (1, 2.5, "634a", "C1")
    assert read_values("") == ()


@pytest.mark.parametrize(
    ("seconds", "words"), [(0.2, "1 s"), (59, "59 s"), (61, "1 minute"), (7200, "2.0 hours")]
)
def test_spans_are_told_as_a_person_says_them(seconds, words) -> None:
    assert duration(seconds) == words


def test_the_next_can_start_where_one_ended_while_the_page_was_drawn(store, monkeypatch) -> None:
    folder = kept_study(store, "upgrade")
    looks = iter([folder])  # on at the first look, ended at each that follows
    monkeypatch.setattr(Shelf, "live", lambda shelf: next(looks, None))
    at = opened(owner=OWNER)
    assert next(looks, None) is None
    assert not at.button(key="start_study").disabled
    assert "One study at a time" not in told(at)
    monkeypatch.setattr(Shelf, "live", lambda shelf: folder)
    at.run()
    assert at.button(key="start_study").disabled
    assert "One study at a time" in told(at)
