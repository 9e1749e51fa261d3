"""What differs between two scenarios, key by key and row by row."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from evdash.domain.arrivals import LOCAL_TIME_FORMAT, GeneratedArrivals, RecordedArrivals
from evdash.domain.scenario import Scenario

MOST_ROWS = 4
"""So many differing rows of a column are told one by one; more are summed up."""
KEYS = {
    "nodes.csv": ("node",),
    "lines.csv": ("from_node", "to_node"),
    "profile.csv": ("interval",),
    "fleet.csv": ("model",),
    "arrivals.csv": ("vehicle",),
    "events.csv": ("interval", "event", "subject"),
}
ABSENT = "–"


@dataclass(frozen=True, slots=True)
class Difference:
    """One thing that differs: where it stands, and what each of the two has there."""

    place: str
    before: str
    after: str


def scenario_differences(before: Scenario, after: Scenario) -> list[Difference]:
    """Every difference between two scenarios, in the order of the files."""
    old, new = _settings(before), _settings(after)
    found = [
        Difference(key, _worded(old.get(key)), _worded(new.get(key)))
        for key in dict.fromkeys([*old, *new])
        if old.get(key) != new.get(key)
    ]
    old_tables, new_tables = _tables(before), _tables(after)
    for file in dict.fromkeys([*old_tables, *new_tables]):
        found += _table_differences(file, old_tables.get(file, ()), new_tables.get(file, ()))
    return found


def _settings(scenario: Scenario) -> dict[str, object]:
    """The keys of scenario.toml and their values, options by name."""
    settings: dict[str, object] = {
        key: getattr(scenario, key)
        for key in ("name", "start", "interval_minutes", "intervals", "arrivals_until")
    }
    settings |= _flat("feeder", scenario.feeder) | _flat("station", scenario.station)
    for option in scenario.option:
        settings |= _flat(f"option.{option.name}", option, leaving=("name",))
    known = scenario.arrivals
    if isinstance(known, GeneratedArrivals):
        settings |= {"arrivals": "drawn at random"} | _flat("arrivals", known, leaving=("fleet",))
    else:
        settings |= {"arrivals": "from a list", "arrivals.seed": known.seed}
        if known.forecast is not None:
            settings |= _flat("arrivals.forecast", known.forecast, leaving=("fleet",))
    return settings


def _flat(table: str, record: BaseModel, leaving: Collection[str] = ()) -> dict[str, object]:
    flat: dict[str, object] = {}
    for name in type(record).model_fields:
        value = getattr(record, name)
        if isinstance(value, Mapping):
            flat |= {f"{table}.{name}.{key}": inner for key, inner in value.items()}
        elif name not in leaving:
            flat[f"{table}.{name}"] = value
    return flat


def _tables(scenario: Scenario) -> dict[str, Sequence[BaseModel]]:
    tables: dict[str, Sequence[BaseModel]] = {
        "nodes.csv": scenario.nodes,
        "lines.csv": scenario.lines,
        "profile.csv": scenario.profile,
        "events.csv": scenario.events,
    }
    known = scenario.arrivals
    if isinstance(known, RecordedArrivals):
        tables["arrivals.csv"] = known.vehicles
    statistics = known.forecast if isinstance(known, RecordedArrivals) else known
    if statistics is not None:
        tables["fleet.csv"] = statistics.fleet
    return tables


def _table_differences(
    file: str, before: Sequence[BaseModel], after: Sequence[BaseModel]
) -> list[Difference]:
    old, new = _by_key(file, before), _by_key(file, after)
    if old == new:
        return []
    if not old or not new:
        return [Difference(file, _rows(len(old)), _rows(len(new)))]
    found = []
    for told, here, there in (("only before", old, new), ("only after", new, old)):
        names = [name for name in here if name not in there]
        if len(names) > MOST_ROWS:
            counts = (_rows(len(old)), _rows(len(new)))
            found.append(Difference(f"{file}: {len(names)} rows {told}", *counts))
            continue
        for name in names:
            sides = ("there", ABSENT) if here is old else (ABSENT, "there")
            found.append(Difference(f"{file}, {name}", *sides))
    columns = [c for c in type((*before, *after)[0]).model_fields if c not in KEYS[file]]
    for column in columns:
        found += _column_differences(file, column, old, new)
    return found


def _by_key(file: str, rows: Sequence[BaseModel]) -> dict[str, BaseModel]:
    return {"-".join(str(getattr(row, key)) for key in KEYS[file]): row for row in rows}


def _column_differences(
    file: str, column: str, old: Mapping[str, BaseModel], new: Mapping[str, BaseModel]
) -> list[Difference]:
    pairs = {
        name: (getattr(old[name], column), getattr(new[name], column))
        for name in old
        if name in new
    }
    differing = {name: pair for name, pair in pairs.items() if pair[0] != pair[1]}
    if len(differing) > MOST_ROWS:
        place = f"{file}, {column}: {len(differing)} of {len(pairs)} rows"
        sides = zip(*differing.values(), strict=True)
        return [Difference(place, *(_summed_up(values) for values in sides))]
    return [
        Difference(f"{file}, {name}, {column}", _worded(a), _worded(b))
        for name, (a, b) in differing.items()
    ]


def _summed_up(values: Sequence[Any]) -> str:
    """Many values in few words: their mean and range where they are numbers."""
    numbers = [value for value in values if isinstance(value, int | float)]
    if len(numbers) < len(values):
        return f"{len(values)} values"
    mean = sum(numbers) / len(numbers)
    return f"mean {mean:.4g}, {min(numbers):.4g} to {max(numbers):.4g}"


def _rows(count: int) -> str:
    return ABSENT if count == 0 else f"{count:,} row{'' if count == 1 else 's'}"


def _worded(value: object) -> str:
    if value is None:
        return ABSENT
    if isinstance(value, tuple) and len(value) > MOST_ROWS:
        return _summed_up(value)
    if isinstance(value, tuple):
        return ", ".join(_worded(part) for part in value)
    if hasattr(value, "strftime"):
        return str(value.strftime(LOCAL_TIME_FORMAT))
    return f"{value:.10g}" if isinstance(value, float) else str(value)
