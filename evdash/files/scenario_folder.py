"""A scenario folder, in and out."""

import re
from collections.abc import Mapping
from datetime import datetime, time, timedelta
from pathlib import Path
from typing import Any

import tomlkit
from pydantic import BaseModel, TypeAdapter, ValidationError

from evdash.domain.arrivals import (
    LOCAL_TIME_FORMAT,
    Arrival,
    ArrivalStatistics,
    FleetModel,
    GeneratedArrivals,
    LocalTime,
    RecordedArrivals,
)
from evdash.domain.events import Event
from evdash.domain.scenario import Line, Node, ProfileRow, Scenario
from evdash.errors import Fault, InputError
from evdash.files.checks import Place
from evdash.files.folder import read_files
from evdash.files.nested import read_toml
from evdash.files.overrides import Setting, apply_settings
from evdash.files.tables import decode, read_table, write_table
from evdash.files.validate import Raw, dotted, validate
from evdash.files.wording import shown

SETTINGS = "scenario.toml"
TABLES: dict[str, type[BaseModel]] = {"nodes": Node, "lines": Line, "profile": ProfileRow}
OPTIONAL_TABLES: dict[str, type[BaseModel]] = {"events": Event}
FILE_NAMES = (
    SETTINGS,
    *(f"{name}.csv" for name in (*TABLES, *OPTIONAL_TABLES, "arrivals", "fleet")),
)
"""Every file that a scenario is written with."""
CLOCK_TIME = re.compile(r"\s*(\d{1,2}):(\d{2})\s*")
SOMETIME = datetime(2020, 1, 1)


def read_scenario(path: Path | str, settings: tuple[Setting, ...] = ()) -> Scenario:
    """The scenario in a folder or .zip, with `settings` laid over its scenario.toml.

    Raises InputError with every fault there is.
    """
    return parse_scenario(read_files(path), settings)


def parse_scenario(files: Mapping[str, bytes], settings: tuple[Setting, ...] = ()) -> Scenario:
    """The scenario in a set of files, name to content; raises InputError with every fault."""
    reader = _Reader(files)
    return reader.scenario(settings)


