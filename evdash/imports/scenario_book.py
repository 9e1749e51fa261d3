"""A scenario as an Excel workbook: a sheet for its settings and one for each of its tables.

A run's workbook (`evdash.reports`) has these sheets, too, beside those that say what came of the
day; it can be taken in again like any other.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from evdash.errors import Fault, InputError
from evdash.files.draft import (
    RECORDS,
    Draft,
    Row,
    files_of,
    read_rows,
    read_settings,
    recorded,
    settings_text,
)
from evdash.files.overrides import setting_of
from evdash.files.scenario_folder import SETTINGS
from evdash.files.tables import write_table
from evdash.files.validate import Raw
from evdash.files.wording import shown
from evdash.imports.workbook import Sheet, read_sheets, written

SETTINGS_SHEET = "scenario"
SHEETS = {file.removesuffix(".csv"): file for file in RECORDS}
"""Sheets of a scenario workbook and the files they stand for; beside them SETTINGS_SHEET."""
RUN_SHEETS = frozenset({
    "About", "Figures", "Intervals", "Vehicles", "Ledger", "Power", "Voltages", "Options",
    "Refusals", "Limits exceeded", "Voltages beyond", "Loading beyond", "Lowest voltages",
    "Highest loadings", "Ageing", "Ageing assumes",
})  # fmt: skip
"""Sheets that say what came of a day: left out on the way in."""
NOTES_SHEET = "README"
KEY, VALUE = "key", "value"
NOT_NUMBERS = (
    "node", "from_node", "to_node", "model", "vehicle", "option", "arrival", "event", "subject",
)  # fmt: skip
"""Columns that hold text, though it may look like a number."""


@dataclass(frozen=True, slots=True)
class ScenarioBook:
    """The files that a workbook's sheets stand for, and where in it everything stands.

    `titles` names each file's sheet, `rows` tells each table's rows by their numbers in it and
    `keys` each setting's. `left_out` are sheets of a run. Of a whole book any setting that is
    not there is told by its sheet; of a part of it only those it has.
    """

    name: str
    files: Mapping[str, bytes] = field(default_factory=dict)
    titles: Mapping[str, str] = field(default_factory=dict)
    rows: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    keys: Mapping[str, int] = field(default_factory=dict)
    left_out: tuple[str, ...] = ()
    is_whole: bool = True

    def of_feeder(self) -> "ScenarioBook":
        """The part of it that is about the feeder and the station's node."""
        tables = {file: title for file, title in self.titles.items() if file in FEEDER_FILES}
        keys = {k: row for k, row in self.keys.items() if k.startswith("feeder.") or k == STATION}
        return replace(self, titles=tables, keys=keys, is_whole=False)

    def placed(self, faults: Iterable[Fault]) -> list[Fault]:
        """Faults of the files by sheet, row and column of the workbook."""
        return [Fault(self._place(fault.place), fault.found, fault.allowed) for fault in faults]

    def _place(self, place: str) -> str:
        file, _, rest = place.partition(", ")
        if file not in self.titles:
            return place
        sheet = f"{self.name}, sheet {self.titles[file]}"
        if file == SETTINGS:
            key, comma, entry = rest.partition(", ")
            if key in self.keys:
                return f"{sheet}, row {self.keys[key]}, {key}{comma}{entry}"
            if not self.is_whole:
                return place
        else:
            numbers = self.rows[file]
            row = re.match(r"row (\d+)", rest)
            if row and 2 <= int(row[1]) < 2 + len(numbers):
                rest = f"row {numbers[int(row[1]) - 2]}{rest[row.end() :]}"
        return f"{sheet}, {rest}" if rest else sheet


FEEDER_FILES = ("nodes.csv", "lines.csv", SETTINGS)
STATION = "station.node"


def read_book(name: str, content: bytes) -> ScenarioBook:
    """The scenario's parts in a workbook; InputError names unknown sheets and settings."""
    faults: list[Fault] = []
    book = ScenarioBook(name)
    for title, rows in read_sheets(name, content).items():
        key = title.strip().lower()
        file = SETTINGS if key == SETTINGS_SHEET else SHEETS.get(key)
        if file in book.files:
            faults.append(Fault(f"{name}, sheet {title}", "a second one of it", "each sheet once"))
        elif file == SETTINGS:
            settings, keys, found = _settings(f"{name}, sheet {title}", rows)
            faults += found
            book = _with(book, file, title, settings_text(settings), ())
            book = replace(book, keys=keys)
        elif file is not None:
            text, numbers = _csv(rows)
            book = _with(book, file, title, text, numbers)
        elif title in RUN_SHEETS:
            book = replace(book, left_out=(*book.left_out, title))
        elif key != NOTES_SHEET.lower():
            known = f"sheets are {', '.join([SETTINGS_SHEET, *SHEETS])}"
            faults.append(Fault(f"{name}, sheet {title}", "an unknown sheet", known))
    if not book.files and not faults:
        faults.append(Fault(name, "no sheet of a scenario", f"sheets are {', '.join(SHEETS)}"))
    if faults:
        raise InputError(faults)
    return book


