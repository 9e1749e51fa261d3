"""The Scenario page without a browser: edit, take files in, begin a day, hand out."""

import io
from pathlib import Path
from typing import Any

import pytest
from streamlit.testing.v1 import AppTest

from evdash.files.bundled import DEFAULT, bundled_scenarios
from evdash.files.draft import draft_of, files_of, read_draft, scenario_of, zipped
from evdash.files.folder import read_zip
from evdash.files.numbers import number_text
from evdash.files.scenario_folder import read_scenario, scenario_files
from evdash.imports.scenario_book import scenario_workbook
from evdash.ui import run as runs
from evdash.ui.scenario.editor import KEY as DRAFT
from evdash.ui.scenario.editor import MOST_ROWS, Editor
from evdash.ui.scenario.form import TABS
from evdash.ui.scenario.sources import receive
from evdash.ui.session import KEY, Session
from evdash.ui.solving import policy

APP = Path(__file__).parents[2] / "app.py"
PRESETS = [folder.name for folder in bundled_scenarios()]


def opened(preset: str = PRESETS[0], steps: int = 0) -> AppTest:
    at = AppTest.from_file(str(APP), default_timeout=60)
    at.query_params["preset"] = preset
    at.run()
    for _ in range(steps):
        session(at).run = runs.stepped(session(at).run, policy)
    at.switch_page("pages/scenario.py").run()
    assert not at.exception
    return at


def session(at: AppTest) -> Session:
    found: Session = at.session_state[KEY]
    return found


def editor(at: AppTest) -> Editor:
    found: Editor = at.session_state[DRAFT]
    return found


def tab(at: AppTest, name: str) -> AppTest:
    at.session_state["scenario_tabs"] = name
    at.run()
    assert not at.exception
    return at


def press(at: AppTest, key: str) -> AppTest:
    at.button(key=key).click().run()
    assert not at.exception
    return at


def upload(at: AppTest, **files: Any) -> AppTest:
    receive(editor(at), files)
    at.run()
    assert not at.exception
    return at


@pytest.mark.parametrize("preset", PRESETS)
def test_every_section_of_every_preset_is_shown_and_changes_nothing(preset: str) -> None:
    at = opened(preset)
    for name in TABS:
        tab(at, name)
    assert not at.error
    assert not editor(at).is_edited
    assert editor(at).check()[0] == read_scenario(DEFAULT.parent / preset)


NUMBERS = [
    ("Day and station", "interval_minutes", 30),
    ("Day and station", "intervals", 20),
    ("Day and station", "arrivals_until", 20),
    ("Day and station", "station.chargers", 7),
    ("Day and station", "station.min_kw", 2.0),
    ("Day and station", "station.max_kw", 22.0),
    ("Day and station", "station.efficiency", 0.95),
    ("Feeder", "feeder.source_voltage_pu", 1.01),
    ("Feeder", "feeder.voltage_min_pu", 0.95),
    ("Feeder", "feeder.voltage_max_pu", 1.05),
    ("Feeder", "feeder.base_mva", 10.0),
    ("Feeder", "feeder.base_kv", 4.8),
    ("Feeder", "feeder.load_scale", 1.1),
    ("Feeder", "feeder.power_factor", 0.95),
    ("Vehicles", "arrivals.seed", 9),
    ("Vehicles", "arrivals.vehicles_per_day", 50.0),
    ("Vehicles", "arrivals.soc_out.0", 0.7),
    ("Vehicles", "arrivals.soc_in_beta.1", 2.0),
]


@pytest.mark.parametrize(("section", "key", "value"), NUMBERS)
def test_every_number_is_edited_by_its_key(section: str, key: str, value: float) -> None:
    at = tab(opened(), section)
    at.text_input(key=f"scenario:{key}").set_value(number_text(value)).run()
    assert not at.exception
    *path, last = key.split(".")
    if last.isdigit():
        assert editor(at).get(tuple(path))[int(last)] == value
    else:
        assert editor(at).get((*path, last)) == value
    assert editor(at).is_edited
    tab(at, "As text")
    tab(at, section)
    assert at.text_input(key=f"scenario:{key}").value == number_text(value)


@pytest.mark.parametrize(("key", "value"), [("name", "Mine"), ("start", "2021-01-01T06:00")])
def test_texts_are_edited_by_their_key(key: str, value: str) -> None:
    at = opened()
    at.text_input(key=f"scenario:{key}").set_value(value).run()
    assert files_of(editor(at).draft)["scenario.toml"].count(f'"{value}"') == 1
    assert not at.error