class _Reader:
    """Gathers a scenario's parts and remembers where each of them stood."""

    def __init__(self, files: Mapping[str, bytes]) -> None:
        self.files = files
        self.faults: list[Fault] = []
        self.faulty: list[Place] = []
        self.used = {SETTINGS, "README.md"}
        self.all_named = True
        self.file_of: dict[Place, str] = {}
        self.rows_of: dict[Place, list[int]] = {}
        self.options: list[Any] = []

    def scenario(self, settings: tuple[Setting, ...]) -> Scenario:
        raw = self._settings(settings)
        if raw is None:
            raise InputError(self.faults)
        for name, record in TABLES.items():
            self._refuse_key(raw, name)
            raw[name] = self._table((name,), f"{name}.csv", record)
        for name, record in OPTIONAL_TABLES.items():
            self._refuse_key(raw, name)
            if f"{name}.csv" in self.files:
                raw[name] = self._table((name,), f"{name}.csv", record)
        self._arrivals(raw)
        self._unknown_files()
        options = raw.get("option")
        self.options = options if isinstance(options, list) else []
        try:
            scenario = validate(raw, self.where, self.faulty)
        except InputError as error:
            raise InputError([*self.faults, *error.faults]) from None
        if self.faults:
            raise InputError(self.faults)
        return _in_order(scenario)

    def where(self, place: Place) -> str:
        """A place in words: file, row and column, or file and key."""
        for table, file in self.file_of.items():
            if place[: len(table)] == table:
                rest = place[len(table) :]
                if not rest:
                    return file
                row = self.rows_of[table][int(rest[0])]
                return f"{file}, row {row}" + (f", column {rest[1]}" if len(rest) > 1 else "")
        if len(place) > 1 and place[0] == "option" and isinstance(place[1], int):
            option = self.options[place[1]] if place[1] < len(self.options) else None
            name = option.get("name") if isinstance(option, dict) else None
            label = name if isinstance(name, str) and name else f"{place[1] + 1}"
            place = ("option", label, *place[2:])
        *key, last = place or ("",)
        if isinstance(last, int) and key != ["option"]:  # within a list such as hourly_share
            return f"{SETTINGS}, {dotted(tuple(key))}, entry {last + 1}"
        return f"{SETTINGS}, {dotted(place)}" if place else SETTINGS

    def _settings(self, settings: tuple[Setting, ...]) -> Raw | None:
        if SETTINGS not in self.files:
            self.faults.append(Fault(SETTINGS, "no such file", "should be there"))
            return None
        text, faults = decode(SETTINGS, self.files[SETTINGS])
        self.faults += faults
        if faults:
            return None
        try:
            raw = read_toml(text)
        except ValueError as error:  # a number of too many digits: ValueError
            self.faults.append(
                Fault(SETTINGS, f"text that is not TOML ({error})", "should be TOML")
            )
            return None
        raw, faults = apply_settings(raw, settings)
        self.faults += faults
        return raw

    def _refuse_key(self, raw: Raw, key: str) -> None:
        if key in raw:
            self.faults.append(Fault(SETTINGS, f"unknown key {key!r}", f"goes in {key}.csv"))

    def _table(self, place: Place, file: str, record: type[BaseModel]) -> list[Any]:
        """The rows of a table; none, and its place marked faulty, where it cannot be read."""
        self.used.add(file)
        self.file_of[place] = file
        self.rows_of[place] = []
        if file not in self.files:
            self.faults.append(Fault(file, "no such file", "should be there"))
            self.faulty.append(place)
            return []
        table, faults = read_table(file, self.files[file], record)
        self.faults += faults
        if table is None:
            self.faulty.append(place)
            return []
        self.rows_of[place] = table.row_numbers
        return list(table.rows)

    def _arrivals(self, raw: Raw) -> None:
        arrivals = raw.get("arrivals")
        if not isinstance(arrivals, dict):
            self.all_named = False
            return  # told by validation
        if "vehicles" in arrivals:
            self.faults.append(
                Fault(SETTINGS, "unknown key 'arrivals.vehicles'", "goes in a file: file = …")
            )
        if "file" not in arrivals:
            raw["arrivals"] = self._with_fleet(("arrivals",), arrivals)
            return
        recorded = {key: value for key, value in arrivals.items() if key != "file"}
        file = self._file_name(("arrivals", "file"), arrivals["file"])
        vehicles = ("arrivals", "vehicles")
        recorded["vehicles"] = self._table(vehicles, file, Arrival) if file else []
        for row in recorded["vehicles"]:
            row["arrival"] = resolve_clock_time(row["arrival"], self._start(raw))
        if isinstance(recorded.get("forecast"), dict):
            where = ("arrivals", "forecast")
            recorded["forecast"] = self._with_fleet(where, recorded["forecast"])
        raw["arrivals"] = recorded

    def _with_fleet(self, where: Place, statistics: Raw) -> Raw:
        if "fleet" not in statistics:
            self.all_named = False
            return statistics
        file = self._file_name((*where, "fleet"), statistics["fleet"])
        rows = self._table((*where, "fleet"), file, FleetModel) if file else []
        return statistics | {"fleet": rows}

    def _file_name(self, place: Place, value: object) -> str | None:
        is_name = isinstance(value, str) and value.strip() == value != ""
        if is_name and value not in self.used:
            return str(value)
        self.all_named = False
        self.faulty.append(place)
        rule = "should be the name of a CSV file" + (" of its own" if is_name else "")
        self.faults.append(Fault(f"{SETTINGS}, {dotted(place)}", shown(value), rule))
        return None

    def _start(self, raw: Raw) -> datetime:
        """The start, or any moment where it is faulty: times are then not told anyway."""
        try:
            return TypeAdapter(LocalTime).validate_python(raw.get("start"))
        except ValidationError:
            return SOMETIME

    def _unknown_files(self) -> None:
        if not self.all_named:
            return  # what nothing refers to may be what a faulty key was to name
        known = ", ".join(sorted(self.used))
        self.faults += [
            Fault(name, "a file that nothing refers to", f"the files are {known}")
            for name in sorted(set(self.files) - self.used)
        ]


