"""Files of one's own on the Scenario page: what waits, what is asked, what is taken in."""

from datetime import date, datetime

import pandas as pd
import pytest
from streamlit.testing.v1 import AppTest

from evdash.domain.arrivals import RecordedArrivals
from evdash.domain.scenario import Scenario
from evdash.grid.nets.shipped import shipped_json
from evdash.imports.workbook import written
from tests.app.test_scenario_page import editor, opened, press, session, upload
from tests.imports.hostile import WORKBOOKS

MONTH = "id,start,end,kwh\n" + "".join(
    f"{day}-{n},2019-03-{day:02d} {8 + n:02d}:15,2019-03-{day:02d} {15 + n}:00,{3 + n}\n"
    for day in range(1, 32)
    for n in range(1 + day % 3)
)


def checked(at: AppTest) -> Scenario:
    scenario, faults = editor(at).check()
    assert scenario is not None, faults
    return scenario


def places(at: AppTest) -> set[str]:
    """Where the faults are that the page tells."""
    tables = [frame.value for frame in at.dataframe if "Where" in frame.value]
    return {place for table in tables for place in table["Where"]}


def names(scenario: Scenario) -> list[str]:
    assert isinstance(scenario.arrivals, RecordedArrivals)
    return [vehicle.vehicle for vehicle in scenario.arrivals.vehicles]


def test_an_uploaded_network_waits_and_tells_how_it_is_converted() -> None:
    at = opened()
    before = editor(at).draft
    upload(at, **{"net.json": shipped_json("four_bus")})
    assert editor(at).draft is before
    assert any("AC power flow at full load" in text.value for text in at.markdown)
    press(at, "confirm_network")
    assert checked(at).feeder.source_node == "bus1ref"
    assert any("AC power flow at full load" in text.value for text in at.markdown)
    assert "network_form" not in str(at.main)
    press(at, "undo_scenario")
    assert not editor(at).is_edited


