"""Scenario folders changed where it matters: keys, cells, rows, columns, names and bytes."""

import csv
import io
import json
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np
import tomlkit
from pydantic import BaseModel

from benchmarks.fuzzing.values import field_of, hostile_text, pick, value_for
from benchmarks.random_days import random_scenario
from evdash.domain.arrivals import Arrival, FleetModel
from evdash.domain.events import EVENT_FORMS, Event
from evdash.domain.scenario import Line, Node, ProfileRow, Scenario
from evdash.errors import InputError
from evdash.files.scenario_folder import parse_scenario, resolved, scenario_files
from evdash.horizon.arrivals import arrivals_of

Files = dict[str, bytes]
Table = list[list[str]]
SETTINGS = "scenario.toml"
RECORDS: Mapping[str, type[BaseModel]] = {
    "nodes.csv": Node,
    "lines.csv": Line,
    "profile.csv": ProfileRow,
    "fleet.csv": FleetModel,
    "arrivals.csv": Arrival,
    "events.csv": Event,
}
MOST_INTERVALS, MOST_VEHICLES = 8, 8
BASES = 60
ENCODINGS = ("utf-8-sig", "utf-16", "utf-16-le", "utf-32", "latin-1", "cp1252")
BYTES = (b"\x00", b"\xff", b"\xef\xbb\xbf", b'"', b"\r", b"\n", b",", b"[", b"]]", b"=", b"'''")


@lru_cache(maxsize=BASES)
def base(number: int) -> Mapping[str, bytes]:
    """The files of a small valid scenario: random, drawn or recorded, some with events."""
    scenario = next(
        s
        for k in range(1000)
        if (s := random_scenario(number + k * 997)).intervals <= MOST_INTERVALS
    )
    if number % 2:
        arrivals = arrivals_of(scenario)[:MOST_VEHICLES]
        if arrivals:
            scenario = resolved(scenario, arrivals)
    files = {name: text.encode() for name, text in scenario_files(scenario).items()}
    if number % 3 == 0:
        rng = np.random.default_rng(number)
        files = _with_some_events(files, rng, scenario)
    return files


def _with_some_events(files: Files, rng: np.random.Generator, scenario: Scenario) -> Files:
    """The files with an events.csv that is right, if a few tries give one."""
    for _ in range(20):
        rows = [_event_row(rng, files, hostile=False) for _ in range(int(rng.integers(1, 4)))]
        with_events = files | {"events.csv": table_bytes([list(Event.model_fields), *rows])}
        try:
            parse_scenario(with_events)
        except InputError:
            continue
        return with_events
    return files


def spoilt_folder(rng: np.random.Generator) -> Files:
    """The files of a valid scenario after one to five changes."""
    files = dict(base(int(rng.integers(0, BASES))))
    for _ in range(int(rng.integers(1, 6))):
        files = pick(rng, CHANGES)(rng, files)
    return files


def read_table(files: Files, name: str) -> Table | None:
    """The rows of a table, None where another change left none."""
    try:
        rows = list(csv.reader(io.StringIO(files[name].decode())))
    except (KeyError, UnicodeDecodeError, csv.Error):
        return None
    return rows if rows and rows[0] else None


def table_bytes(rows: Table) -> bytes:
    """Rows as a CSV file."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode("utf-8", "surrogatepass")


def _some_table(rng: np.random.Generator, files: Files) -> tuple[str, Table | None]:
    """One of the tables there are, and its rows."""
    name = str(pick(rng, [file for file in RECORDS if file in files] or ["nodes.csv"]))
    return name, read_table(files, name)


def read_settings(files: Files) -> dict[str, Any] | None:
    """scenario.toml as plain tables, None where another change left none."""
    try:
        return dict(tomlkit.parse(files[SETTINGS].decode()).unwrap())
    except (KeyError, ValueError, RecursionError):
        return None


def _with_settings(files: Files, settings: dict[str, Any]) -> Files:
    try:
        return files | {SETTINGS: tomlkit.dumps(settings).encode("utf-8", "ignore")}
    except (ValueError, TypeError, OverflowError):  # what no TOML can say
        return files


def _ways(node: Any, way: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Every place in nested tables and lists."""
    found = [way] if way else []
    inner = (
        node.items()
        if isinstance(node, dict)
        else enumerate(node)
        if isinstance(node, list)
        else ()
    )
    for key, value in inner:
        found += _ways(value, (*way, key))
    return found


