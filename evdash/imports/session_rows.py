"""Sessions read from the rows of a table, every fault by row and column."""

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import date, datetime, time, timedelta

from evdash.errors import Fault, InputError
from evdash.files.checks import LEAST_SOC
from evdash.files.wording import shown
from evdash.imports.clock import Reading, clock_at, placed, read_time
from evdash.imports.tables import ForeignTable

LEAST_KWH = 0.05
LEAST = {"soc_out": LEAST_SOC}
"""What a number may be at the least, where that is not 0."""
MAX_FAULTS = 200
HOURS = {"h": 1.0, "min": 1 / 60, "s": 1 / 3600, "days": 24.0}
"""Units of durations, and of times counted from `origin`."""


@dataclass(frozen=True, slots=True)
class SessionRules:
    """How sessions are read. `option_share` draws options by `seed`; without it the session's own
    average power decides. `origin` is the day numbers count from where times are numbers."""

    columns: Mapping[str, str]
    reading: Reading = field(default_factory=Reading)
    duration_unit: str = "h"
    time_unit: str = "h"
    origin: date | None = None
    first_day: date | None = None
    days: int | None = None
    battery_kwh: float = 60.0
    soc_out: float = 0.9
    option_share: Mapping[str, float] = field(default_factory=dict)
    seed: int = 1

    def faults(self) -> list[Fault]:
        """What is wrong with what is taken where the table says nothing."""
        if LEAST_SOC <= self.soc_out <= 1:
            return []
        rule = f"should be from {LEAST_SOC:g} to 1"
        return [Fault("charge on leaving (soc_out)", f"{self.soc_out:g}", rule)]


@dataclass(frozen=True, slots=True)
class Session:
    """One session as read: local times, stay in h (None if unknown), kWh drawn from the grid."""

    name: str
    arrival: datetime
    stay_h: float | None
    energy_kwh: float
    battery_kwh: float | None
    soc_in: float | None
    soc_out: float | None
    max_kw: float | None
    option: str


class SessionReader:
    """Reads sessions row by row and gathers every fault."""

    def __init__(self, table: ForeignTable, columns: Mapping[str, str], rules: SessionRules):
        self.table, self.columns, self.rules = table, columns, rules
        self.faults: list[Fault] = []
        self.zone = rules.reading.tz()
        self.odd: Counter[str] = Counter()

    def sessions(self) -> tuple[list[Session], list[str]]:
        moments = [
            (self._time(row, place, "arrival"), self._time(row, place, "departure"))
            for row, place in zip(self.table.rows, self.table.places, strict=True)
        ]
        known = [arrival for arrival, _ in moments if arrival is not None]
        first = min((m.replace(tzinfo=None) for m in known), default=datetime(2000, 1, 1))
        day = datetime.combine(self.rules.first_day or first.date(), time())
        clock = clock_at(day, self.zone)
        read, idle = [], 0
        for row, place, (arrival, departure) in zip(
            self.table.rows, self.table.places, moments, strict=True
        ):
            energy = self._number(row, place, "energy_kwh", low=0.0)
            stay = self._stay(row, place, arrival, departure)
            values = {
                name: self._number(row, place, name, low=LEAST.get(name, 0.0))
                for name in ("battery_kwh", "soc_in", "soc_out", "max_kw")
            }
            for name in ("soc_in", "soc_out"):
                value = values[name]
                values[name] = value / 100 if value is not None and value > 1 else value
            if energy is None or arrival is None:
                continue
            if energy < LEAST_KWH:
                idle += 1
                continue
            local = clock.local(arrival)
            local = local.replace(second=0, microsecond=0)
            name, option = self._text(row, "vehicle"), self._text(row, "option")
            read.append(Session(name, local, stay, energy, option=option, **values))
        if self.zone is None and any(m.tzinfo is not None for m in known):
            rule = "name the station's time zone, such as America/Los_Angeles"
            self.faults.append(Fault(self.table.name, "times with an offset from UTC", rule))
        if not read and not self.faults:
            self.faults.append(Fault(self.table.name, "no session with energy", "should have one"))
        if self.faults:
            raise InputError(self.faults[:MAX_FAULTS])
        told = [f"{idle} sessions of less than {LEAST_KWH:g} kWh are left out."] if idle else []
        if self.odd["twice"]:
            told.append(f"{self.odd['twice']} times came twice that night; the first is meant.")
        if self.odd["skipped"]:
            told.append(f"{self.odd['skipped']} times did not exist that night; an hour later.")
        return sorted(read, key=lambda session: session.arrival), told

    def _text(self, row: Mapping[str, str], name: str) -> str:
        return row[self.columns[name]] if name in self.columns else ""

    def _fault(self, place: str, name: str, found: str, rule: str) -> None:
        self.faults.append(Fault(f"{place}, column {self.columns[name]}", found, rule))

    def _time(self, row: Mapping[str, str], place: str, name: str) -> datetime | None:
        text = self._text(row, name)
        if not text:
            if name == "arrival":
                self._fault(place, name, "a blank", "should be a date and time")
            return None
        if self.rules.origin is not None:
            number = self._number(row, place, name)
            if number is None:
                return None
            begin = datetime.combine(self.rules.origin, time())
            return begin + timedelta(hours=number * HOURS[self.rules.time_unit])
        moment = read_time(text, self.rules.reading)
        if isinstance(moment, str):
            self._fault(place, name, shown(text), moment)
            return None
        moment, odd = placed(moment, self.zone)
        if odd:
            self.odd[odd] += 1
        return moment

    def _number(
        self, row: Mapping[str, str], place: str, name: str, low: float = 0.0
    ) -> float | None:
        text = self._text(row, name)
        if not text:
            if name == "energy_kwh":
                self._fault(place, name, "a blank", "should be a number")
            return None
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value) or not low <= value <= 1e6:
            self._fault(place, name, shown(text), f"should be a number from {low:g} to 1,000,000")
            return None
        return value

    def _stay(
        self, row: Mapping[str, str], place: str, arrival: datetime | None, left: datetime | None
    ) -> float | None:
        if arrival is not None and left is not None:
            if (arrival.tzinfo is None) != (left.tzinfo is None):
                self._fault(place, "departure", f"{left}", "should have a time zone as the arrival")
                return None
            hours = (left.timestamp() - arrival.timestamp()) / 3600
            if arrival.tzinfo is None:
                hours = (left - arrival).total_seconds() / 3600
            if hours <= 0:
                rule = f"should be after the arrival, {arrival:%Y-%m-%d %H:%M}"
                self._fault(place, "departure", f"{left:%Y-%m-%d %H:%M}", rule)
                return None
            return hours
        number = self._number(row, place, "duration")
        return None if number is None else number * HOURS[self.rules.duration_unit]
