"""Scenarios as workbooks: back the same, and every fault by sheet, row and column."""

from typing import Any

import pytest

from evdash.domain.arrivals import RecordedArrivals
from evdash.errors import InputError
from evdash.files.bundled import DEFAULT, bundled_scenarios
from evdash.files.draft import Draft, draft_of, scenario_of
from evdash.files.scenario_folder import read_scenario
from evdash.imports.scenario_book import (
    KEY,
    SETTINGS_SHEET,
    SHEETS,
    VALUE,
    read_book,
    scenario_workbook,
    settings_rows,
    table_rows,
    with_book,
)
from evdash.imports.workbook import written
from tests.builders import generator, make_scenario, vehicle

Sheets = dict[str, list[list[object]]]


def sheets_of(draft: Draft) -> Sheets:
    """A scenario's sheets, to be changed."""
    sheets: Sheets = {SETTINGS_SHEET: [[KEY, VALUE], *settings_rows(draft.settings)]}
    return sheets | {
        sheet: table_rows(file, draft.tables[file])
        for sheet, file in SHEETS.items()
        if draft.tables.get(file)
    }


def taken_in(sheets: Sheets, base: Draft | None = None) -> tuple[Draft, str, Any]:
    book = read_book("mine.xlsx", written(sheets))
    draft, told = with_book(base or draft_of(read_scenario(DEFAULT)), book)
    return draft, " ".join(told), book


def faults_of(sheets: Sheets) -> set[str]:
    """Where the faults of a workbook are, whichever step finds them."""
    try:
        draft, _, book = taken_in(sheets)
    except InputError as error:
        return {fault.place for fault in error.faults}
    with pytest.raises(InputError) as error:
        scenario_of(draft)
    return {fault.place for fault in book.placed(error.value.faults)}


@pytest.mark.parametrize("folder", bundled_scenarios(), ids=lambda path: path.name)
def test_every_preset_comes_back_the_same(folder: Any) -> None:
    scenario = read_scenario(folder)
    book = read_book("x.xlsx", scenario_workbook(draft_of(scenario)))
    assert scenario_of(with_book(Draft({}, {}), book)[0]) == scenario


def test_options_with_dots_in_their_names_come_back() -> None:
    options = [
        {"name": "Fast.1", "price_per_kwh": 0.4, "average_kw": 8.0},
        {"name": "Slow = cheap", "price_per_kwh": 0.3, "average_kw": 4.0},
    ]
    drawn = generator(option_share={"Fast.1": 0.25, "Slow = cheap": 0.75})
    scenario = make_scenario(options=options, arrivals=drawn)
    book = read_book("x.xlsx", scenario_workbook(draft_of(scenario)))
    again = scenario_of(with_book(Draft({}, {}), book)[0])
    assert again.option == scenario.option
    assert again.arrivals == scenario.arrivals


def test_faults_are_told_by_sheet_row_and_column_blank_rows_and_all() -> None:
    draft = draft_of(read_scenario(DEFAULT))
    sheets = sheets_of(draft)
    sheets["nodes"].insert(3, [])
    sheets["nodes"].insert(5, [None, None])
    sheets["nodes"][6][1] = "lots"
    sheets["Lines"] = sheets.pop("lines")
    sheets["Lines"][2][2] = -1.0
    keys = [row[0] for row in sheets[SETTINGS_SHEET]]
    at = keys.index("station.chargers")
    sheets[SETTINGS_SHEET][at][1] = -4
    sheets[SETTINGS_SHEET].insert(2, [])
    assert faults_of(sheets) == {
        "mine.xlsx, sheet nodes, row 7, column load_kw",
        "mine.xlsx, sheet Lines, row 3, column r_ohm",
        f"mine.xlsx, sheet scenario, row {at + 2}, station.chargers",
    }


def changed(sheet: str, row: int, column: int, value: object) -> Sheets:
    sheets = sheets_of(draft_of(read_scenario(DEFAULT)))
    sheets[sheet][row][column] = value
    return sheets


@pytest.mark.parametrize(
    ("sheets", "place"),
    [
        (changed("nodes", 0, 1, "colour"), "mine.xlsx, sheet nodes, header"),
        (changed("profile", 3, 1, None), "mine.xlsx, sheet profile, row 4, column price_per_kwh"),
        (changed("scenario", 2, 0, "station"), "mine.xlsx, sheet scenario, row 16, column key"),
        (changed("scenario", 0, 0, "name"), "mine.xlsx, sheet scenario, row 1"),
        (
            changed("scenario", 5, 0, "format"),
            "mine.xlsx, sheet scenario, row 6, column key",
        ),
        ({"nodse": [["node"], ["a"]]}, "mine.xlsx, sheet nodse"),
        ({"notes": []}, "mine.xlsx, sheet notes"),
        ({"README": [["hello"]]}, "mine.xlsx"),
    ],
)
def test_what_is_wrong_with_a_sheet_is_told_by_its_place(sheets: Sheets, place: str) -> None:
    assert place in faults_of(sheets)


def test_a_key_that_is_missing_is_told_by_the_settings_sheet() -> None:
    sheets = sheets_of(draft_of(read_scenario(DEFAULT)))
    sheets["scenario"] = [row for row in sheets["scenario"] if row[0] != "station.chargers"]
    assert "mine.xlsx, sheet scenario, station.chargers" in faults_of(sheets)


def test_listed_vehicles_take_the_place_of_drawn_ones_and_that_is_told() -> None:
    base = draft_of(read_scenario(DEFAULT))
    listed = make_scenario(vehicles=[vehicle("V1", 2.0)])
    rows = table_rows("arrivals.csv", draft_of(listed).tables["arrivals.csv"])
    rows[1][1] = "08:15"
    draft, told, _ = taken_in({"arrivals": rows}, base)
    scenario = scenario_of(draft)
    assert isinstance(scenario.arrivals, RecordedArrivals)
    assert [v.vehicle for v in scenario.arrivals.vehicles] == ["V1"]
    assert scenario.arrivals.forecast is not None
    assert scenario.arrivals.forecast.fleet == read_scenario(DEFAULT).arrivals.fleet  # type: ignore[union-attr]
    assert "Vehicles come from arrivals.csv now" in told