def _holder(settings: dict[str, Any], way: tuple[Any, ...]) -> Any:
    node: Any = settings
    for part in way[:-1]:
        node = node[part]
    return node


def _key(rng: np.random.Generator, files: Files) -> Files:
    """A key exchanged, taken out, doubled under another name, or swapped with another."""
    settings = read_settings(files)
    if not settings:
        return files
    ways = _ways(settings)
    way = pick(rng, ways)
    holder = _holder(settings, way)
    how = pick(rng, ("value", "value", "value", "out", "unknown", "swap"))
    if how == "out":
        del holder[way[-1]]
    elif how == "unknown" and isinstance(holder, dict):
        holder[hostile_text(rng) or "empty"] = holder[way[-1]]
    elif how == "swap":
        other = pick(rng, ways)
        there = _holder(settings, other)
        if other[: len(way)] != way and way[: len(other)] != other:
            holder[way[-1]], there[other[-1]] = there[other[-1]], holder[way[-1]]
    else:
        names = tuple(part for part in way if isinstance(part, str))
        holder[way[-1]] = value_for(rng, field_of(Scenario, names))
    return _with_settings(files, settings)


def _cell(rng: np.random.Generator, files: Files) -> Files:
    """A cell exchanged for an edge of its bounds or anything at all."""
    name, rows = _some_table(rng, files)
    if rows is None or len(rows) < 2:
        return files
    row, column = int(rng.integers(1, len(rows))), int(rng.integers(0, len(rows[0])))
    value = value_for(rng, field_of(RECORDS[name], (rows[0][column],)))
    if column < len(rows[row]):
        rows[row][column] = value if isinstance(value, str) else json.dumps(value, default=str)
    return files | {name: table_bytes(rows)}


def _rows(rng: np.random.Generator, files: Files) -> Files:
    """Rows taken out, doubled, moved, cut or made longer."""
    name, rows = _some_table(rng, files)
    if rows is None or len(rows) < 2:
        return files
    row = int(rng.integers(1, len(rows)))
    how = pick(rng, ("out", "double", "move", "short", "long", "blank", "none", "many"))
    if how == "out":
        del rows[row]
    elif how == "double":
        rows.append(list(rows[row]))
    elif how == "move":
        rows.append(rows.pop(row))
    elif how == "short":
        rows[row] = rows[row][:-1]
    elif how == "long":
        rows[row] = [*rows[row], "1"]
    elif how == "blank":
        rows.insert(row, [])
    elif how == "none":
        del rows[1:]
    else:
        rows += [list(rows[row])] * int(rng.integers(1, 3000))
    return files | {name: table_bytes(rows)}


def _column(rng: np.random.Generator, files: Files) -> Files:
    """A column renamed, taken out, doubled or moved."""
    name, rows = _some_table(rng, files)
    if rows is None:
        return files
    column = int(rng.integers(0, len(rows[0])))
    how = pick(rng, ("rename", "out", "double", "move", "none"))
    if how == "rename":
        rows[0][column] = hostile_text(rng)
    elif how == "out":
        rows = [row[:column] + row[column + 1 :] for row in rows]
    elif how == "double":
        rows = [[*row, row[column] if column < len(row) else ""] for row in rows]
    elif how == "move":
        rows = [row[column:] + row[:column] for row in rows]
    else:
        rows = rows[1:]
    return files | {name: table_bytes(rows)}


def _renamed(rng: np.random.Generator, files: Files) -> Files:
    """A node, option or vehicle renamed everywhere, so that a hostile name can be a right one."""
    name, column = pick(
        rng, (("nodes.csv", 0), ("nodes.csv", 0), ("arrivals.csv", 0), ("arrivals.csv", 2))
    )
    rows = read_table(files, name)
    if rows is None or len(rows) < 2 or len(rows[0]) <= column:
        return files
    row = pick(rng, rows[1:])
    old = row[column] if column < len(row) else ""
    new = f"{pick(rng, 'aZ9é')}{hostile_text(rng)}"[:60]
    if not old:
        return files
    for file in RECORDS:
        table = read_table(files, file)
        if table is not None:
            table = [[new if cell == old else cell for cell in row] for row in table]
            files = files | {file: table_bytes(table)}
    settings = read_settings(files)
    return files if settings is None else _with_settings(files, _exchanged(settings, old, new))