def test_faults_are_told_all_at_once_and_work_is_kept() -> None:
    at = opened()
    at.text_input(key="scenario:station.chargers").set_value("-4").run()
    at.text_input(key="scenario:interval_minutes").set_value("7").run()
    at.text_input(key="scenario:start").set_value("tomorrow").run()
    assert "3 faults" in at.error[0].value
    shown = at.dataframe[0].value
    assert list(shown.columns) == ["Where", "Found", "Allowed"]
    assert {"scenario.toml, station.chargers", "scenario.toml, start"} <= set(shown["Where"])
    assert at.button(key="apply_scenario").disabled
    assert at.text_input(key="scenario:station.chargers").value == "-4"
    at.switch_page("pages/live.py").run()
    at.switch_page("pages/scenario.py").run()
    assert at.text_input(key="scenario:station.chargers").value == "-4"
    assert "3 faults" in at.error[0].value


def test_a_new_day_begins_on_it_after_saying_what_is_dropped() -> None:
    at = opened(steps=3)
    at.text_input(key="scenario:station.chargers").set_value("8").run()
    assert any("drops the 3 intervals" in caption.value for caption in at.caption)
    press(at, "apply_scenario")
    run = session(at).run
    assert (run.trace.now, run.trace.scenario.station.chargers) == (0, 8)
    assert run.folder is None
    assert "A new day has begun" in at.success[0].value
    assert "preset" not in at.query_params
    at.switch_page("pages/live.py").run()
    assert not at.exception
    assert at.text_input(key="station.chargers").value == "8"
    at.selectbox(key="preset").set_value(PRESETS[1]).run()
    assert not at.exception
    assert session(at).run.folder.name == PRESETS[1]


def test_a_scenario_of_ones_own_is_told_apart_from_the_preset_of_its_name() -> None:
    at = opened()
    at.text_input(key="scenario:station.chargers").set_value("7").run()
    press(at, "apply_scenario")
    at.switch_page("pages/live.py").run()
    labels = at.selectbox(key="preset").options
    assert len(set(labels)) == len(labels) == len(PRESETS) + 1
    press(at, "step")
    assert session(at).run.trace.scenario.station.chargers == 7
    assert session(at).run.folder is None


def test_an_untouched_draft_follows_the_present_run_and_an_edited_one_does_not() -> None:
    at = opened()
    session(at).edit("chargers", {"station.chargers": 5})
    at.run()
    assert at.text_input(key="scenario:station.chargers").value == "5"
    at.text_input(key="scenario:station.min_kw").set_value("1.5").run()
    session(at).edit("chargers", {"station.chargers": 4})
    at.run()
    assert at.text_input(key="scenario:station.chargers").value == "5"


def test_presets_are_taken_and_undone() -> None:
    at = opened()
    at.text_input(key="scenario:station.chargers").set_value("5").run()
    at.selectbox(key="scenario_from").set_value("voltage-limited").run()
    press(at, "take_scenario")
    assert at.text_input(key="scenario:station.chargers").value == "140"
    press(at, "undo_scenario")
    assert at.text_input(key="scenario:station.chargers").value == "5"


def test_a_zip_taken_in_is_the_scenario_it_was_made_from() -> None:
    at = opened()
    other = read_scenario(DEFAULT.parent / "voltage-limited")
    upload(at, **{"other.zip": zipped(scenario_files(other))})
    assert editor(at).check()[0] == other
    assert "replaced the whole scenario" in at.success[0].value
    press(at, "apply_scenario")
    assert session(at).run.opened == other


def test_a_single_table_replaces_its_own_and_its_faults_are_told_by_row() -> None:
    at = opened()
    text = scenario_files(read_scenario(DEFAULT))["lines.csv"].replace("0.07044192", "lots", 1)
    upload(at, **{"lines (2).csv": text.encode()})
    assert "lines.csv: 12 rows" in at.success[0].value.replace("\\", "")
    assert "lines.csv, row 2, column r_ohm" in set(at.dataframe[0].value["Where"])
    for name in TABS:
        tab(at, name)  # a number that is none is shown as text, to be mended in place
    editor(at).undo()
    at.run()
    assert not at.error


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("nodes.csv", b"node\n\xff"),
        ("nodes.csv", b"colour\nred\n"),
        ("unknown.csv", b"colour\nred\n"),
        ("scenario.toml", b"= = ="),
        ("day.zip", b"not a zip"),
        ("day.zip", zipped({"else.txt": "x"})),
        ("day.zip", zipped({"../evil.csv": "x", "scenario.toml": "x"})),
    ],
)
def test_files_that_have_no_place_are_refused_and_nothing_is_lost(name, content) -> None:
    at = opened()
    at.text_input(key="scenario:station.chargers").set_value("5").run()
    before = editor(at).draft
    upload(at, **{name: content})
    assert "your work is as it was" in at.error[0].value
    assert len(at.dataframe[0].value) >= 1
    assert editor(at).draft is before


