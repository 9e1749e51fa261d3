"""The Vehicles page without a browser: every preset, every control, every kind of vehicle."""

import time

import pytest
from streamlit.testing.v1 import AppTest
from streamlit.testing.v1.element_tree import Selectbox

from evdash.explain.refusals import explain_vehicle
from evdash.explain.revisions import explain_revision
from evdash.metrics.outlook import outlook
from evdash.metrics.records import vehicle_records
from evdash.ui.vehicles.choice import by_name
from evdash.ui.vehicles.picked import VEHICLE
from evdash.ui.vehicles.words import change_lines
from evdash.ui.words import plain
from tests.app.test_live_page import PRESETS, clicked, figures, opened, session

PAGE = "pages/vehicles.py"


def vehicles_page(preset: str = PRESETS[0], steps: int = 0, **query: str) -> AppTest:
    at = opened(preset)
    at.switch_page(PAGE)
    for name, value in query.items():
        at.query_params[name] = value
    at.run()
    assert not at.exception
    return clicked(at, "step", steps)


def ended(preset: str = PRESETS[0]) -> AppTest:
    return clicked(vehicles_page(preset), "finish")


def of_status(at: AppTest, *statuses: str) -> list[str]:
    records = vehicle_records(session(at).run.trace)
    return [record.vehicle for record in records if record.status in statuses]


def listed(at: AppTest) -> list[str]:
    return list(at.dataframe[0].value["Vehicle"])


def picker(at: AppTest) -> Selectbox:
    return next(box for box in at.selectbox if box.label == "Look at one vehicle")


def pick(at: AppTest, name: str | None) -> AppTest:
    picker(at).set_value(name).run()
    assert not at.exception
    return at


def texts(at: AppTest) -> str:
    return "\n".join(text.value for text in at.markdown)


def told(at: AppTest, words: str, seconds: float = 30.0) -> bool:
    """Whether the page says so, now or once it has been found out."""
    until = time.monotonic() + seconds
    while words not in texts(at) and time.monotonic() < until:
        time.sleep(0.1)
        at.run()
        assert not at.exception
    return words in texts(at)


@pytest.mark.parametrize("preset", PRESETS)
def test_every_preset_and_every_kind_of_vehicle(preset: str) -> None:
    at = ended(preset)
    assert session(at).run.trace.is_over
    records = vehicle_records(session(at).run.trace)
    assert sorted(listed(at)) == sorted(record.vehicle for record in records)
    for name in {record.status: record.vehicle for record in records}.values():
        pick(at, name)
        assert at.query_params[VEHICLE] == name
        assert name in texts(at).replace("\\", "")


def test_before_the_first_step_the_page_says_what_will_be_seen() -> None:
    at = vehicles_page()
    assert "Nobody has asked" in texts(at)
    assert not at.dataframe
    clicked(at, "first_step")
    assert session(at).run.trace.now == 1
    assert "Nobody has asked" not in texts(at)


def test_each_group_shows_whom_it_says() -> None:
    at = vehicles_page(steps=19)
    everyone = listed(at)
    charging = {n for n, kw in zip(everyone, at.dataframe[0].value["Now, kW"], strict=True) if kw}
    expected = {
        "Admitted": set(of_status(at, "charged", "charging", "broken")),
        "Refused": set(of_status(at, "refused")),
        "Charging now": charging,
        "Completed": set(of_status(at, "charged")),
    }
    for group, names in expected.items():
        at.segmented_control(key="vehicles_group").set_value(group).run()
        assert not at.exception
        assert set(listed(at)) == names, group
        assert 0 < len(names) < len(everyone)


def test_search_option_and_order() -> None:
    at = vehicles_page(steps=17)
    arrivals = listed(at)
    at.selectbox(key="vehicles_order").set_value("Energy asked").run()
    asked = list(at.dataframe[0].value["Asks, kWh"])
    assert asked == sorted(asked, reverse=True)
    assert listed(at) != arrivals
    at.selectbox(key="vehicles_order").set_value("Name").run()
    assert listed(at) == sorted(arrivals, key=by_name)
    at.multiselect(key="vehicles_options").set_value(["C2"]).run()
    assert set(at.dataframe[0].value["Option"]) == {"C2"}
    at.text_input(key="vehicles_text").set_value("pev-01").run()
    assert all("PEV-01" in name for name in listed(at))
    at.text_input(key="vehicles_text").set_value("nobody at all").run()
    assert not at.exception
    assert at.dataframe[0].value.empty


def test_a_vehicle_named_in_the_address_is_looked_at_once_it_has_asked() -> None:
    at = vehicles_page(vehicle="PEV-030")
    assert "has not asked yet" in texts(at)
    clicked(at, "step", 2)
    assert "has not asked by" in texts(at)
    clicked(at, "step", 16)
    assert picker(at).value == "PEV-030"
    assert "**Asked**" in texts(at)
    pick(at, None)
    assert VEHICLE not in at.query_params
    assert "Pick a vehicle to see" in texts(at)


def test_another_vehicle_draws_another_chart_and_the_same_draws_none() -> None:
    at = vehicles_page(steps=10)
    first, second = of_status(at, "charged")[:2]
    before = figures(pick(at, first))
    at.run()
    assert figures(at) == before
    after = figures(pick(at, second))
    changed = {name for name in before if before[name] != after[name]}
    assert {"chart_vehicle", "chart_history", "chart_fleet"} <= changed


def test_a_refusal_is_explained_in_the_background() -> None:
    at = clicked(vehicles_page(), "step", 19)
    first = of_status(at, "refused")[0]
    pick(at, first)
    assert "Answer: no" in texts(at)
    explanation = explain_vehicle(session(at).run.trace, first)
    assert told(at, plain(explanation.detail))
    assert plain(explanation.remedy) in texts(at)


def test_a_change_of_plan_is_explained_on_request() -> None:
    at = ended()
    trace = session(at).run.trace
    changes = {name: change_lines(trace, name, outlook(trace)) for name in of_status(at, "charged")}
    name, lines = next((name, lines) for name, lines in changes.items() if lines)
    pick(at, name)
    assert lines[0][1] in texts(at)
    interval = lines[0][0]
    at.selectbox(key="why_changed_at").set_value(interval).run()
    assert not at.exception
    assert told(at, plain(explain_revision(trace, interval).text))


def test_contract_words_carry_the_records_numbers() -> None:
    at = vehicles_page(steps=12)
    record = next(
        r for r in vehicle_records(session(at).run.trace) if r.status in ("charged", "charging")
    )
    text = texts(pick(at, record.vehicle))
    assert f"{record.request.need_kwh:.1f}" in text
    assert f"\\${record.revenue:,.2f}" in text


def test_the_run_is_the_live_pages() -> None:
    at = vehicles_page(steps=3)
    at.switch_page("pages/live.py").run()
    assert not at.exception
    assert session(at).run.trace.now == 3
    clicked(at, "step")
    at.switch_page(PAGE).run()
    assert session(at).run.trace.now == 4
    assert len(at.dataframe) == 1


def test_names_are_shown_as_they_are() -> None:
    """Streamlit's Markdown would read `**` and `$`; what a browser gets is escaped."""
    at = vehicles_page(vehicle="**PEV** $x$")
    assert "\\*\\*PEV\\*\\* \\$x\\$" in texts(at)