def _exchanged(node: Any, old: str, new: str) -> Any:
    if isinstance(node, dict):
        return {new if k == old else k: _exchanged(v, old, new) for k, v in node.items()}
    if isinstance(node, list):
        return [_exchanged(part, old, new) for part in node]
    return new if node == old else node


def _event_row(rng: np.random.Generator, files: Files, hostile: bool = True) -> list[str]:
    """A row of events.csv about things that are there."""
    kind = str(pick(rng, list(EVENT_FORMS)))
    form = EVENT_FORMS[kind]  # type: ignore[index]
    subjects = {"": ""}
    for what, file, columns in (("vehicle", "arrivals.csv", 1), ("element", "lines.csv", 2)):
        rows = read_table(files, file) or [[]]
        names = ["-".join(row[:columns]) for row in rows[1:] if len(row) >= columns]
        prefix = "line:" if what == "element" else ""
        subjects[what] = prefix + str(pick(rng, names)) if names else "PEV-001"
    low, high = int(rng.integers(0, 30)), int(rng.integers(0, 31))
    cells: list[Any] = [
        min(low, high),
        kind,
        subjects[form.subject],
        round(float(rng.uniform(0, 5)), 0 if form.whole else 2) if form.value else "",
        max(low, high) if "from_interval" in form.span else "",
        max(low, high) + 1 if "until_interval" in form.span else "",
    ]
    if hostile and rng.random() < 0.4:
        columns = list(Event.model_fields)
        place = int(rng.integers(0, len(columns)))
        cells[place] = value_for(rng, Event.model_fields[columns[place]])
    return [str(cell) for cell in cells]


def _events(rng: np.random.Generator, files: Files) -> Files:
    """One to four more events, right, contradictory or hostile."""
    rows = read_table(files, "events.csv") or [list(Event.model_fields)]
    rows += [_event_row(rng, files) for _ in range(int(rng.integers(1, 5)))]
    return files | {"events.csv": table_bytes(rows)}


def _length(rng: np.random.Generator, files: Files) -> Files:
    """Another number of intervals, with a profile to match: one, two, or a few more."""
    settings, rows = read_settings(files), read_table(files, "profile.csv")
    if settings is None or rows is None or len(rows) < 2 or "intervals" not in settings:
        return files
    count = int(pick(rng, (1, 1, 2, 3, 7, MOST_INTERVALS)))
    settings["intervals"] = count
    settings.pop("arrivals_until", None)
    rows = [rows[0], *([str(t), *pick(rng, rows[1:])[1:]] for t in range(count))]
    return _with_settings(files, settings) | {"profile.csv": table_bytes(rows)}


def _bytes(rng: np.random.Generator, files: Files) -> Files:
    """Bytes exchanged, cut, doubled; another encoding; a file absent or in another's place."""
    if not files:
        return files
    name = pick(rng, sorted(files))
    content = files[name]
    begin = int(rng.integers(0, len(content) + 1))
    end = min(len(content), begin + int(rng.integers(0, 20)))
    how = pick(rng, ("piece", "cut", "tail", "encoding", "absent", "swap", "text", "crlf", "huge"))
    if how == "absent":
        return {other: files[other] for other in files if other != name}
    if how == "swap":
        return files | {name: files[pick(rng, sorted(files))]}
    if how == "encoding":
        text = content.decode("utf-8", "replace")
        return files | {name: text.encode(pick(rng, ENCODINGS), "replace")}
    changed = {
        "piece": lambda: content[:begin] + pick(rng, BYTES) + content[end:],
        "cut": lambda: content[:begin],
        "tail": lambda: content[begin:],
        "text": lambda: content[:begin] + hostile_text(rng).encode() + content[end:],
        "crlf": lambda: content.replace(b"\n", b"\r\n" if begin % 2 else b"\r"),
        "huge": lambda: content[:begin] + pick(rng, (b"9", b"a", b"[", b"(", b'"', b",")) * 300_000,
    }
    return files | {name: changed[how]()}


def _extra(rng: np.random.Generator, files: Files) -> Files:
    """A file nothing refers to."""
    name = pick(rng, ("notes.txt", "nodes.CSV", "README.md", "fleet.csv", ".hidden", "a/b.csv"))
    return files | {name: pick(rng, (b"", b"\xff\xfe", b"a,b\n1,2\n"))}


Change = Callable[[np.random.Generator, Files], Files]
CHANGES: tuple[Change, ...] = (
    *(_key, _key, _key, _cell, _cell, _cell, _rows, _column),
    *(_renamed, _events, _length, _bytes, _extra),
)
