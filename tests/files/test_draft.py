"""A scenario in the making: exact on the way in and out, tolerant of faults in between."""

import io
import zipfile

import pytest

from evdash.domain.events import Event
from evdash.errors import InputError
from evdash.files.bundled import DEFAULT, bundled_scenarios
from evdash.files.draft import (
    RECORDS,
    draft_of,
    drawn,
    files_of,
    listed,
    read_draft,
    read_rows,
    scenario_of,
    table_for,
    table_text,
    template_text,
    zipped,
)
from evdash.files.folder import read_zip
from evdash.files.scenario_folder import parse_scenario, read_scenario, scenario_files
from evdash.horizon.arrivals import arrivals_of

FOLDERS = bundled_scenarios()


def as_bytes(files: dict[str, str]) -> dict[str, bytes]:
    return {name: text.encode() for name, text in files.items()}


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_a_scenario_is_the_same_after_being_a_draft_a_zip_and_a_draft_again(folder) -> None:
    scenario = read_scenario(folder)
    draft = draft_of(scenario)
    assert scenario_of(draft) == scenario
    packed = zipped(files_of(draft), "day")
    assert packed == zipped(files_of(draft), "day")
    again = read_draft(read_zip(io.BytesIO(packed), "day.zip"))
    assert again == draft
    assert files_of(again) == scenario_files(scenario)
    assert {name.split("/")[0] for name in zipfile.ZipFile(io.BytesIO(packed)).namelist()} == {
        "day"
    }


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_listed_vehicles_are_those_that_would_be_drawn_and_can_be_drawn_again(folder) -> None:
    scenario = read_scenario(folder)
    as_list = listed(draft_of(scenario))
    assert as_list.is_recorded
    assert scenario_of(as_list).arrivals.vehicles == arrivals_of(scenario)
    assert scenario_of(drawn(as_list, read_scenario(DEFAULT))) == scenario


def test_vehicles_listed_without_statistics_are_drawn_by_anothers() -> None:
    draft = listed(draft_of(read_scenario(DEFAULT)))
    bare = draft.with_settings(
        draft.settings
        | {"arrivals": {"file": "arrivals.csv"}}
        | {"option": [{"name": "Only", "price_per_kwh": 0.3, "average_kw": 7.0}]}
    )
    known = scenario_of(drawn(bare, read_scenario(DEFAULT))).arrivals
    assert known.option_share == {"Only": 1.0}
    assert known.fleet == read_scenario(DEFAULT).arrivals.fleet


def test_faulty_values_are_kept_and_told_where_they_stand() -> None:
    draft = draft_of(read_scenario(DEFAULT))
    rows = list(draft.tables["lines.csv"])
    rows[2] = rows[2] | {"r_ohm": "much", "to_node": "nowhere"}
    spoilt = draft.with_table("lines.csv", tuple(rows)).with_settings(
        draft.settings | {"intervals": "two dozen"}
    )
    with pytest.raises(InputError) as told:
        scenario_of(spoilt)
    places = [fault.place for fault in told.value.faults]
    assert "scenario.toml, intervals" in places
    assert "lines.csv, row 4, column r_ohm" in places
    assert any(place.startswith("lines.csv, row 4, column to_node") for place in places)
    assert read_draft(as_bytes(files_of(spoilt))) == spoilt


def test_events_are_kept_and_an_empty_table_of_them_is_no_file() -> None:
    draft = draft_of(read_scenario(DEFAULT))
    assert "events.csv" not in files_of(draft.with_table("events.csv", ()))
    blank = dict.fromkeys(Event.model_fields, "")
    row = blank | {"interval": "18", "event": "chargers_fail", "value": "2"}
    eventful = scenario_of(draft.with_table("events.csv", (row,)))
    assert [event.text for event in eventful.events] == ["2 of the chargers stop working"]
    assert scenario_of(draft_of(eventful)) == eventful


def test_files_that_are_no_scenario_are_told_all_at_once() -> None:
    files = as_bytes(scenario_files(read_scenario(DEFAULT)))
    files["nodes.csv"] = b"node,colour\n650,red\n"
    files["lines.csv"] = b"\xff\xfe"
    files["photo.jpg"] = b"jpg"
    with pytest.raises(InputError) as told:
        read_draft(files)
    places = [fault.place for fault in told.value.faults]
    assert {"photo.jpg", "lines.csv", "nodes.csv, header"} <= set(places)


def test_tables_of_other_names_are_taken_by_their_names_in_the_settings() -> None:
    files = as_bytes(scenario_files(read_scenario(DEFAULT)))
    files["cars.csv"] = files.pop("fleet.csv")
    files["scenario.toml"] = files["scenario.toml"].replace(b"fleet.csv", b"cars.csv")
    assert scenario_of(read_draft(files)) == parse_scenario(files)


@pytest.mark.parametrize("file", RECORDS)
def test_a_table_is_known_by_its_name_or_its_columns(file: str) -> None:
    scenario = read_scenario(DEFAULT)
    draft = listed(draft_of(scenario))
    content = table_text(file, draft.tables.get(file, ())).encode()
    stem = file.removesuffix(".csv")
    assert table_for(file, content) == table_for(f"{stem} (1).csv", content) == file
    assert table_for("export.csv", content) == file
    assert table_for("export.csv", b"a,b\n1,2\n") is None


@pytest.mark.parametrize("file", RECORDS)
def test_templates_have_every_column_and_read_back(file: str) -> None:
    rows, faults = read_rows(file, template_text(file).encode())
    assert faults == []
    assert list(rows[0]) == list(RECORDS[file].model_fields)
