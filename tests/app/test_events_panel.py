"""The events panel without a browser: every choice, what it would do, and the ledger after it."""

import pytest
from streamlit.testing.v1 import AppTest

from evdash.files.numbers import number_text
from evdash.ui.events.choices import CHOICES
from tests.app.test_live_page import clicked, now, opened, session


def panel(steps: int = 18) -> AppTest:
    at = opened(steps=steps)
    at.session_state["events"] = True
    at.run()
    assert not at.exception
    return at


def asked(at: AppTest, kind: str, **fields: float) -> AppTest:
    at.selectbox(key="event_kind").select(kind).run()
    for key, value in fields.items():
        at.text_input(key=f"event_{key}").set_value(number_text(value)).run()
    return clicked(at, "event_ask")


def shown(at: AppTest) -> str:
    texts = (*at.warning, *at.info, *at.error, *at.markdown)
    return "\n".join(str(one.value) for one in texts)


def test_closed_it_shows_no_fields_and_the_day_goes_on() -> None:
    at = opened(steps=1)
    assert not any(one.key == "event_kind" for one in at.selectbox)
    clicked(at, "step")
    assert now(at) == 2


@pytest.mark.parametrize("kind", CHOICES)
def test_every_choice_can_be_looked_at_and_applied(kind: str) -> None:
    at = panel()
    before = session(at).run.trace
    asked(at, kind)
    assert session(at).run.trace is before, "looking changes nothing"
    clicked(at, "event_apply")
    after = session(at).run.trace
    assert [event.event for event in after.happenings[-1].events] == [kind]
    assert not any(one.key == "event_apply" for one in at.button)
    clicked(at, "step")
    assert now(at) == 19


def test_a_failure_is_warned_of_with_remedies_and_told_by_the_ledger() -> None:
    at = asked(panel(), "chargers_fail", count=10)
    text = shown(at)
    assert "cannot be delivered in time" in text
    assert "This would keep every promise: **3 more chargers**" in text
    clicked(at, "event_apply")
    text = shown(at)
    assert "promises cannot be kept as things stand" in text
    assert "10 of the chargers stop working" in text
    at.session_state["table_ledger"] = True
    at.run()
    rows = next(one.value for one in at.dataframe if "What became of it" in one.value)
    assert set(rows["What became of it"]) >= {"! short", "✓ kept"}


def test_chargers_that_failed_are_not_said_to_have_been_too_few_before() -> None:
    at = clicked(asked(panel(), "chargers_fail", count=10), "event_apply")
    figure = next(one for one in at.metric if one.label == "Charging")
    assert (figure.value, figure.delta) == ("6", "of 12 chargers")
    clicked(at, "step")
    figure = next(one for one in at.metric if one.label == "Charging")
    assert figure.delta == "of 2 chargers"


def test_what_has_happened_is_said_where_it_was_chosen_until_the_day_moves_on() -> None:
    at = clicked(asked(panel(), "price_factor"), "event_apply")
    assert "Has happened at 18:00: energy costs 1\\.2 times what was expected" in shown(at)
    clicked(at, "step")
    assert "Has happened" not in shown(at)


def test_never_mind_changes_nothing() -> None:
    at = asked(panel(), "chargers_fail", count=10)
    before = session(at).run.trace
    clicked(at, "event_drop")
    assert session(at).run.trace is before
    assert not any(one.key == "event_apply" for one in at.button)


def test_what_was_looked_at_is_forgotten_once_the_day_moves_on() -> None:
    at = asked(panel(), "chargers_fail", count=2)
    clicked(at, "step")
    assert not any(one.key == "event_apply" for one in at.button)


def test_where_nobody_is_under_contract_vehicles_cannot_be_chosen() -> None:
    at = panel(steps=0)
    at.selectbox(key="event_kind").select("no_show").run()
    assert "No vehicle is under contract" in shown(at)
    assert at.button(key="event_ask").disabled


def test_back_and_reset_undo_what_happened() -> None:
    at = clicked(asked(panel(), "chargers_fail", count=10), "event_apply")
    clicked(at, "back")
    assert session(at).run.trace.happenings == ()
    clicked(at, "reset")
    assert session(at).run.trace.scenario.station.chargers == 12


def test_the_panel_is_gone_once_the_day_is_over() -> None:
    at = clicked(panel(steps=1), "finish")
    assert session(at).run.trace.is_over
    assert not any(one.key == "event_kind" for one in at.selectbox)