def _with(
    book: ScenarioBook, file: str, title: str, text: str, numbers: tuple[int, ...]
) -> ScenarioBook:
    return replace(
        book,
        files={**book.files, file: text.encode()},
        titles={**book.titles, file: title},
        rows={**book.rows, file: numbers},
    )


def with_book(draft: Draft, book: ScenarioBook) -> tuple[Draft, tuple[str, ...]]:
    """The draft with the tables and settings a workbook has, and what that did.

    Raises InputError, by sheet, row and column, where a sheet is no table of its kind.
    """
    faults: list[Fault] = []
    for file, text in book.files.items():
        if file == SETTINGS:
            settings, found = read_settings(text)
            draft = draft.with_settings(settings)
        else:
            rows, found = read_rows(file, text)
            draft = draft.with_table(file, rows)
        faults += found
    if faults:
        raise InputError(book.placed(faults))
    told = [f"{book.name} replaced {', '.join(book.files)}."]
    if book.left_out:
        told.append(f"What came of a day is left out: {', '.join(book.left_out)}.")
    if "arrivals.csv" in book.files:
        draft, more = recorded(draft)
        told += more
    return draft, tuple(told)


def _csv(rows: Sheet) -> tuple[str, tuple[int, ...]]:
    """Rows that are not blank as CSV text, all as wide as the header, and their numbers."""
    width = max((i + 1 for i, cell in enumerate(rows[0]) if cell), default=0) if rows else 0
    lines, numbers = [], []
    for number, cells in enumerate(rows, 1):
        if not any(cells):
            continue
        wide = max(i + 1 for i, cell in enumerate(cells) if cell)
        padded = [*cells[: max(width, wide)], *[""] * (width - len(cells))]
        lines.append(write_table(padded, ()))
        numbers.append(number)
    return "".join(lines), tuple(numbers[1:])


def _settings(place: str, rows: Sheet) -> tuple[Raw, dict[str, int], list[Fault]]:
    """The keys and values of a settings sheet as nested tables, and the row of each key."""
    faults: list[Fault] = []
    raw: Raw = {}
    found: dict[str, int] = {}
    if not rows or [cell.lower() for cell in rows[0][:2]] != [KEY, VALUE]:
        return {}, {}, [Fault(f"{place}, row 1", "another header", f"columns are {KEY}, {VALUE}")]
    for number, cells in enumerate(rows[1:], 2):
        key, value = (*cells, "", "")[:2]
        where = f"{place}, row {number}, column {KEY}"
        if not key or not value:
            continue  # a key without a value is left out
        if key in found:
            faults.append(Fault(where, f"{shown(key)}, as in row {found[key]}", "each key once"))
            continue
        found[key] = number
        try:
            _lay(raw, _path(key), setting_of(key, value).value)
        except TypeError:
            rule = "should be a key of scenario.toml, options by name: option.C1.average_kw"
            faults.append(Fault(where, shown(key), rule))
    options = raw.get("option")
    if isinstance(options, dict) and all(isinstance(o, dict) for o in options.values()):
        raw["option"] = [{"name": name} | option for name, option in options.items()]
    return raw, found, faults


def _path(key: str) -> list[str]:
    """A key's parts; names of options may have dots."""
    parts = key.split(".")
    if parts[0] == "option" and len(parts) > 3:
        return ["option", ".".join(parts[1:-1]), parts[-1]]
    if "option_share" in parts[:-1]:
        begin = parts.index("option_share") + 1
        return [*parts[:begin], ".".join(parts[begin:])]
    return parts


def _lay(node: Raw, path: list[str], value: object) -> None:
    for part in path[:-1]:
        node = node.setdefault(part, {})
        if not isinstance(node, dict):
            raise TypeError
    node[path[-1]] = value


def scenario_workbook(draft: Draft) -> bytes:
    """A draft as a workbook that reads back the same."""
    sheets: dict[str, Sequence[Sequence[object]]] = {
        SETTINGS_SHEET: [[KEY, VALUE], *settings_rows(draft.settings)]
    }
    used = files_of(draft)
    for sheet, file in SHEETS.items():
        if file in used:
            sheets[sheet] = table_rows(file, draft.tables.get(file, ()))
    return written(sheets)


def table_rows(file: str, rows: Sequence[Row]) -> list[list[object]]:
    """A table with its header, numbers as numbers, so that a spreadsheet can reckon with them."""
    columns = list(RECORDS[file].model_fields)
    return [list(columns), *([_number_or_text(c, row[c]) for c in columns] for row in rows)]


def _number_or_text(column: str, cell: str) -> object:
    if column in NOT_NUMBERS:
        return cell
    try:
        number = float(cell)
    except ValueError:
        return cell
    return int(number) if number.is_integer() and abs(number) < 2**53 else number


def settings_rows(settings: Raw) -> list[list[object]]:
    """Nested settings as keys and values, options by their names, lists as TOML has them."""
    rows: list[list[object]] = []

    def lay(prefix: str, value: object) -> None:
        options = value if prefix == "option" and isinstance(value, list) else []
        if options and all(isinstance(option, dict) for option in options):
            for option in options:
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