def test_a_toml_whose_form_cannot_be_shown_is_told_and_can_be_mended_as_text() -> None:
    at = opened()
    text = scenario_files(read_scenario(DEFAULT))["scenario.toml"]
    spoilt = text.replace("[arrivals]", "[arrival]").replace("chargers = 12", 'chargers = "many"')
    upload(at, **{"scenario.toml": spoilt.encode()})
    assert "fault" in at.error[0].value
    for name in TABS:
        tab(at, name)
    at.text_area(key="scenario:text").set_value(text).run()
    assert not at.error
    at.text_area(key="scenario:text").set_value("not = = toml").run()
    assert "not taken over yet" in at.error[0].value
    assert at.text_area(key="scenario:text").value == "not = = toml"


def test_vehicles_become_a_list_and_are_drawn_again() -> None:
    at = tab(opened(), "Vehicles")
    original = editor(at).check()[0]
    at.segmented_control(key="scenario:kind").set_value(True).run()
    assert not at.exception
    assert len(editor(at).check()[0].arrivals.vehicles) == 99
    at.segmented_control(key="scenario:kind").set_value(False).run()
    assert editor(at).check()[0] == original


def test_what_would_hang_the_app_is_refused() -> None:
    at = tab(opened(), "Vehicles")
    key = "scenario:arrivals.vehicles_per_day"
    at.text_input(key=key).set_value("1000000").run()
    assert "should be at most" in at.dataframe[0].value["Allowed"][0]
    row = editor(at).draft.tables["fleet.csv"][0]
    editor(at).set_rows("fleet.csv", (row,) * (MOST_ROWS + 1))
    at.run()
    assert any("too many to edit" in warning.value for warning in at.warning)


def test_cells_of_tables_are_the_rows_as_typed_and_faults_of_the_draft() -> None:
    at = tab(opened(), "Feeder")
    rows = editor(at).draft.tables["nodes.csv"]
    key = next(k for k in editor(at).laid if k.startswith("table:nodes.csv"))
    lay = editor(at).laid[key]
    lay({})
    assert editor(at).draft.tables["nodes.csv"] == rows
    lay({"edited_rows": {1: {"load_kw": "1,5"}}, "added_rows": [{"node": "x"}, {}]})
    typed = editor(at).draft.tables["nodes.csv"]
    assert typed[1] == rows[1] | {"load_kw": "1,5"}
    assert typed[2:] == (*rows[2:], dict.fromkeys(rows[0], "") | {"node": "x"})
    at.run()
    told = at.dataframe[0].value
    assert told["Found"][0] == "'1,5'"
    assert told["Allowed"][0].startswith("should be a number, with a point and no commas: 1.5")
    lay({"deleted_rows": [0]})
    assert editor(at).draft.tables["nodes.csv"] == rows[1:]


def test_the_download_is_what_would_be_applied() -> None:
    at = opened()
    at.text_input(key="scenario:station.chargers").set_value("8").run()
    scenario = editor(at).check()[0]
    packed = zipped(scenario_files(scenario), "x")
    assert scenario_of(read_draft(read_zip(io.BytesIO(packed), "x.zip"))) == scenario
    assert draft_of(scenario) == editor(at).draft


def test_a_workbook_replaces_the_sheets_it_has() -> None:
    at = opened()
    other = read_scenario(DEFAULT.parent / "voltage-limited")
    upload(at, **{"mine.xlsx": scenario_workbook(draft_of(other))})
    assert editor(at).check()[0] == other
    spoilt = draft_of(other)
    rows = spoilt.tables["nodes.csv"]
    spoilt = spoilt.with_table("nodes.csv", (*rows[:3], rows[3] | {"load_kw": "lots"}, *rows[4:]))
    upload(at, **{"mine.xlsx": scenario_workbook(spoilt)})
    where = "mine.xlsx, sheet nodes, row 5, column load_kw"
    assert where in set(at.dataframe[0].value["Where"])
    editor(at).set_rows("nodes.csv", editor(at).draft.tables["nodes.csv"][:-1])
    at.run()
    assert "nodes.csv, row 5, column load_kw" in set(at.dataframe[0].value["Where"])
    for name, content in (("x.xlsx", b"PK no"), ("x.json", b"["), ("x.json", b"[]")):
        upload(at, **{name: content})
        assert "your work is as it was" in at.error[0].value
