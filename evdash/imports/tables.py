"""Tables of any columns, from CSV, Excel or JSON records, as text with the place of each row."""

import csv
import re
from dataclasses import dataclass, replace
from typing import Any

from evdash.errors import Fault, InputError
from evdash.files.tables import BoundedLines, decode
from evdash.imports.pandapower_json import decoded_json
from evdash.imports.workbook import MAX_COLUMNS, MAX_ROWS, is_workbook, read_sheets

MAX_BYTES = 32 * 1024 * 1024
DECIMAL_COMMA = re.compile(r"[+-]?(\d{1,3}(\.\d{3})+|\d+)(,\d+)?")
NESTED = ("userInputs",)


@dataclass(frozen=True, slots=True)
class ForeignTable:
    """Rows of text by column. `places` says where each row stands, `mine.csv, row 7`, `notices`
    what was done to read it."""

    name: str
    columns: tuple[str, ...]
    rows: tuple[dict[str, str], ...]
    places: tuple[str, ...]
    notices: tuple[str, ...] = ()


def read_foreign(name: str, content: bytes, sheet: str | None = None) -> ForeignTable:
    """The table in a file; InputError where there is none or it is too large."""
    if len(content) > MAX_BYTES:
        size = f"{len(content) / 2**20:.1f} MiB"
        raise InputError([Fault(name, size, f"at most {MAX_BYTES // 2**20} MiB")])
    if is_workbook(name):
        return _from_workbook(name, content, sheet)
    if name.lower().endswith(".json"):
        return _from_records(name, decoded_json(name, content))
    text, faults = decode(name, content)
    if faults:
        raise InputError(faults)
    return _from_csv(name, text)


def _from_csv(name: str, text: str) -> ForeignTable:
    head = text[:5000].partition("\n")[0]
    delimiter = max(",;\t", key=head.count)
    bounded = BoundedLines(text)
    lines = []
    try:
        for cells in csv.reader(bounded, delimiter=delimiter, strict=True):
            bounded.begun()
            lines.append(cells)
            if len(lines) > MAX_ROWS:
                raise InputError([Fault(name, f"more than {MAX_ROWS:,} rows", "at most so many")])
    except csv.Error as error:
        rule = "should be a table with a header"
        raise InputError([Fault(name, f"text that is no CSV ({error})", rule)]) from error
    table = _table(name, name, lines)
    return table if delimiter == "," else _with_points(table)


def _with_points(table: ForeignTable) -> ForeignTable:
    """The table with decimal points, where a column has decimal commas: `1.234,5` is 1234.5."""
    columns = [
        column
        for column in table.columns
        if (told := [row[column] for row in table.rows if "," in row[column]])
        and all(DECIMAL_COMMA.fullmatch(cell) for cell in told)
    ]
    if not columns:
        return table
    rows = tuple(
        row | {c: _point(row[c]) for c in columns if DECIMAL_COMMA.fullmatch(row[c])}
        for row in table.rows
    )
    notice = f"Commas are decimal signs in {', '.join(columns)}."
    return replace(table, rows=rows, notices=(notice,))


def _point(text: str) -> str:
    return text.replace(".", "").replace(",", ".")


def read_foreign_sheets(name: str, content: bytes) -> dict[str, ForeignTable]:
    """Every table in a file by its sheet, that of any other file by a blank.

    InputError where there is none; sheets that hold no table are left out beside one that does.
    """
    if not is_workbook(name):
        return {"": read_foreign(name, content)}
    tables: dict[str, ForeignTable] = {}
    faults: list[Fault] = []
    for title, rows in read_sheets(name, content).items():
        try:
            tables[title] = _table(name, f"{name}, sheet {title}", [list(row) for row in rows])
        except InputError as error:
            faults += error.faults
    if not tables:
        raise InputError(faults)
    return tables


def _from_workbook(name: str, content: bytes, sheet: str | None) -> ForeignTable:
    sheets = {title: rows for title, rows in read_sheets(name, content).items() if rows}
    if sheet is None and len(sheets) > 1:
        found = f"sheets {', '.join(sheets)}"
        raise InputError([Fault(name, found, "should have one sheet, or say which one is meant")])
    title = sheet or next(iter(sheets), "")
    if title not in sheets:
        known = f"sheets with rows are {', '.join(sheets) or 'none'}"
        raise InputError([Fault(name, f"no sheet {title!r}", known)])
    return _table(name, f"{name}, sheet {title}", [list(row) for row in sheets[title]])


def _table(name: str, place: str, lines: list[list[str]]) -> ForeignTable:
    if len(lines) > MAX_ROWS:
        raise InputError([Fault(place, f"{len(lines):,} rows", f"at most {MAX_ROWS:,}")])
    header = tuple(cell.strip() for cell in lines[0]) if lines else ()
    while header and not header[-1]:
        header = header[:-1]
    faults = []
    if not header or len(lines) < 2:
        faults.append(Fault(place, "no rows", "should be a header and rows below it"))
    if len(header) > MAX_COLUMNS:
        raise InputError([Fault(place, f"{len(header):,} columns", f"at most {MAX_COLUMNS}")])
    for column in sorted({column for column in header if header.count(column) > 1}):
        faults.append(Fault(f"{place}, row 1", f"column {column!r} twice", "each column once"))
    rows, places = [], []
    for number, cells in enumerate(lines[1:], 2):
        if not any(cell.strip() for cell in cells):
            continue
        if any(cell.strip() for cell in cells[len(header) :]):
            rule = f"at most {len(header)}, as in the header"
            faults.append(Fault(f"{place}, row {number}", f"{len(cells)} cells", rule))
        padded = [*cells, *[""] * (len(header) - len(cells))]
        rows.append({column: padded[i].strip() for i, column in enumerate(header)})
        places.append(f"{place}, row {number}")
    if faults:
        raise InputError(faults[:100])
    return ForeignTable(name, header, tuple(rows), tuple(places))


def _from_records(name: str, data: Any) -> ForeignTable:
    """JSON records: a list, or ACN-Data's `_items`; a driver's last input counts."""
    records = data.get("_items", data.get("sessions")) if isinstance(data, dict) else data
    if not isinstance(records, list) or not records:
        rule = "should be a list of records, or ACN-Data's with _items"
        raise InputError([Fault(name, "JSON without records", rule)])
    if len(records) > MAX_ROWS:
        raise InputError([Fault(name, f"{len(records):,} records", f"at most {MAX_ROWS:,}")])
    rows, columns = [], dict[str, None]()
    for number, record in enumerate(records, 1):
        if not isinstance(record, dict):
            raise InputError([Fault(f"{name}, record {number}", "no object", "should be one")])
        row: dict[str, str] = {}
        for key, value in record.items():
            if key in NESTED and isinstance(value, list) and value:
                last = value[-1] if isinstance(value[-1], dict) else {}
                row |= {f"{key}.{k}": _plain(v) for k, v in last.items()}
            else:
                row[str(key)] = _plain(value)
        columns |= dict.fromkeys(row)
        rows.append(row)
    if len(columns) > MAX_COLUMNS:
        raise InputError([Fault(name, f"{len(columns)} fields", f"at most {MAX_COLUMNS}")])
    full = tuple({column: row.get(column, "") for column in columns} for row in rows)
    places = tuple(f"{name}, record {number}" for number in range(1, len(rows) + 1))
    return ForeignTable(name, tuple(columns), full, places)


def _plain(value: Any) -> str:
    if value is None or isinstance(value, dict | list):
        return ""
    return str(value).lower() if isinstance(value, bool) else str(value)
