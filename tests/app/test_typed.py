"""Typed numbers on every page: read or refused in words; a click right after counts them."""

import ast
from collections.abc import Callable
from pathlib import Path

import pytest
from streamlit.testing.v1 import AppTest

from evdash.files.numbers import read_number
from evdash.studies.stand import Stand, write_stand
from evdash.ui.apart import NOT_TAKEN
from evdash.ui.events.choices import CHOICES
from evdash.ui.scenario.form import TABS
from evdash.ui.studies.ask import read_values
from tests.app import test_scenario_page as scenario_page
from tests.app import test_studies_page as studies_page
from tests.app.test_live_page import clicked, now, opened, session
from tests.app.test_scenario_imports import MONTH, hourly
from tests.app.test_scenario_page import editor, tab, upload

ROOT = Path(__file__).parents[2]
SEVERAL = "separated by commas"
FORMS = ("4,5", "0,3", "1.234,5", "1,234", "5 kW", "1 000", "4.5.6", "-")


def calls(name: str) -> list[tuple[str, ast.Call]]:
    """Where a function of Streamlit's is called by the app."""
    files = [*(ROOT / "evdash/ui").rglob("*.py"), *(ROOT / "pages").glob("*.py"), ROOT / "app.py"]
    return [
        (file.relative_to(ROOT).as_posix(), node)
        for file in files
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr == name
    ]


def test_no_number_is_left_to_what_reinterprets_it_in_the_browser() -> None:
    assert not calls("number_input")
    edited = {file for file, _ in calls("data_editor")}
    assert edited == {"evdash/ui/scenario/tables.py", "evdash/ui/live/prices.py"}
    numbers = {file for file, _ in calls("NumberColumn")}
    assert numbers == {"evdash/ui/vehicles/listing.py"}, "read, never edited"


def told(at: AppTest) -> str:
    return "\n".join(str(one.value) for one in (*at.markdown, *at.error)).replace("\\", "")


def is_number(text: str) -> bool:
    try:
        read_number(text)
    except ValueError:
        return False
    return True


def refuses(at: AppTest, least: int) -> None:
    """Every field that shows a number refuses what is none, keeps it, and says so."""
    fields = [f.key for f in at.text_input if is_number(f.value) and SEVERAL not in f.label]
    assert len(fields) >= least
    for n, key in enumerate(fields):
        before, typed = at.text_input(key=key).value, FORMS[n % len(FORMS)]
        at.text_input(key=key).set_value(typed).run()
        assert not at.exception
        assert at.text_input(key=key).value == typed
        assert f"Found '{typed}'" in told(at), key
        at.text_input(key=key).set_value(before).run()
        assert f"Found '{typed}'" not in told(at), key


@pytest.mark.parametrize("form", FORMS)
def test_a_setting_that_is_no_number_is_kept_and_the_old_value_stays_in_force(form: str) -> None:
    at = opened(steps=1)
    for key in ("station.chargers", "option.C1.price_per_kwh"):
        before = session(at).run
        held = at.text_input(key=key).value
        at.text_input(key=key).set_value(form).run()
        assert session(at).run is before
        assert at.text_input(key=key).value == form
        assert f"Found '{form}'" in told(at)
        assert f"stays {held}." in told(at)
    clicked(at, "step")
    assert now(at) == 2, "said before, so that the day goes on with what is in force"
    assert at.text_input(key="station.chargers").value == form


def test_every_field_of_the_live_page_refuses() -> None:
    at = opened(steps=18)
    refuses(at, 7)
    at.session_state["events"] = True
    at.run()
    for kind in CHOICES:
        at.selectbox(key="event_kind").select(kind).run()
        refuses(at, 7)


def test_what_cannot_be_read_does_not_happen() -> None:
    at = opened(steps=18)
    at.session_state["events"] = True
    at.run()
    at.selectbox(key="event_kind").select("chargers_fail").run()
    at.text_input(key="event_count").set_value("1,5")
    clicked(at, "event_ask")
    assert "That cannot happen" in told(at)
    assert "should be a whole number" in told(at)
    at.text_input(key="event_count").set_value("2")
    clicked(at, "event_ask")
    assert "2 of the chargers stop working" in "".join(str(one.value) for one in at.info)


@pytest.mark.parametrize("name", TABS[:4])
def test_every_field_of_the_scenario_page_refuses(name: str) -> None:
    at = tab(scenario_page.opened(), name)
    refuses(at, 0 if name == "Prices and loads" else 6)


@pytest.mark.parametrize("content", [MONTH.encode(), hourly("2024-05-06", "load")])
def test_the_own_table_forms_refuse(content: bytes) -> None:
    at = upload(scenario_page.opened(), **{"mine.csv": content})
    for box in (box for box in at.selectbox if box.label == "Unit of load"):
        box.set_value("kW").run()
    fields = [f.key for f in at.text_input if f.key.startswith("table:1") and ":zone" not in f.key]
    assert fields
    before = editor(at).draft
    for key in fields:
        at.text_input(key=key).set_value("1,5")
        at.button(key=CONFIRM[len(fields) > 1]).click().run()
        assert not at.exception
        assert editor(at).draft is before
        assert "Nothing was taken in; your work is as it was" in told(at)
        assert "Found '1,5'" in told(at)
        at.text_input(key=key).set_value("").run()


CONFIRM = {False: "confirm_sessions", True: "confirm_profile"}


