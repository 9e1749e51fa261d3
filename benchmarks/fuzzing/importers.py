"""What people bring along from elsewhere: network files, workbooks, session tables, studies."""

import csv
import io
import json
import tomllib
from collections.abc import Callable
from datetime import date, datetime, timedelta
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pandapower
import tomlkit
from pandapower.networks import create_kerber_landnetz_freileitung_1

from benchmarks.fuzzing.folders import BASES, base, spoilt_folder
from benchmarks.fuzzing.trial import Outcome, tried
from benchmarks.fuzzing.values import hostile_text, hostile_value, pick
from evdash.domain.scenario import Scenario
from evdash.errors import InputError
from evdash.files.bundled import DEFAULT
from evdash.files.draft import Draft, read_draft, scenario_of
from evdash.files.folder import read_files
from evdash.imports.clock import Reading
from evdash.imports.feeder import feeder_of_net, with_network
from evdash.imports.pandapower_json import read_net
from evdash.imports.profile import ProfileRules, with_profile
from evdash.imports.scenario_book import read_book, scenario_workbook
from evdash.imports.session_columns import KNOWN, REQUIRED, proposed
from evdash.imports.sessions import SessionRules, with_sessions
from evdash.imports.tables import read_foreign
from evdash.imports.workbook import written
from evdash.studies.reading import base_scenario, lay_out, parse_study

STUDIES = Path(__file__).parents[2] / "data" / "studies"
TIMES = ("2024-05-06 08:20", "2024-05-06T23:59:59Z", "06/05/2024 8:20", "1715000000", "8.5")
AGES = ("0001-01-01", "9999-12-31T23:59:59+00:00", "2024-10-27 02:30", "2024-03-31 02:30")
NUMBERS = ("12.5", "0", "-3", "1e400", "nan", "1,5", "60", "0.1")
Named = tuple[str, bytes]


def spoilt_network(rng: np.random.Generator) -> bytes:
    """A small network as pandapower writes it, after one to five changes."""
    data = json.loads(_network())
    for _ in range(int(rng.integers(1, 6))):
        tables = data["_object"]
        name = pick(rng, sorted(tables))
        try:
            inner = json.loads(tables[name]["_object"])
            _change_frame(rng, inner)
            tables[name]["_object"] = json.dumps(inner, default=str)
        except (TypeError, LookupError, ValueError, AttributeError):  # no frame, or one no longer
            tables[name] = hostile_value(rng)
    return _perhaps_damaged(rng, json.dumps(data, default=str).encode("utf-8", "replace"))


def _change_frame(rng: np.random.Generator, frame: dict[str, Any]) -> None:
    how = pick(rng, ("cell", "cell", "cell", "row", "column", "index", "key"))
    rows, columns = frame["data"], frame["columns"]
    if how == "cell" and rows and columns:
        pick(rng, rows)[int(rng.integers(0, len(columns)))] = hostile_value(rng)
    elif how == "row":
        rows.append(pick(rng, rows) if rows and rng.random() < 0.5 else [hostile_value(rng)])
    elif how == "column" and columns:
        columns[int(rng.integers(0, len(columns)))] = hostile_text(rng)
    elif how == "index":
        frame["index"] = [hostile_value(rng) for _ in rows]
    else:
        frame[pick(rng, sorted(frame))] = hostile_value(rng)


@lru_cache(maxsize=1)
def _network() -> str:
    return str(pandapower.to_json(create_kerber_landnetz_freileitung_1()))


def network(content: bytes) -> Outcome:
    """A network file, its feeder under a scenario that is right."""

    def act() -> Scenario | None:
        imported = feeder_of_net(*read_net("net.json", content))
        with_network(read_draft(dict(base(0))), imported, None)
        return None

    return tried(act)


def spoilt_workbook(rng: np.random.Generator) -> bytes:
    """A scenario as a workbook, spoilt before or after it was written."""
    if rng.random() < 0.5:
        sheets = {
            pick(rng, ("scenario", "nodes", "lines", "arrivals", "profile", "x")): [
                [_cell(rng) for _ in range(int(rng.integers(1, 9)))]
                for _ in range(int(rng.integers(1, 9)))
            ]
        }
        return _perhaps_damaged(rng, written(sheets))
    try:
        content = scenario_workbook(read_draft(spoilt_folder(rng)))
    except InputError:
        content = scenario_workbook(read_draft(dict(base(int(rng.integers(0, BASES))))))
    return _perhaps_damaged(rng, content)


def _cell(rng: np.random.Generator) -> object:
    return pick(rng, (hostile_text(rng)[:200], 1.5, 7, None, True, "node", "arrival"))


def workbook(content: bytes) -> Outcome:
    """A workbook as a scenario."""
    return tried(lambda: scenario_of(read_draft(read_book("day.xlsx", content).files)))


def spoilt_sessions(rng: np.random.Generator) -> Named:
    """A table of sessions under known names of columns, with cells right and wrong."""
    fields = [field for field in KNOWN if field in REQUIRED or rng.random() < 0.4]
    names = [pick(rng, KNOWN[field]) for field in fields]
    if rng.random() < 0.1:
        names[int(rng.integers(0, len(names)))] = hostile_text(rng)
    count = int(rng.integers(0, 12))
    rows = [[_session_cell(rng, field) for field in fields] for _ in range(count)]
    if rng.random() < 0.3:
        records = [dict(zip(names, row, strict=True)) for row in rows]
        shape = pick(rng, (records, records, {"_items": records}, hostile_value(rng)))
        return "table.json", _perhaps_damaged(rng, json.dumps(shape, default=str).encode())
    text = io.StringIO()
    csv.writer(text, delimiter=pick(rng, (",", ";", "\t"))).writerows([names, *rows])
    return "table.csv", _perhaps_damaged(rng, text.getvalue().encode("utf-8", "replace"))


