"""The workbook: every table of a day as an Excel file, each cell a value and never a formula."""

import io
from collections.abc import Sequence
from datetime import datetime
from typing import Any

import xlsxwriter

from evdash.reports.account import Account
from evdash.reports.sheets import Sheet, sheets
from evdash.reports.words import limit_lines, period, promises_line

MOST_ROWS = 1_048_575
"""So many rows fit under a sheet's head."""
WIDEST, NARROWEST = 46, 9
SAMPLE = 200
CLOCK = "yyyy-mm-dd hh:mm"
AS_TEXT = {"strings_to_formulas": False, "strings_to_urls": False, "strings_to_numbers": False}
PUBLISHED = datetime(1980, 1, 1)
"""Every workbook says it was made then, so that the same day gives the same file."""


def workbook_bytes(account: Account) -> bytes:
    """The whole workbook as the bytes of an .xlsx."""
    target = io.BytesIO()
    book = xlsxwriter.Workbook(target, {"in_memory": True, "nan_inf_to_errors": False, **AS_TEXT})
    book.set_properties({"title": account.scenario.name, "created": PUBLISHED})
    looks = _Looks(book)
    found = sheets(account)
    about = book.add_worksheet("About")
    for sheet in found:
        _write(book.add_worksheet(sheet.name), sheet, looks)
    _about(about, account, found, looks)
    book.close()
    return target.getvalue()


class _Looks:
    """The workbook's cell formats, each made once."""

    def __init__(self, book: Any) -> None:
        self._book = book
        self._numbers: dict[str, Any] = {}
        self.title = book.add_format({"bold": True, "font_size": 16})
        self.head = book.add_format(
            {"bold": True, "text_wrap": True, "valign": "top", "bottom": 2, "bg_color": "#E8EEF4"}
        )
        self.wrapped = book.add_format({"text_wrap": True, "valign": "top"})
        self.bold = book.add_format({"bold": True, "valign": "top"})

    def number(self, number_format: str) -> Any:
        """The format of a column's numbers; None where Excel may choose."""
        if not number_format:
            return None
        if number_format not in self._numbers:
            self._numbers[number_format] = self._book.add_format({"num_format": number_format})
        return self._numbers[number_format]

    def put(self, page: Any, place: tuple[int, int], value: object, number_format: str) -> None:
        """One cell by its type; text is written as text whatever it begins with."""
        if isinstance(value, datetime):
            page.write_datetime(*place, value, self.number(CLOCK))
        elif isinstance(value, int | float):
            page.write_number(*place, value, self.number(number_format))
        elif value is not None:
            page.write_string(*place, str(value))


def _write(page: Any, sheet: Sheet, looks: _Looks) -> None:
    """One table: head with notes, rows, filter; its head stays in view."""
    fits = len(sheet.rows) <= MOST_ROWS
    rows = sheet.rows if fits else []
    for place, column in enumerate(sheet.columns):
        page.write_string(0, place, column.head, looks.head)
        if column.note:
            page.write_comment(0, place, column.note, {"x_scale": 1.6})
        cells = [row[place] for row in rows[:SAMPLE]]
        page.set_column(place, place, _width(column.head, cells))
        for r, row in enumerate(rows, 1):
            looks.put(page, (r, place), row[place], column.number_format)
    if not fits:
        told = (
            f"{len(sheet.rows):,} rows are more than a sheet holds; the run's own files have them"
        )
        page.write_string(1, 0, told)
    page.freeze_panes(1, 1)
    page.autofilter(0, 0, max(1, len(rows)), len(sheet.columns) - 1)
    page.set_landscape()
    page.fit_to_pages(1, 0)
    page.repeat_rows(0)


def _width(head: str, cells: Sequence[object]) -> float:
    def length(value: object) -> int:
        if isinstance(value, datetime):
            return len(CLOCK)
        return len(f"{value:.6g}" if isinstance(value, float) else str(value or ""))

    widest_word = max((len(word) for word in head.split()), default=0)
    wanted = max([widest_word + 3, *(length(cell) + 1 for cell in cells)])
    return float(min(WIDEST, max(NARROWEST, wanted)))


def _about(page: Any, account: Account, found: list[Sheet], looks: _Looks) -> None:
    """The first sheet: what this is, what came of it, what it was made with, what is where."""
    label = account.label
    page.set_column(0, 0, 24)
    page.set_column(1, 1, 110)
    page.write_string(0, 0, account.scenario.name, looks.title)
    page.write_string(1, 0, period(account.scenario))
    seed = "none" if label.seed is None else f"{label.seed}"
    lines: list[tuple[str, str]] = [
        *(("What came of it", text) for _, text in [promises_line(account), *limit_lines(account)]),
        ("Policy", label.policy),
        ("Network model", label.network),
        ("Seed", seed),
        ("Scenario, SHA-256", account.scenario_sha256),
        *((name, version) for name, version in account.versions.items()),
        (
            "Units",
            "stand in the heads in brackets or after a comma; heads have notes that say what "
            "a column means",
        ),
        ("Times", "are local times without a time zone; an interval's values are its means"),
        ("Money", "$"),
        ("Energy and power", "are those drawn from the grid"),
        *((f"Sheet {sheet.name}", sheet.told) for sheet in found),
    ]
    for row, (name, told) in enumerate(lines, 3):
        page.write_string(row, 0, name, looks.bold)
        page.write_string(row, 1, told, looks.wrapped)
