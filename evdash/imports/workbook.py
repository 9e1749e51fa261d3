"""Excel workbooks: bounded on the way in, safe on the way out.

A workbook is a .zip of XML. What it claims about its own size is not believed: entries are
counted and sized before anything is unpacked, rows and columns while they are read.
"""

import io
import math
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import MAXYEAR, date, datetime, time, timedelta
from typing import Any

import openpyxl
import xlsxwriter
from openpyxl.utils import get_column_letter
from openpyxl.utils.exceptions import InvalidFileException

from evdash.errors import Fault, InputError
from evdash.files.folder import UNZIPPABLE

MAX_ENTRIES = 500
PUBLISHED = datetime(1980, 1, 1)
"""Every workbook says it was made then, so that the same content gives the same file."""
MAX_UNPACKED = 64 * 1024 * 1024
MAX_MARKS = 4_000_000
"""Tags and attributes: what XML may be that is read into memory, about 600,000 cells."""
MAX_SHEETS = 30
MAX_ROWS = 100_000
MAX_COLUMNS = 200
MAX_CELLS = 2_000_000
MAX_FAULTS = 100
CHUNK = 1024 * 1024
OLD_OR_LOCKED = b"\xd0\xcf\x11\xe0"
"""What .xls files begin with, and workbooks with a password."""
UNREADABLE = (
    *UNZIPPABLE,
    OSError,  # a .zip without a workbook in it
    InvalidFileException,
    LookupError,
    SyntaxError,  # XML that is none
    TypeError,
    AttributeError,
    ArithmeticError,  # a date beyond the calendar
)
"""What openpyxl raises on files that are no workbooks, or broken ones."""
RULE = "should be an Excel workbook (.xlsx)"


def _moment_text(moment: datetime) -> str:
    """A moment to the second: a spreadsheet's are fractions of a day, and seldom exact."""
    if moment.microsecond and moment.year < MAXYEAR:
        moment = (moment + timedelta(milliseconds=500)).replace(microsecond=0)
    return moment.isoformat(timespec="seconds" if moment.second else "minutes")


TEXT_OF: Mapping[type, Callable[[Any], str]] = {
    bool: lambda value: str(value).lower(),
    datetime: _moment_text,
    date: lambda value: f"{value.isoformat()}T00:00",
    time: lambda value: f"{value:%H:%M}",
    float: repr,
}
"""How values of a cell are written; the first kind that fits counts."""
Cells = tuple[str, ...]
Sheet = list[Cells]


def is_workbook(name: str) -> bool:
    """Whether a file's name says it is an Excel workbook."""
    return name.lower().endswith((".xlsx", ".xlsm"))


def read_sheets(name: str, content: bytes) -> dict[str, Sheet]:
    """Every sheet's rows as text, blank ones included, so that rows count as in the sheet.

    Formulas count by the value last calculated; one without is a fault. Raises InputError where
    the file is no workbook or larger than allowed.
    """
    with _opened(name, content) as book:
        if len(book.sheetnames) > MAX_SHEETS:
            found = f"{len(book.sheetnames)} sheets"
            raise InputError([Fault(name, found, f"at most {MAX_SHEETS}")])
        sheets: dict[str, Sheet] = {}
        for sheet in book.worksheets:
            room = MAX_CELLS - sum(len(row) for rows in sheets.values() for row in rows)
            sheets[sheet.title] = _rows(name, sheet, room)
    if _has_formulas(content):
        _refuse_uncalculated(name, content, sheets)
    return sheets


def sheet_names(name: str, content: bytes) -> list[str]:
    """The sheets of a workbook by name; InputError where the file is none."""
    with _opened(name, content) as book:
        return [str(title) for title in book.sheetnames]


@contextmanager
def _opened(name: str, content: bytes, with_formulas: bool = False) -> Iterator[Any]:
    """A workbook to read from; whatever is wrong with it, then or while it is read, is told."""
    _refuse_bomb(name, content)
    book = None
    try:
        book = openpyxl.load_workbook(
            io.BytesIO(content), read_only=True, data_only=not with_formulas, keep_links=False
        )
        yield book
    except UNREADABLE as error:
        raise InputError([Fault(name, f"a file that cannot be read ({error})", RULE)]) from error
    finally:
        if book is not None:
            book.close()


