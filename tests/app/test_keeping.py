"""A tab's run outlives the tab: its address brings it back, whatever was done, without solving."""

from pathlib import Path

import pytest
from streamlit.testing.v1 import AppTest

from evdash.store.place import VARIABLE
from evdash.store.runs import Store
from evdash.ui import keeping
from evdash.ui.keeping import COPIED, GONE, LINK
from evdash.ui.solving import decider
from tests.app.test_live_page import APP, clicked, edit, now, opened, session


def linked(at: AppTest) -> str:
    link: str = at.run().query_params[LINK]  # the address follows at the end of the app's run
    return link


def reopened(link: str) -> AppTest:
    at = AppTest.from_file(str(APP), default_timeout=60)
    at.query_params[LINK] = link
    at.run()
    assert not at.exception
    return at


def captions(at: AppTest) -> str:
    return " ".join(caption.value for caption in at.caption)


def test_a_reload_in_mid_run_goes_on_at_the_same_step(monkeypatch) -> None:
    at = opened(steps=5)
    edit(at, "station.chargers", 7)
    clicked(at, "step", 2)
    monkeypatch.setattr("evdash.ui.run.decider", None)  # nothing is solved on the way
    again = reopened(linked(at))
    assert now(again) == 7
    assert again.text_input(key="station.chargers").value == "7"
    assert "12 → 7" in captions(again)
    one, other = session(at).run.trace, session(again).run.trace
    assert (one.state.tail_kw == other.state.tail_kw).all()
    assert [s.plan.report for s in one.steps] == [s.plan.report for s in other.steps]
    monkeypatch.setattr("evdash.ui.run.decider", decider)
    clicked(again, "step")
    assert linked(again) == linked(at)


def test_an_edit_alone_is_kept_and_a_mere_visit_is_not() -> None:
    at = opened()
    assert LINK not in at.run().query_params
    edit(at, "station.chargers", 7)
    assert session(reopened(linked(at))).run.trace.scenario.station.chargers == 7


def test_another_preset_in_the_same_tab_is_kept_under_its_link() -> None:
    at = opened(steps=1)
    link = linked(at)
    at.selectbox(key="preset").set_value("voltage-limited").run()
    assert linked(at) == link
    again = reopened(link)
    assert session(again).run.folder.name == "voltage-limited"
    assert again.selectbox(key="preset").value == "voltage-limited"


def test_two_tabs_with_one_link_part_ways() -> None:
    one = opened(steps=2)
    link = linked(one)
    other = reopened(link)
    clicked(one, "step")
    edit(other, "arrivals.seed", 5)
    assert linked(one) == link
    assert linked(other) != link
    assert COPIED in captions(other.run())
    assert now(reopened(link)) == 3
    assert now(reopened(linked(other))) == 2


def test_an_unknown_link_begins_a_new_day_and_says_so() -> None:
    at = reopened("no-such-run")
    assert now(at) == 0
    assert GONE in captions(at)
    assert LINK not in at.run().query_params
    clicked(at, "step")
    assert GONE not in captions(at)


def test_where_nothing_can_be_kept_the_page_says_so_and_goes_on(monkeypatch, tmp_path: Path):
    occupied = tmp_path / "file"
    occupied.write_text("not a folder")
    monkeypatch.setattr(keeping, "store", lambda: Store(occupied))
    at = opened(steps=2)
    assert now(at) == 2
    assert "will not outlast this tab" in captions(at)
    assert LINK not in at.query_params


@pytest.mark.parametrize("change", ["step", "edit", "reset", "preset"])
def test_undo_takes_back_the_last_change_whatever_it_was(change: str) -> None:
    at = opened(steps=3)
    before = session(at).run
    match change:
        case "step":
            clicked(at, "step")
        case "edit":
            edit(at, "station.chargers", 7)
        case "reset":
            clicked(at, "reset")
        case "preset":
            at.selectbox(key="preset").set_value("voltage-limited").run()
    assert session(at).run.trace is not before.trace
    clicked(at, "undo")
    assert session(at).run.trace is before.trace
    assert at.text_input(key="station.chargers").value == "12"
    assert now(reopened(linked(at))) == 3
    clicked(at, "undo", 3)
    assert at.button(key="undo").disabled


def test_the_place_of_runs_is_the_setting(monkeypatch, tmp_path: Path) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    keeping.store.cache_clear()
    try:
        opened(steps=1)
        assert list(tmp_path.glob("*.sqlite3"))
    finally:
        keeping.store.cache_clear()