def resolve_clock_time(value: object, start: datetime) -> object:
    """HH:MM as its first occurrence at or after `start`; anything else as it stands."""
    match = CLOCK_TIME.fullmatch(str(value))
    if match is None or int(match[1]) > 23 or int(match[2]) > 59:
        return value
    moment = datetime.combine(start.date(), time(int(match[1]), int(match[2])))
    return moment if moment >= start else moment + timedelta(days=1)


def _in_order(scenario: Scenario) -> Scenario:
    rows = tuple(sorted(scenario.profile, key=lambda row: row.interval))
    events = tuple(sorted(scenario.events, key=lambda event: event.interval))
    return scenario.replacing(profile=rows, events=events)


def resolved(scenario: Scenario, arrivals: tuple[Arrival, ...]) -> Scenario:
    """The scenario with the arrivals that were drawn as records, the generator as forecast.

    To arrivals recorded already those are added who came beside them.
    """
    known = scenario.arrivals
    if isinstance(known, RecordedArrivals):
        names = {arrival.vehicle for arrival in known.vehicles}
        beside = tuple(arrival for arrival in arrivals if arrival.vehicle not in names)
        everyone = known.model_copy(update={"vehicles": (*known.vehicles, *beside)})
        return scenario.replacing(arrivals=everyone) if beside else scenario
    statistics = {name: getattr(known, name) for name in ArrivalStatistics.model_fields}
    recorded = RecordedArrivals(
        vehicles=arrivals, seed=known.seed, forecast=ArrivalStatistics.model_construct(**statistics)
    )
    return scenario.replacing(arrivals=recorded)


def scenario_files(scenario: Scenario) -> dict[str, str]:
    """The files of a scenario folder, name to text; reading them gives the same scenario."""
    files = {
        f"{name}.csv": _table_text(record, getattr(scenario, name))
        for name, record in TABLES.items()
    }
    files |= {
        f"{name}.csv": _table_text(record, getattr(scenario, name))
        for name, record in OPTIONAL_TABLES.items()
        if getattr(scenario, name)
    }
    known = scenario.arrivals
    statistics = known.forecast if isinstance(known, RecordedArrivals) else known
    if isinstance(known, RecordedArrivals):
        files["arrivals.csv"] = _table_text(Arrival, known.vehicles)
    if statistics is not None:
        files["fleet.csv"] = _table_text(FleetModel, statistics.fleet)
    return {SETTINGS: _settings_text(scenario)} | files


def _table_text(record: type[BaseModel], rows: tuple[Any, ...]) -> str:
    columns = list(record.model_fields)
    return write_table(columns, ([_cell(getattr(row, c)) for c in columns] for row in rows))


def _cell(value: object) -> object:
    return value.strftime(LOCAL_TIME_FORMAT) if isinstance(value, datetime) else value


def _settings_text(scenario: Scenario) -> str:
    known = scenario.arrivals
    in_files = {*TABLES, *OPTIONAL_TABLES, "arrivals"}
    settings = scenario.model_dump(exclude=in_files, exclude_none=True)
    settings["start"] = scenario.start.strftime(LOCAL_TIME_FORMAT)
    settings["option"] = list(settings["option"])
    if isinstance(known, GeneratedArrivals):
        settings["arrivals"] = _statistics_settings(known) | {"seed": known.seed}
    else:
        settings["arrivals"] = {"file": "arrivals.csv"}
        if known.seed is not None:
            settings["arrivals"]["seed"] = known.seed
        if known.forecast is not None:
            settings["arrivals"]["forecast"] = _statistics_settings(known.forecast)
    return tomlkit.dumps(settings)


def _statistics_settings(statistics: ArrivalStatistics) -> Raw:
    dumped = statistics.model_dump(exclude={"fleet", "seed"})
    dumped["hourly_share"] = list(dumped["hourly_share"])
    dumped["soc_in_beta"] = list(dumped["soc_in_beta"])
    dumped["soc_out"] = list(dumped["soc_out"])
    return dumped | {"fleet": "fleet.csv"}