def _refuse_bomb(name: str, content: bytes) -> None:
    """Refuse what is no workbook, or too much of one, before any of it is made into anything."""
    if content.startswith(OLD_OR_LOCKED):
        found = "an old workbook (.xls) or one with a password"
        raise InputError([Fault(name, found, f"{RULE}, without a password")])
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            entries = archive.infolist()
            size = sum(entry.file_size for entry in entries)
            if len(entries) > MAX_ENTRIES or size > MAX_UNPACKED:
                found = f"{len(entries)} parts of {size / 2**20:,.0f} MiB unpacked"
                rule = f"at most {MAX_ENTRIES} parts and {MAX_UNPACKED // 2**20} MiB"
                raise InputError([Fault(name, found, rule)])
            marks = sum(
                chunk.count(b"<") + chunk.count(b"=")
                for entry in entries
                for chunk in _chunks(archive, entry)
            )
    except UNZIPPABLE as error:
        raise InputError([Fault(name, f"a file that cannot be read ({error})", RULE)]) from error
    if marks > MAX_MARKS:
        rule = f"at most {MAX_MARKS:,}, about {MAX_MARKS // 6:,} cells"
        raise InputError([Fault(name, f"{marks:,} tags and attributes in its XML", rule)])


def _chunks(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> Iterator[bytes]:
    """A part of an archive piece by piece; no more of it than the size it was counted with."""
    with archive.open(entry) as part:
        while chunk := part.read(CHUNK):
            yield chunk


def _has_formulas(content: bytes) -> bool:
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        parts = [e for e in archive.infolist() if e.filename.startswith("xl/worksheets/")]
        return any(b"<f" in archive.read(entry) for entry in parts)


def _refuse_uncalculated(name: str, content: bytes, sheets: Mapping[str, Sheet]) -> None:
    """Refuse formulas whose value no spreadsheet has ever worked out: they would read as blanks."""
    rule = "should have a value: open and save it in a spreadsheet, or write the value itself"
    faults = []
    with _opened(name, content, with_formulas=True) as book:
        for sheet in book.worksheets:
            known = sheets[sheet.title]
            sheet.reset_dimensions()
            for number, cells in enumerate(sheet.iter_rows(values_only=True), 1):
                values = known[number - 1] if number <= len(known) else ()
                for place, formula in enumerate(cells):
                    if formula is None or (place < len(values) and values[place]):
                        continue
                    if not str(formula).strip():
                        continue
                    head = known[0][place] if known and place < len(known[0]) else ""
                    column = head if number > 1 and head else get_column_letter(place + 1)
                    where = f"{name}, sheet {sheet.title}, row {number}, column {column}"
                    faults.append(Fault(where, "a formula that was never calculated", rule))
    if faults:
        raise InputError(faults[:MAX_FAULTS])


def _rows(name: str, sheet: Any, room: int) -> Sheet:
    rows: Sheet = []
    sheet.reset_dimensions()  # what a sheet claims is not believed
    for cells in sheet.iter_rows(values_only=True):
        room -= len(cells)
        if len(rows) >= MAX_ROWS or len(cells) > MAX_COLUMNS or room < 0:
            found = f"{len(rows) + 1:,} rows or more, {len(cells):,} columns"
            rule = f"at most {MAX_ROWS:,} rows, {MAX_COLUMNS} columns, {MAX_CELLS:,} cells in all"
            raise InputError([Fault(f"{name}, sheet {sheet.title}", found, rule)])
        rows.append(tuple(cell_text(cell) for cell in cells))
    while rows and not any(rows[-1]):
        rows.pop()
    return rows


def cell_text(value: object) -> str:
    """A cell as a CSV file would have it; whole numbers without a fraction."""
    if isinstance(value, float) and value.is_integer() and abs(value) < 2**53:
        return repr(int(value))
    for kind, told in TEXT_OF.items():
        if isinstance(value, kind):
            return told(value)
    return "" if value is None else str(value).strip()


def written(
    sheets: Mapping[str, Sequence[Sequence[object]]],
    notes: Mapping[str, Mapping[str, str]] | None = None,
) -> bytes:
    """Sheets of rows, the first a header, as a workbook; no text becomes a formula or a link.

    `notes` are put to heads: sheet to head to text.
    """
    target = io.BytesIO()
    safe = {
        "in_memory": True,
        "strings_to_formulas": False,
        "strings_to_urls": False,
        "default_date_format": "yyyy-mm-dd hh:mm",
    }
    with xlsxwriter.Workbook(target, safe) as book:
        book.set_properties({"created": PUBLISHED})
        bold = book.add_format({"bold": True})
        for title, rows in sheets.items():
            sheet = book.add_worksheet(title)
            for number, row in enumerate(rows):
                for column, cell in enumerate(row):
                    if isinstance(cell, float) and not math.isfinite(cell):
                        sheet.write_string(number, column, str(cell))  # no number to Excel
                    elif isinstance(cell, str):
                        sheet.write_string(number, column, cell, None if number else bold)
                    elif cell is not None:
                        sheet.write(number, column, cell)
            told = (notes or {}).get(title, {})
            for column, head in enumerate(rows[0] if rows else ()):
                if str(head) in told:
                    sheet.write_comment(0, column, told[str(head)], {"x_scale": 1.6})
            sheet.freeze_panes(1, 0)
            sheet.autofit(300)
    return target.getvalue()
