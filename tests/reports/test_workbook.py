"""The workbook, opened again by openpyxl: values true, typed, and never a formula."""

import csv
import io
from datetime import datetime

import openpyxl
import pytest

from evdash.files.draft import Draft, scenario_of
from evdash.files.scenario_folder import resolved
from evdash.horizon.day import run_day, start_day
from evdash.imports.scenario_book import (
    RUN_SHEETS,
    SETTINGS_SHEET,
    SHEETS,
    read_book,
    with_book,
)
from evdash.metrics.records import vehicle_records
from evdash.metrics.service import totals
from evdash.reports.sheets import sheets
from evdash.reports.workbook import workbook_bytes
from evdash.scheduling.p1 import p1_policy
from tests.reports.conftest import HOSTILE

STARTS = ("=", "+", "-", "@", "\t", "\r")


@pytest.fixture(scope="module")
def book(usual):
    return openpyxl.load_workbook(io.BytesIO(workbook_bytes(usual)))


@pytest.fixture(scope="module")
def hostile_book(hostile):
    return openpyxl.load_workbook(io.BytesIO(workbook_bytes(hostile)))


def rows_of(sheet) -> list[list[object]]:
    return [[cell.value for cell in row] for row in sheet.iter_rows(min_row=2)]


def csv_of(account, name: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(account.files[name])))


@pytest.mark.parametrize(
    ("sheet", "file"),
    [
        ("Intervals", "intervals.csv"),
        ("Vehicles", "vehicles.csv"),
        ("Ledger", "ledger.csv"),
        ("Power", "power.csv"),
        ("Voltages", "voltages.csv"),
        ("nodes", "scenario/nodes.csv"),
        ("lines", "scenario/lines.csv"),
        ("profile", "scenario/profile.csv"),
        ("arrivals", "scenario/arrivals.csv"),
    ],
)
def test_tables_hold_what_the_runs_files_hold_to_sixteen_digits(usual, book, sheet, file):
    told = csv_of(usual, file)
    rows = rows_of(book[sheet])
    assert len(rows) == len(told)
    for row, wanted in zip(rows, told, strict=True):
        for value, text in zip(row, wanted.values(), strict=False):
            if isinstance(value, datetime):
                assert value == datetime.fromisoformat(text)
            elif isinstance(value, int | float):
                assert value == pytest.approx(float(text), rel=1e-15, abs=1e-15)
            else:
                assert (value or "") == text


def test_heads_have_units_and_notes_and_stay_in_view(book):
    heads = list(book["Intervals"][1])
    assert "station kw [kW]" in [cell.value for cell in heads]
    assert "price per kwh [$/kWh]" in [cell.value for cell in heads]
    assert all(cell.comment and cell.comment.text for cell in heads)
    for sheet in book.worksheets[1:]:
        assert sheet.freeze_panes == "B2", sheet.title
        assert sheet.auto_filter.ref, sheet.title


def test_times_are_times_and_numbers_are_shown_with_their_units_digits(book, usual):
    vehicles = book["Vehicles"]
    heads = [cell.value for cell in vehicles[1]]
    first = vehicle_records(usual.trace)[0].request
    back = vehicles.cell(2, heads.index("Back by") + 1)
    assert back.is_date
    assert back.value == usual.scenario.time_of(first.deadline_interval)
    energy = vehicles.cell(2, heads.index("need kwh [kWh]") + 1)
    assert energy.number_format == "#,##0.00"
    assert energy.value == pytest.approx(first.need_kwh, rel=1e-15)


def test_totals_can_be_worked_out_again_from_the_sheets(book, usual):
    heads = [cell.value for cell in book["Vehicles"][1]]
    revenue = sum(row[heads.index("revenue [$]")] for row in rows_of(book["Vehicles"]))
    assert revenue == pytest.approx(usual.totals.revenue)
    figures = {row[0]: row[1] for row in rows_of(book["Figures"])}
    assert figures["Profit"] == pytest.approx(usual.totals.profit)
    drawn = sum(row[2] for row in rows_of(book["Power"])) * usual.scenario.interval_hours
    assert figures["Energy delivered"] == pytest.approx(drawn)


def test_the_first_sheet_says_what_is_where(book, usual):
    about = {row[0].value: row[1].value for row in book["About"].iter_rows(min_row=4)}
    assert about["Scenario, SHA-256"] == usual.scenario_sha256
    for sheet in book.sheetnames[1:]:
        assert about[f"Sheet {sheet}"]


def test_no_cell_is_a_formula_a_link_or_an_error(hostile_book, hostile):
    texts = []
    for sheet in hostile_book.worksheets:
        for row in sheet.iter_rows():
            for cell in row:
                assert cell.data_type in "snd", (sheet.title, cell.coordinate)
                assert cell.hyperlink is None
                if cell.data_type == "s":
                    texts.append(cell.value)
    assert f"={HOSTILE}" in texts  # as text, not as what it would be taken for


def test_no_cell_of_the_csv_tables_could_start_a_formula(hostile):
    for name, text in hostile.files.items():
        if not name.endswith(".csv"):
            continue
        for row in csv.reader(io.StringIO(text)):
            for cell in row:
                if cell.startswith(STARTS):
                    float(cell)  # a number with its sign, and nothing else


def close(one: object, other: object) -> bool:
    """Whether two scenarios' contents are the same to the 16 digits of a workbook."""
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(close(one[key], other[key]) for key in one)
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        return len(one) == len(other) and all(map(close, one, other))
    return one == (pytest.approx(other, rel=1e-15) if isinstance(other, float) else other)


@pytest.mark.parametrize("which", ["usual", "hostile"])
def test_a_runs_workbook_is_taken_in_again_and_gives_the_same_day(which, request):
    account = request.getfixturevalue(which)
    content = workbook_bytes(account)
    draft, told = with_book(Draft({}, {}), read_book("run.xlsx", content))
    scenario = scenario_of(draft)
    inputs = account.trace.inputs
    wanted = resolved(inputs.given, inputs.arrivals)
    assert close(scenario.model_dump(), wanted.model_dump())
    assert not close(scenario.model_dump(), wanted.replacing(name="another").model_dump())
    assert "What came of a day is left out: About, Figures" in " ".join(told)
    again = run_day(start_day(scenario), p1_policy())
    assert totals(again).profit == pytest.approx(account.totals.profit, abs=0.02)
    assert totals(again).admitted == account.totals.admitted


def test_every_sheet_is_known_on_the_way_in(usual):
    names = {sheet.name for sheet in sheets(usual)} | {"About"}
    assert names - {SETTINGS_SHEET, *SHEETS} == RUN_SHEETS


def test_the_same_day_gives_the_same_workbook(usual):
    assert workbook_bytes(usual) == workbook_bytes(usual)