def _session_cell(rng: np.random.Generator, field: str) -> str:
    """A right cell of a column, seldom one of another kind."""
    if rng.random() < 0.03:
        return str(pick(rng, (pick(rng, TIMES), pick(rng, NUMBERS), hostile_text(rng))))
    right = {"arrival": "2024-05-06 08:20", "departure": "2024-05-06 19:40", "energy_kwh": "7.5"}
    return right.get(field, "")


@lru_cache(maxsize=1)
def _whole_day() -> Draft:
    """Sessions repeat a profile that has every clock time."""
    return read_draft(read_files(DEFAULT))


def sessions(given: Named) -> Outcome:
    """A table of sessions, its columns as proposed, in place of a scenario's vehicles."""

    def act() -> Scenario:
        table = read_foreign(*given)
        rules = SessionRules(proposed(table.columns))
        return scenario_of(with_sessions(_whole_day(), table, rules)[0])

    return tried(act)


def spoilt_values(rng: np.random.Generator) -> tuple[Named, ProfileRules]:
    """A table of prices and loads by time, right and wrong, and rules to read it by."""
    begin = pick(rng, (datetime(2020, 7, 14, 22), datetime(2024, 3, 30), datetime(2024, 10, 26)))
    minutes = pick(rng, (15, 60, 60, 180))
    count = 60 * 60 // minutes if rng.random() < 0.9 else int(rng.integers(0, 9))
    rows = [["time", "price_mwh", "load_kw"]]
    for n in range(count):
        when = f"{begin + timedelta(minutes=minutes * n):%Y-%m-%d %H:%M}"
        rows.append([when, f"{n % 7}", "5"])
    for _ in range(int(rng.integers(0, 3)) if rng.random() < 0.5 else 0):
        row = pick(rng, rows)
        row[int(rng.integers(0, 3))] = pick(rng, (*TIMES, *NUMBERS, *AGES, hostile_text(rng)))
    text = io.StringIO()
    csv.writer(text, delimiter=pick(rng, (",", ";", "\t"))).writerows(rows)

    def mostly(usual: Any, *others: Any) -> Any:
        return usual if rng.random() < 0.85 else pick(rng, others)

    rules = ProfileRules(
        columns={"time": "time", "price": "price_mwh", "load": mostly("load_kw", "", "x")},
        units={"price": "$/MWh", "load": mostly("kW", "pu", "", "?")},
        reading=Reading(mostly(None, "Europe/Berlin", "Asia/Tokyo", "Nowhere")),
        first_day=mostly(begin.date() + timedelta(1), None, date(1, 1, 1), date(9999, 12, 31)),
        days=mostly(None, 1, 2, 0, 366),
        hold_minutes=mostly(None, 1e9, 1e-9, -1.0),
        at_end=rng.random() < 0.1,
    )
    return ("table.csv", _perhaps_damaged(rng, text.getvalue().encode("utf-8", "replace"))), rules


def values(given: tuple[Named, ProfileRules]) -> Outcome:
    """A table of prices and loads, laid over the bundled day."""

    def act() -> Scenario:
        named, rules = given
        return scenario_of(with_profile(_whole_day(), read_foreign(*named), rules)[0])

    return tried(act)


def spoilt_study(rng: np.random.Generator) -> bytes:
    """One of the bundled studies with keys exchanged, taken out or unknown."""
    raw: dict[str, Any] = tomllib.loads(pick(rng, sorted(STUDIES.glob("*.toml"))).read_text())
    for _ in range(int(rng.integers(1, 3))):
        holder: Any = raw
        while True:
            keys = list(holder) if isinstance(holder, dict) else list(range(len(holder)))
            if not keys:
                break
            key = pick(rng, keys)
            if isinstance(holder[key], dict | list) and rng.random() < 0.7:
                holder = holder[key]
                continue
            _change(rng, holder, key)
            break
    try:
        content = tomlkit.dumps(raw).encode("utf-8", "ignore")
    except (ValueError, TypeError, OverflowError):  # what no TOML can say
        content = b"[base]"
    return _perhaps_damaged(rng, content)


def _change(rng: np.random.Generator, holder: Any, key: Any) -> None:
    how = rng.random()
    if how < 0.15:
        del holder[key]
    elif how < 0.3 and isinstance(holder, dict):
        holder[hostile_text(rng) or "x"] = holder[key]
    else:
        holder[key] = hostile_value(rng)


def study(content: bytes) -> Outcome:
    """A study file, laid out ready to run."""

    def act() -> None:
        parsed = parse_study(content.decode("utf-8", "replace"), "study.toml")
        lay_out(parsed, base_scenario(parsed, STUDIES))

    return tried(act)


def _perhaps_damaged(rng: np.random.Generator, content: bytes) -> bytes:
    """Most of the time as it is; else bytes exchanged, or cut off."""
    if rng.random() < 0.8 or not content:
        return content
    if rng.random() < 0.4:
        return content[: int(rng.integers(0, len(content)))]
    damaged = bytearray(content)
    for _ in range(int(rng.integers(1, 9))):
        damaged[int(rng.integers(0, len(damaged)))] = int(rng.integers(0, 256))
    return bytes(damaged)


MAKERS: tuple[tuple[str, Callable[..., Any], Callable[[Any], Outcome]], ...] = (
    ("pandapower .json", spoilt_network, network),
    ("workbook", spoilt_workbook, workbook),
    ("session table", spoilt_sessions, sessions),
    ("values by time", spoilt_values, values),
    ("study file", spoilt_study, study),
)
