"""CSV tables as rows of text, with the line each row stands in."""

import csv
import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from pydantic import BaseModel

from evdash.errors import Fault

MOST_ROWS = 100_000
"""More than any table of a scenario may hold, so that a small .zip cannot fill the memory."""


LONGEST_ROW = 200_000
"""Characters of a row, so that its cells cannot fill the memory before they are counted."""
MOST_COLUMNS, MOST_FAULTS = 200, 200


class BoundedLines:
    """Lines of a text for a reader of rows, which tells when it has `begun` another row.

    csv.Error where a row, which may have many lines, is longer than any of a table's is.
    """

    def __init__(self, text: str) -> None:
        self._lines = io.StringIO(text, newline="")
        self._length = 0

    def begun(self) -> None:
        """Another row begins with the next line."""
        self._length = 0

    def __iter__(self) -> "BoundedLines":
        return self

    def __next__(self) -> str:
        line = next(self._lines)
        self._length += len(line)
        if self._length > LONGEST_ROW:
            raise csv.Error(f"a row of more than {LONGEST_ROW:,} characters")
        return line


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of a CSV file as column → text, and each row's number as a spreadsheet counts."""

    rows: list[dict[str, object]]
    row_numbers: list[int]


def decode(name: str, content: bytes) -> tuple[str, list[Fault]]:
    """UTF-8 text, with or without a byte-order mark."""
    try:
        return content.decode("utf-8-sig"), []
    except UnicodeDecodeError as error:
        found = f"byte 0x{content[error.start]:02x} at position {error.start}"
        return "", [Fault(name, found, "should be UTF-8 text")]


def read_table(
    name: str, content: bytes, record: type[BaseModel]
) -> tuple[Table | None, list[Fault]]:
    """A table with the columns of `record`; None with its faults if its form is wrong.

    Columns that may be blank may also be left out; unknown and repeated ones are faults.
    """
    text, faults = decode(name, content)
    if faults:
        return None, faults
    number = 1
    try:
        bounded = BoundedLines(text)
        lines = csv.reader(bounded, strict=True)
        header = [cell.strip() for cell in next(lines, [])]
        faults = _header_faults(name, header, record)
        if faults:
            return None, faults
        table = Table([], [])
        bounded.begun()
        for number, cells in enumerate(lines, 2):
            bounded.begun()
            if number > MOST_ROWS:
                return None, [*faults, _too_many(name)]
            if not cells:
                continue
            if len(faults) >= MOST_FAULTS:
                return None, faults
            if len(cells) != len(header):
                rule = f"should be {len(header)}, as in the header"
                faults.append(Fault(f"{name}, row {number}", f"{len(cells)} cells", rule))
                continue
            table.rows.append(dict(zip(header, cells, strict=True)))
            table.row_numbers.append(number)
    except csv.Error as error:
        place = f"{name}, row {number + 1}"
        return None, [*faults, Fault(place, f"{error}", "should be comma-separated values")]
    return (None if faults else table), faults


def _too_many(name: str) -> Fault:
    return Fault(name, f"more than {MOST_ROWS:,} rows", f"should have at most {MOST_ROWS:,}")


def _header_faults(name: str, header: list[str], record: type[BaseModel]) -> list[Fault]:
    known = list(record.model_fields)
    required = [column for column, field in record.model_fields.items() if field.is_required()]
    place, columns = f"{name}, header", f"columns are {', '.join(known)}"
    if len(header) > MOST_COLUMNS:
        return [Fault(place, f"{len(header):,} columns", columns)]
    faults = [
        Fault(f"{place}, column {column}", "nothing", f"should be there; {columns}")
        for column in required
        if column not in header
    ]
    faults += [
        Fault(place, f"unknown column {column!r}", columns)
        for column in dict.fromkeys(header)
        if column not in known
    ]
    faults += [
        Fault(place, f"column {column!r} {header.count(column)} times", "each column once")
        for column in dict.fromkeys(header)
        if header.count(column) > 1
    ]
    return faults


def write_table(header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A CSV table; None is a blank, floats keep full precision."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(["" if cell is None else cell for cell in row] for row in rows)
    return text.getvalue()
