"""Excel workbooks: bounded on the way in, safe on the way out.

A workbook is a .zip of XML. What it claims about its own size is not believed: entries are
counted and sized before anything is unpacked, rows and columns while they are read.
"""

import io
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import MAXYEAR, date, datetime, time, timedelta
from typing import Any

import openpyxl
import xlsxwriter
from openpyxl.utils.exceptions import InvalidFileException

from evdash.errors import Fault, InputError
from evdash.files.draft import RECORDS, Draft, Row, files_of, settings_text
from evdash.files.folder import UNZIPPABLE
from evdash.files.overrides import parse_setting
from evdash.files.scenario_folder import SETTINGS
from evdash.files.tables import write_table
from evdash.files.validate import Raw
from evdash.files.wording import shown

MAX_ENTRIES = 500
MAX_UNPACKED = 64 * 1024 * 1024
MAX_SHEETS = 30
MAX_ROWS = 100_000
MAX_COLUMNS = 200
SETTINGS_SHEET = "scenario"
SHEETS = {file.removesuffix(".csv"): file for file in RECORDS}
"""Sheets of a scenario workbook and the files they stand for; beside them SETTINGS_SHEET."""
UNREADABLE = (
    *UNZIPPABLE,
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

    Formulas count by the value last calculated. Raises InputError where the file is no workbook
    or larger than allowed.
    """
    with _opened(name, content) as book:
        if len(book.sheetnames) > MAX_SHEETS:
            found = f"{len(book.sheetnames)} sheets"
            raise InputError([Fault(name, found, f"at most {MAX_SHEETS}")])
        return {sheet.title: _rows(name, sheet) for sheet in book.worksheets}


def sheet_names(name: str, content: bytes) -> list[str]:
    """The sheets of a workbook by name; InputError where the file is none."""
    with _opened(name, content) as book:
        return [str(title) for title in book.sheetnames]


@contextmanager
def _opened(name: str, content: bytes) -> Iterator[Any]:
    """A workbook to read from; whatever is wrong with it, then or while it is read, is told."""
    _refuse_bomb(name, content)
    book = None
    try:
        book = openpyxl.load_workbook(
            io.BytesIO(content), read_only=True, data_only=True, keep_links=False
        )
        yield book
    except UNREADABLE as error:
        raise InputError([Fault(name, f"a file that cannot be read ({error})", RULE)]) from error
    finally:
        if book is not None:
            book.close()


def _refuse_bomb(name: str, content: bytes) -> None:
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            entries = archive.infolist()
            size = sum(entry.file_size for entry in entries)
    except UNZIPPABLE as error:
        raise InputError([Fault(name, f"a file that cannot be read ({error})", RULE)]) from error
    if len(entries) > MAX_ENTRIES or size > MAX_UNPACKED:
        found = f"{len(entries)} parts of {size / 2**20:,.0f} MiB unpacked"
        rule = f"at most {MAX_ENTRIES} parts and {MAX_UNPACKED // 2**20} MiB"
        raise InputError([Fault(name, found, rule)])


def _rows(name: str, sheet: Any) -> Sheet:
    rows: Sheet = []
    sheet.reset_dimensions()  # what a sheet claims is not believed
    for cells in sheet.iter_rows(values_only=True):
        if len(rows) >= MAX_ROWS or len(cells) > MAX_COLUMNS:
            found = f"{len(rows) + 1:,} rows or more, {len(cells):,} columns"
            rule = f"at most {MAX_ROWS:,} rows and {MAX_COLUMNS} columns"
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


def scenario_parts(name: str, content: bytes) -> dict[str, bytes]:
    """The files of a scenario folder that a workbook's sheets stand for.

    Faults name sheets; unknown sheets are faults, one named `README` apart.
    """
    sheets = read_sheets(name, content)
    faults = []
    files: dict[str, bytes] = {}
    for title, rows in sheets.items():
        key = title.strip().lower()
        if key == SETTINGS_SHEET:
            settings, found = _settings(f"{name}, sheet {title}", rows)
            faults += found
            files[SETTINGS] = settings_text(settings).encode()
        elif key in SHEETS:
            files[SHEETS[key]] = _csv(rows).encode()
        elif key != "readme":
            known = ", ".join([SETTINGS_SHEET, *SHEETS])
            faults.append(
                Fault(f"{name}, sheet {title}", "an unknown sheet", f"sheets are {known}")
            )
    if not files and not faults:
        faults.append(Fault(name, "no sheet with rows", f"sheets are {', '.join(SHEETS)}"))
    if faults:
        raise InputError(faults)
    return files


def in_sheets(name: str, faults: Iterable[Fault]) -> list[Fault]:
    """Faults of a scenario's files by the sheets of the workbook they came in."""
    told = {SETTINGS: SETTINGS_SHEET, **{file: sheet for sheet, file in SHEETS.items()}}
    placed = []
    for fault in faults:
        file, comma, rest = fault.place.partition(",")
        sheet = told.get(file)
        place = f"{name}, sheet {sheet}{comma}{rest}" if sheet else f"{name}: {fault.place}"
        placed.append(Fault(place, fault.found, fault.allowed))
    return placed


def _csv(rows: Sheet) -> str:
    """Rows as CSV text, all as wide as the header; blank rows stay, to keep the count."""
    width = max((i + 1 for i, cell in enumerate(rows[0]) if cell), default=0) if rows else 0
    lines = []
    for cells in rows:
        if not any(cells):
            lines.append("\n")
            continue
        wide = max((i + 1 for i, cell in enumerate(cells) if cell), default=0)
        padded = [*cells[: max(width, wide)], *[""] * (width - len(cells))]
        lines.append(write_table(padded, ()))
    return "".join(lines)


def _settings(place: str, rows: Sheet) -> tuple[Raw, list[Fault]]:
    """The keys and values of a settings sheet as nested tables."""
    faults: list[Fault] = []
    raw: Raw = {}
    if not rows or [cell.lower() for cell in rows[0][:2]] != ["key", "value"]:
        return {}, [Fault(f"{place}, row 1", "another header", "columns are key and value")]
    for number, cells in enumerate(rows[1:], 2):
        key, value = (*cells, "", "")[:2]
        if not key:
            continue
        if not value:
            continue
        try:
            _lay(raw, key.split("."), parse_setting(f"{key}={value}").value)
        except (InputError, TypeError):
            rule = "should be a key of scenario.toml, options by name: option.C1.average_kw"
            faults.append(Fault(f"{place}, row {number}, column key", shown(key), rule))
    if "option" in raw:
        options = raw["option"]
        named = isinstance(options, dict) and all(isinstance(o, dict) for o in options.values())
        if named:
            raw["option"] = [{"name": name} | option for name, option in options.items()]
    return raw, faults


def _lay(node: Raw, path: list[str], value: object) -> None:
    for part in path[:-1]:
        node = node.setdefault(part, {})
        if not isinstance(node, dict):
            raise TypeError
    node[path[-1]] = value


def scenario_workbook(draft: Draft) -> bytes:
    """A draft as a workbook that reads back the same."""
    sheets: dict[str, Sequence[Sequence[object]]] = {SETTINGS_SHEET: _settings_rows(draft.settings)}
    used = files_of(draft)
    for sheet, file in SHEETS.items():
        if file in used:
            sheets[sheet] = _table_rows(file, draft.tables.get(file, ()))
    return written(sheets)


def _table_rows(file: str, rows: Sequence[Row]) -> list[list[object]]:
    columns = list(RECORDS[file].model_fields)
    return [list(columns), *([_number_or_text(c, row[c]) for c in columns] for row in rows)]


def _number_or_text(column: str, cell: str) -> object:
    """A number where the column holds numbers, so that a spreadsheet can reckon with it."""
    texts = ("node", "from_node", "to_node", "model", "vehicle", "option", "arrival")
    if column in (*texts, "event", "subject"):
        return cell
    try:
        number = float(cell)
    except ValueError:
        return cell
    return int(number) if number.is_integer() and abs(number) < 2**53 else number


def _settings_rows(settings: Raw) -> list[list[object]]:
    rows: list[list[object]] = [["key", "value"]]

    def lay(prefix: str, value: object) -> None:
        if prefix == "option" and isinstance(value, list):
            for option in value:
                for key, inner in option.items():
                    if key != "name":
                        lay(f"option.{option.get('name')}.{key}", inner)
        elif isinstance(value, dict):
            for key, inner in value.items():
                lay(f"{prefix}.{key}" if prefix else key, inner)
        elif isinstance(value, list):
            rows.append([prefix, f"[{', '.join(repr(part) for part in value)}]"])
        elif hasattr(value, "strftime"):
            rows.append([prefix, value.strftime("%Y-%m-%dT%H:%M")])
        else:
            rows.append([prefix, value])

    lay("", settings)
    return rows


def written(sheets: Mapping[str, Sequence[Sequence[object]]]) -> bytes:
    """Sheets of rows, the first a header, as a workbook; no text becomes a formula or a link."""
    target = io.BytesIO()
    safe = {
        "in_memory": True,
        "strings_to_formulas": False,
        "strings_to_urls": False,
        "default_date_format": "yyyy-mm-dd hh:mm",
    }
    with xlsxwriter.Workbook(target, safe) as book:
        bold = book.add_format({"bold": True})
        for title, rows in sheets.items():
            sheet = book.add_worksheet(title)
            for number, row in enumerate(rows):
                for column, cell in enumerate(row):
                    if isinstance(cell, str):
                        sheet.write_string(number, column, cell, None if number else bold)
                    elif cell is not None:
                        sheet.write(number, column, cell)
            sheet.freeze_panes(1, 0)
            sheet.autofit(300)
    return target.getvalue()
