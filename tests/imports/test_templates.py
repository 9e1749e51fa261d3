"""Templates: valid as they are, safe in a spreadsheet, and telling what is allowed."""

import csv
import io
from pathlib import Path

import openpyxl
import pytest

from evdash.domain.scenario import Feeder, Node, Station
from evdash.errors import InputError
from evdash.files.draft import RECORDS, Draft, draft_of, read_draft, scenario_of
from evdash.horizon.day import run_day, start_day
from evdash.imports.profile import ProfileRules, with_profile
from evdash.imports.profile_columns import UNITS, proposed_unit
from evdash.imports.profile_columns import proposed as proposed_values
from evdash.imports.scenario_book import SHEETS, read_book, with_book
from evdash.imports.session_columns import proposed
from evdash.imports.session_rows import SessionRules
from evdash.imports.sessions import with_sessions
from evdash.imports.tables import read_foreign
from evdash.imports.templates import (
    TABLES,
    WORKBOOK,
    field_rows,
    template_draft,
    template_files,
    template_table,
    template_workbook,
    write_templates,
)
from evdash.metrics.service import totals
from evdash.scheduling.p1 import p1_policy


def test_the_workbook_read_back_is_the_folder_and_everyone_is_charged() -> None:
    draft, told = with_book(Draft({}, {}), read_book(WORKBOOK, template_workbook()))
    scenario = scenario_of(draft)
    assert scenario == scenario_of(template_draft())
    assert len(told) == 1
    done = totals(run_day(start_day(scenario), p1_policy()))
    assert (done.arrived, done.charged) == (6, 6)


def test_the_tables_are_taken_in_with_no_word_said() -> None:
    base = template_draft()
    sessions = read_foreign("sessions.csv", template_table("sessions.csv"))
    draft, _ = with_sessions(base, sessions, SessionRules(proposed(sessions.columns)))
    assert len(scenario_of(draft).arrivals.vehicles) == 5  # type: ignore[union-attr]
    for name in ("prices.csv", "loads.csv"):
        table = read_foreign(name, template_table(name))
        columns = proposed_values(table.columns)
        units = {f: proposed_unit(f, c) or "" for f, c in columns.items() if f in UNITS}
        changed, _ = with_profile(base, table, ProfileRules(columns, units))
        rows = scenario_of(changed).profile
        for row, known in zip(rows, scenario_of(base).profile, strict=True):
            assert row.price_per_kwh == pytest.approx(known.price_per_kwh)
            assert row.load_pu == pytest.approx(known.load_pu, abs=1e-3)


def test_no_cell_is_a_formula_or_a_link_and_none_of_a_csv_could_become_one() -> None:
    book = openpyxl.load_workbook(io.BytesIO(template_workbook()))
    for sheet in book.worksheets:
        for row in sheet.iter_rows():
            for cell in row:
                assert cell.data_type in "snd", (sheet.title, cell.coordinate)
                assert cell.hyperlink is None
    for name in TABLES:
        for row in csv.reader(io.StringIO(template_table(name).decode())):
            assert not any(cell.startswith(("=", "+", "-", "@", "\t")) for cell in row)


def test_every_key_and_column_is_told_with_its_unit_and_range() -> None:
    told = {(where, name): (unit, allowed) for where, name, _, unit, allowed, _ in field_rows()}
    for sheet, file in SHEETS.items():
        assert {name for where, name in told if where == sheet} == set(RECORDS[file].model_fields)
    assert told["scenario", "station.max_kw"] == ("kW", "at least 0.01, at most 10,000")
    assert told["scenario", "feeder.source_voltage_pu"] == ("pu", "above 0.5, below 1.5")
    for record, prefix in ((Feeder, "feeder"), (Station, "station")):
        assert all(("scenario", f"{prefix}.{name}") in told for name in record.model_fields)
    book = openpyxl.load_workbook(io.BytesIO(template_workbook()))
    rows = [[cell.value or "" for cell in row] for row in book["README"].iter_rows(min_row=2)]
    assert rows == [list(row) for row in field_rows()]
    head = {cell.value: cell.comment.text for cell in book["nodes"][1]}
    assert set(head) == set(Node.model_fields)
    assert "Unit: kW. Allowed: at least 0" in head["load_kw"]
    settings = {row[0].value: [cell.value for cell in row] for row in book["scenario"].iter_rows()}
    assert settings["station.min_kw"][3:] == ["kW", "at least 0"]
    assert settings["option.C1.average_kw"][3] == "kW"


def test_the_scenario_folder_of_the_templates_is_the_draft() -> None:
    files = template_files()
    folder = {
        name.removeprefix("scenario/"): content
        for name, content in files.items()
        if name.startswith("scenario/")
    }
    assert read_draft(folder) == template_draft()
    assert draft_of(scenario_of(template_draft())).tables.keys() <= template_draft().tables.keys()
    assert b"| nodes | load_kw | Peak active load | kW |" in files["README.md"]
    assert template_workbook() == files[WORKBOOK] == template_workbook()


def test_files_that_are_there_are_replaced_only_when_asked(tmp_path: Path) -> None:
    written = write_templates(tmp_path / "t", force=False)
    assert len(written) == len(template_files())
    own = tmp_path / "t" / "prices.csv"
    own.write_text("mine")
    with pytest.raises(InputError, match="--force"):
        write_templates(tmp_path / "t", force=False)
    assert own.read_text() == "mine"
    write_templates(tmp_path / "t", force=True)
    assert own.read_bytes() == template_table("prices.csv")
    assert write_templates(tmp_path / "one.xlsx", force=False) == [tmp_path / "one.xlsx"]
    with pytest.raises(InputError, match="cannot be written"):
        write_templates(own / "below", force=False)
