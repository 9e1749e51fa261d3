"""The Compare page without a browser: pin, change, compare, rename, open, run to the end."""

from pathlib import Path

import pytest
from streamlit.testing.v1 import AppTest

from evdash.errors import StoreUnavailable
from evdash.files.bundled import DEFAULT, bundled_scenarios
from evdash.files.scenario_folder import read_scenario
from evdash.metrics.service import totals
from evdash.ui import run as runs
from evdash.ui.compare.pins import KEY as PINS
from evdash.ui.compare.pins import MOST_PINS, PRESENT, Pins, is_alike, suggested_name
from evdash.ui.session import KEY, Session
from evdash.ui.solving import policy

APP = Path(__file__).parents[2] / "app.py"
PRESETS = [folder.name for folder in bundled_scenarios()]


def opened(preset: str = PRESETS[0]) -> AppTest:
    at = AppTest.from_file(str(APP), default_timeout=120)
    at.query_params["preset"] = preset
    at.run()
    at.switch_page("pages/compare.py").run()
    assert not at.exception
    return at


def session(at: AppTest) -> Session:
    found: Session = at.session_state[KEY]
    return found


def pins(at: AppTest) -> Pins:
    found: Pins = at.session_state[PINS]
    return found


def press(at: AppTest, key: str) -> AppTest:
    at.button(key=key).click().run()
    assert not at.exception
    return at


def texts(at: AppTest) -> str:
    return "\n".join(element.value for element in [*at.markdown, *at.caption, *at.warning])


def day_of(at: AppTest, steps: int, **settings: float) -> AppTest:
    """Change settings, then decide some intervals, as another page would."""
    run = runs.restarted(session(at).run)
    if settings:
        changed = {key.replace("__", "."): value for key, value in settings.items()}
        run = runs.edited(run, "test", changed)
    for _ in range(steps):
        run = runs.stepped(run, policy)
    session(at).take(run)
    at.run()
    assert not at.exception
    return at


@pytest.mark.parametrize("preset", PRESETS)
def test_two_runs_of_every_preset_are_compared(preset: str) -> None:
    at = opened(preset)
    assert any("Hold one run against another" in info.value for info in at.info)
    press(day_of(at, 3), "pin")
    assert not at.get("plotly_chart")
    day_of(at, 3, station__chargers=1)
    assert len(at.get("plotly_chart")) == 3
    assert "station\\.chargers" in texts(at)
    assert at.selectbox(key="against").value == pins(at).all[0].name


def test_differences_are_those_of_the_totals() -> None:
    at = opened()
    press(day_of(at, 24), "pin")
    day_of(at, 24, station__chargers=6)
    table = next(text.value for text in at.markdown if "| Profit |" in text.value)
    profit = next(line for line in table.splitlines() if line.startswith("| Profit |"))
    whole, fewer, difference = (
        float(cell.strip().replace("&#36;", "").replace(",", "").replace("−", "-"))
        for cell in profit.split("|")[2:5]
    )
    assert whole == round(totals(pins(at).all[0].run.trace).profit, 2)
    assert fewer < whole
    assert difference == pytest.approx(fewer - whole, abs=0.011)


def test_runs_that_have_come_to_different_hours_are_compared_up_to_the_common_one() -> None:
    at = opened()
    press(day_of(at, 20), "pin")
    day_of(at, 12, station__chargers=6)
    assert "up to **12:00**" in texts(at)
    asked = sum(len(group) for group in session(at).run.trace.inputs.requests[:12])
    assert f"| Asked, vehicles | {asked} | {asked} | = |" in texts(at)
    press(at, "finish_all")
    assert session(at).run.trace.is_over
    assert all(pin.run.trace.is_over for pin in pins(at).all)
    assert "different hours" not in texts(at)
    assert "| Asked, vehicles | 99 | 99 | = |" in texts(at)


def test_pins_are_renamed_opened_and_taken_away() -> None:
    at = opened()
    press(day_of(at, 2), "pin")
    assert "One run alone" in at.info[0].value
    kept = pins(at).all[0].run
    at.text_input(key="rename:1").set_value("Twelve *chargers*").run()
    assert pins(at).all[0].name == "Twelve *chargers*"
    day_of(at, 2, station__chargers=6)
    assert "Twelve \\*chargers\\*" in texts(at)
    press(at, "open_1")
    assert session(at).run is kept
    press(at, "unpin_1")
    assert pins(at).all == ()


def test_pins_outlive_a_change_of_page() -> None:
    at = opened()
    press(day_of(at, 2), "pin")
    at.switch_page("pages/live.py").run()
    at.switch_page("pages/compare.py").run()
    assert not at.exception
    assert [pin.number for pin in pins(at).all] == [1]


def test_pins_are_there_again_after_a_reload() -> None:
    at = opened()
    press(day_of(at, 3), "pin")
    press(day_of(at, 2, station__chargers=6), "pin")
    at.text_input(key="rename:2").set_value("Six").run()
    press(at, "finish_all")
    assert not at.warning
    link = session(at).keeper.link
    kept = {pin.name: pin.run.trace for pin in pins(at).all}
    again = AppTest.from_file(str(APP), default_timeout=60)
    again.query_params["run"] = link
    again.run()
    again.switch_page("pages/compare.py").run()
    assert not again.exception
    back = {pin.name: pin.run.trace for pin in pins(again).all}
    assert back.keys() == kept.keys() == {"Summer weekday", "Six"}
    assert all(is_alike(back[name], kept[name]) for name in kept)
    assert not is_alike(back["Six"], back["Summer weekday"])
    assert again.button(key="pin").disabled  # the present run is pinned as it stands
    number = next(pin.number for pin in pins(again).all if pin.name == "Six")
    press(again, f"unpin_{number}")
    third = AppTest.from_file(str(APP), default_timeout=60)
    third.query_params["run"] = link
    third.run()
    third.switch_page("pages/compare.py").run()
    assert [pin.name for pin in pins(third).all] == ["Summer weekday"]


def test_pins_that_cannot_be_kept_say_so(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken() -> None:
        raise StoreUnavailable("no room")

    monkeypatch.setattr("evdash.ui.compare.pins.store", broken)
    at = press(opened(), "pin")
    assert "will not outlast this tab" in at.warning[0].value
    assert len(pins(at).all) == 1


def test_names_are_never_given_twice_and_pins_are_bounded() -> None:
    at = opened()
    for _ in range(MOST_PINS + 1):
        pins(at).add(PRESENT, session(at).run)
    names = [pin.name for pin in pins(at).all]
    assert len(names) == len(set(names)) == MOST_PINS
    assert PRESENT not in names
    day_of(at, 1)
    assert at.button(key="pin").disabled


def test_a_suggested_name_says_what_was_changed() -> None:
    at = opened()
    assert suggested_name(session(at).run) == "Summer weekday"
    day_of(at, 0, station__chargers=6)
    assert suggested_name(session(at).run) == "Summer weekday, Chargers 12 → 6"


def test_runs_of_different_clocks_are_compared() -> None:
    at = opened("past-midnight")
    press(day_of(at, 10), "pin")
    at.session_state[KEY].take(runs.open_run(None, read_scenario(DEFAULT)))
    day_of(at, 10)
    assert len(at.get("plotly_chart")) == 3


def test_the_example_compares_with_half_the_chargers() -> None:
    at = press(opened(), "example")
    assert session(at).run.trace.scenario.station.chargers == 6
    assert session(at).run.trace.is_over
    assert pins(at).all[0].run.trace.is_over
    assert "**Present run** against **Summer weekday**: " in texts(at)
    assert " fewer admitted" in texts(at)