def test_a_study_refuses_its_days_and_values_with_glued_commas() -> None:
    at = studies_page.opened()
    refuses(at, 1)
    at.text_input(key="study_days_chargers").set_value("4,5").run()
    assert at.button(key="start_study").disabled
    assert read_values("0.3, 4; x") == (0.3, "4; x")
    for text in ("0,3", "4,8,12", "1,234"):
        with pytest.raises(ValueError, match="should be"):
            read_values(text)


# A click right after typing comes with what was typed in one run, as AppTest sends it here.


def test_a_step_right_after_typing_is_decided_under_what_was_typed() -> None:
    at = opened()
    at.text_input(key="station.chargers").set_value("3")
    clicked(at, "step")
    assert session(at).run.trace.steps[0].inputs.scenario.station.chargers == 3


def test_a_click_right_after_something_wrong_does_nothing_and_says_so() -> None:
    at = opened()
    for key, text in (("station.chargers", "3,5"), ("option.C1.average_kw", "50")):
        at.text_input(key=key).set_value(text)
        clicked(at, "step")
        assert now(at) == 0
        assert [toast.value for toast in at.toast] == [NOT_TAKEN]
    assert session(at).run.answer is not None, "an average above the station's max_kw"
    clicked(at, "step")
    assert now(at) == 1


def test_a_prompt_right_after_typing_starts_from_what_was_typed() -> None:
    at = opened()
    at.text_input(key="station.chargers").set_value("20")
    clicked(at, "prompt_fewer_chargers")
    assert session(at).run.trace.scenario.station.chargers == 18


def test_counts_are_stepped_within_their_bounds() -> None:
    at = opened()
    at.text_input(key="station.chargers").set_value("1").run()
    clicked(at, "station.chargers:-1")
    assert session(at).run.trace.scenario.station.chargers == 0
    assert at.button(key="station.chargers:-1").disabled
    at.text_input(key="station.chargers").set_value("-1").run()
    assert "should be at least 0" in told(at)
    clicked(at, "station.chargers:+1")
    assert at.text_input(key="station.chargers").value == "1"
    clicked(at, "arrivals.seed:+1", 2)
    assert session(at).run.trace.scenario.arrivals.seed == 3


def test_another_scenario_right_after_typing_comes_whole_and_undo_brings_the_typed_back() -> None:
    at = scenario_page.opened()
    at.selectbox(key="scenario_from").set_value("voltage-limited").run()
    at.text_input(key="scenario:station.chargers").set_value("7")
    scenario_page.press(at, "take_scenario")
    assert editor(at).get(("station", "chargers")) == 140
    scenario_page.press(at, "undo_scenario")
    assert editor(at).get(("station", "chargers")) == 7


def test_a_new_day_right_after_typing_begins_on_what_was_typed() -> None:
    at = scenario_page.opened()
    at.text_input(key="scenario:station.chargers").set_value("7")
    scenario_page.press(at, "apply_scenario")
    assert session(at).run.trace.scenario.station.chargers == 7


def test_sessions_right_after_typing_are_taken_in_as_shown() -> None:
    at = upload(scenario_page.opened(), **{"march.csv": MONTH.encode()})
    at.selectbox(key="table:1::first").select_index(5).run()
    at.text_input(key="table:1::days:2019-03-05").set_value("2")
    scenario_page.press(at, "confirm_sessions")
    scenario, _ = editor(at).check()
    assert scenario is not None
    assert scenario.intervals == 48


def test_a_network_right_after_choosing_stands_where_chosen() -> None:
    at = scenario_page.opened()
    at.selectbox(key="shipped_network").set_value("case33bw").run()
    at.selectbox(key="network:1:None:station").set_value("5")
    scenario_page.press(at, "confirm_network")
    assert editor(at).get(("station", "node")) == "5"


def test_a_study_right_after_typing_is_what_was_typed(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setenv("EVDASH_STORE", str(tmp_path))
    begun = []

    def launch(folder, queue) -> int:
        write_stand(folder, Stand("starting", 1e12))
        begun.append(folder)
        return 0

    monkeypatch.setattr("evdash.studies.waiting.launch", launch)
    at = studies_page.opened()
    at.text_input(key="study_days_chargers").set_value("3")
    clicked(at, "start_study")
    assert begun[0].read().study.seeds.count == 3


def test_a_race_right_after_choosing_is_among_those_chosen(monkeypatch) -> None:
    started: list[list[str]] = []
    monkeypatch.setattr(
        "evdash.ui.race.racing.Racing.start", lambda _, inputs, chosen: started.append(chosen)
    )
    at = opened(steps=1)
    at.switch_page("pages/compare.py").run()
    pills = next(group for group in at.get("button_group") if group.key == "race_policies")
    pills.set_value(["p1"])
    clicked(at, "race_start")
    assert started == [["p1"]]


def test_a_text_that_is_no_toml_stays_until_it_is_mended() -> None:
    at = tab(scenario_page.opened(), "As text")
    at.text_area(key="scenario:text").set_value("not = = toml").run()
    at.run()
    assert at.text_area(key="scenario:text").value == "not = = toml"


def test_downloads_wait_for_what_was_typed() -> None:
    at = scenario_page.opened()
    rest = session(at).rest
    made: list[str] = []
    make: Callable[[], None] = rest.then(lambda: made.append("made"))
    with rest.broken():
        with rest.broken():
            pass
        assert not rest._is_drawn.is_set(), "a part is done, not the page"
    make()
    assert made == ["made"]