def test_a_network_that_pandapower_fails_at_is_told_and_left(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Whatever it fails of: the form stays, with its way out."""

    def fails(*_: object) -> None:
        raise ValueError("no [such] number")

    monkeypatch.setattr("evdash.imports.feeder.ac_difference", fails)
    at = opened()
    upload(at, **{"net.json": shipped_json("four_bus")})
    assert not at.exception
    assert any("cannot be a feeder here" in error.value for error in at.error)
    press(at, "leave_network")
    assert "network_form" not in str(at.main)
    assert not editor(at).is_edited


def test_a_known_network_is_chosen_with_its_station() -> None:
    at = opened()
    at.selectbox(key="shipped_network").set_value("case33bw").run()
    assert not editor(at).is_edited
    station = at.selectbox(key="network:1:None:station")
    assert station.value == "23"  # 420 kW, the first of two such
    assert len(station.options) == 32
    station.set_value("17").run()
    press(at, "confirm_network")
    scenario = checked(at)
    assert (scenario.station.node, len(scenario.nodes)) == ("17", 33)
    press(at, "apply_scenario")
    assert session(at).run.trace.scenario.station.node == "17"


def test_where_a_network_is_supplied_is_asked_if_it_has_several_supplies() -> None:
    at = opened()
    at.selectbox(key="shipped_network").set_value("mv_oberrhein").run()
    source = at.selectbox(key="network:1:source")
    assert len(source.options) == 2
    sizes = []
    for bus in ("58", "318"):
        at.selectbox(key="network:1:source").set_value(bus).run()
        assert not at.exception
        sizes.append(len(at.selectbox(key=f"network:1:{bus}:station").options))
    assert sizes[0] != sizes[1]
    press(at, "leave_network")
    assert not editor(at).is_edited


def test_a_network_that_cannot_be_a_feeder_is_refused_with_its_reasons() -> None:
    import pandapower as pp

    from tests.imports.networks import ring

    at = opened()
    upload(at, **{"ring.json": pp.to_json(ring(closed=True)).encode()})
    assert "cannot be a feeder here" in at.error[0].value
    assert "a loop" in places(at)
    press(at, "leave_network")
    assert not at.error


def test_sessions_wait_for_their_columns_to_be_confirmed() -> None:
    at = opened()
    text = "id,start,left,kwh\na,2019-03-01 06:00,2019-03-01 16:00,9\n"
    before = editor(at).draft
    upload(at, **{"mine.csv": text.encode()})
    assert editor(at).draft is before
    at.selectbox(key="table:1::departure").set_value("left").run()
    press(at, "confirm_sessions")
    scenario = checked(at)
    assert names(scenario) == ["a"]
    assert scenario.intervals == 24
    press(at, "undo_scenario")
    assert editor(at).draft is before


def test_a_day_of_a_month_is_picked_then_another_then_all_of_them() -> None:
    at = opened()
    upload(at, **{"march.csv": MONTH.encode()})
    first = at.selectbox(key="table:1::first")
    assert first.options[5] == "Tue, 05 Mar 2019 · 3 sessions"
    assert len(first.options) == 32
    first.set_value(date(2019, 3, 5)).run()
    press(at, "confirm_sessions")
    scenario = checked(at)
    assert names(scenario) == ["5-0", "5-1", "5-2"]
    assert (scenario.start, scenario.intervals) == (datetime(2019, 3, 5), 24)
    at.selectbox(key="table:1::first").set_value(date(2019, 3, 30)).run()
    at.text_input(key="table:1::days:2019-03-30").set_value("2").run()
    press(at, "confirm_sessions")
    assert names(checked(at)) == ["30-0", "31-0", "31-1"]
    at.selectbox(key="table:1::first").set_value(None).run()
    press(at, "confirm_sessions")
    scenario = checked(at)
    assert (scenario.intervals, len(names(scenario))) == (31 * 24, 62)
    press(at, "apply_scenario")
    press(at, "leave_table")
    at.switch_page("pages/live.py").run()
    assert not at.exception
    press(at, "step")
    assert session(at).run.trace.now == 1


def hourly(first: str, column: str = "price_mwh") -> bytes:
    times = pd.date_range(first, periods=48, freq="1h")
    rows = [f"{time:%Y-%m-%d %H:%M},{10 * time.hour}" for time in times]
    return "\n".join([f"time,{column}", *rows, ""]).encode()


def test_prices_by_time_move_the_scenario_to_a_day_the_table_has() -> None:
    at = opened()
    upload(at, **{"prices.csv": hourly("2024-05-06")})
    assert at.date_input(key="table:1::day").value == date(2024, 5, 6)
    at.date_input(key="table:1::day").set_value(date(2024, 5, 7)).run()
    press(at, "confirm_profile")
    scenario = checked(at)
    assert scenario.start == datetime(2024, 5, 7)
    assert [row.price_per_kwh for row in scenario.profile] == [h / 100 for h in range(24)]
    press(at, "undo_scenario")
    assert not editor(at).is_edited


def test_a_load_without_a_unit_is_asked_for_it_and_faults_change_nothing() -> None:
    at = opened()
    upload(at, **{"loads.csv": hourly("2020-07-15", "load").replace(b",230", b",x", 1)})
    press(at, "confirm_profile")
    assert "unit of load" in places(at)
    at.selectbox(key="table:1::load:unit:load").set_value("kW").run()
    press(at, "confirm_profile")
    assert "loads.csv, row 25, column load" in places(at)
    assert not editor(at).is_edited
    upload(at, **{"loads.csv": hourly("2020-07-15", "load")})
    at.selectbox(key="table:2::load:unit:load").set_value("kW").run()
    press(at, "confirm_profile")
    assert [row.load_pu for row in checked(at).profile] == [h / 23 for h in range(24)]


def test_a_sheet_is_chosen_of_a_workbook_that_has_several() -> None:
    at = opened()
    sheets = {
        "notes": [["x", "y"], ["a", "b"]],
        "visits": [["id", "start", "end", "kwh"], ["a", datetime(2019, 3, 1, 6), None, 5.0]],
    }
    upload(at, **{"mine.xlsx": written(sheets)})
    at.selectbox(key="table:1:sheet").set_value("visits").run()
    press(at, "confirm_sessions")
    assert names(checked(at)) == ["a"]


@pytest.mark.parametrize("ending", ["csv", "json"])
def test_two_tables_at_once_are_refused(ending: str) -> None:
    content = {"csv": MONTH.encode(), "json": b'[{"start": "2019-03-01 06:00", "kwh": 3}]'}[ending]
    at = opened()
    upload(at, **{f"a.{ending}": content, f"b.{ending}": content})
    assert editor(at).waiting is None
    assert "by itself" in at.dataframe[0].value["Allowed"][0]


def test_templates_are_offered() -> None:
    at = opened()
    labels = [button.label for button in at.get("download_button")]
    for name in ("scenario.xlsx", "templates.zip", "sessions.csv", "prices.csv", "loads.csv"):
        assert any(label.endswith(f": {name}") for label in labels), name


@pytest.mark.parametrize("kind", ["bomb", "entities", "far column", "text", "formula"])
def test_hostile_workbooks_are_refused_and_the_page_goes_on(kind: str) -> None:
    at = opened()
    before = editor(at).draft
    make, words = WORKBOOKS[kind]
    upload(at, **{"mine.xlsx": make()})
    assert "Nothing was taken in" in at.error[0].value
    told = next(frame.value for frame in at.dataframe if "Where" in frame.value)
    assert words in f"{told['Where'][0]}: found {told['Found'][0]}; {told['Allowed'][0]}"
    assert editor(at).draft is before
    upload(at, **{"march.csv": MONTH.encode()})
    press(at, "confirm_sessions")
    assert len(names(checked(at))) == 62
