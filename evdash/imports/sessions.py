"""Recorded sessions as a scenario's arrivals, by the rules of `docs/importing.md`."""

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import date, datetime, time, timedelta
from typing import Any

import numpy as np

from evdash.domain.scenario import LOCAL_TIME_FORMAT
from evdash.errors import Fault, InputError
from evdash.files.draft import Draft, Row
from evdash.files.wording import shown
from evdash.imports.clock import Reading, changes_between, clock_at, placed, read_time
from evdash.imports.session_columns import checked
from evdash.imports.tables import ForeignTable

LEAST_KWH = 0.05
MOST_DAYS = 31
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


def with_sessions(
    draft: Draft, table: ForeignTable, rules: SessionRules
) -> tuple[Draft, tuple[str, ...]]:
    """The draft with these vehicles and as many intervals as they need, and what was assumed.

    Raises InputError with every fault by file, row and column.
    """
    columns = checked(rules.columns, table.columns)
    rules = replace(rules, reading=_in_zone(table, rules.reading))
    read, told = _Reader(table, columns, rules).sessions()
    first, days = _span(read, rules)
    settings, minutes = dict(draft.settings), draft.settings.get("interval_minutes")
    if not isinstance(minutes, int) or minutes < 1 or 60 % minutes:
        raise InputError([Fault("interval_minutes", shown(minutes), "should divide 60")])
    start = datetime.combine(first, time())
    end = start + timedelta(days=days)
    inside = [session for session in read if start <= session.arrival < end]
    if len(inside) < len(read):
        told.append(f"{len(read) - len(inside)} sessions outside the chosen days are left out.")
    if not inside:
        rule = f"sessions are from {read[0].arrival:%Y-%m-%d} to {read[-1].arrival:%Y-%m-%d}"
        raise InputError([Fault("days", f"no session from {first} on", rule)])
    rows, more = _arrivals(inside, settings, rules)
    count = days * 24 * 60 // minutes
    changed, kept = with_days(draft, start, count)
    settings = dict(changed.settings)
    settings["arrivals"] = {"file": "arrivals.csv"} | _seed(settings)
    zone = rules.reading.tz()
    if changes_between(start, end, zone):
        told.append(
            f"Clocks in {rules.reading.zone} change within these days; the scenario's go on as "
            f"they were on {first}, so that every stay keeps its length."
        )
    if zone is not None:
        told.append(f"Times are local times of {rules.reading.zone}.")
    told = [f"{len(inside)} sessions over {days} days from {first}.", *told, *more, *kept]
    return changed.with_settings(settings).with_table("arrivals.csv", rows), tuple(told)


def _in_zone(table: ForeignTable, reading: Reading) -> Reading:
    """The reading in the zone that the table names, as ACN-Data does, where none was asked for."""
    zones = {row.get("timezone", "") for row in table.rows} - {""}
    if reading.zone is not None or len(zones) != 1:
        return reading
    return replace(reading, zone=zones.pop())


def with_days(draft: Draft, start: datetime, count: int) -> tuple[Draft, list[str]]:
    """The draft beginning at `start` with `count` intervals, its profile repeated by clock time."""
    settings = {k: v for k, v in draft.settings.items() if k != "arrivals_until"}
    minutes = int(settings["interval_minutes"])
    began = settings.get("start")
    if isinstance(began, str):
        began = datetime.strptime(began.strip(), LOCAL_TIME_FORMAT)
    if not isinstance(began, datetime):
        raise InputError([Fault("start", shown(began), "should be a date and time")])
    by_clock: dict[time, Row] = {}
    for row in draft.tables.get("profile.csv", ()):
        if row["interval"].isdigit():
            moment = began + timedelta(minutes=minutes * int(row["interval"]))
            by_clock.setdefault(moment.time(), row)
    clocks = [(start + timedelta(minutes=minutes * t)).time() for t in range(count)]
    missing = sorted({clock for clock in clocks if clock not in by_clock})
    if missing:
        found = f"no row for {missing[0]:%H:%M}" + (
            f" and {len(missing) - 1} other times" if len(missing) > 1 else ""
        )
        rule = "the profile should have every clock time of a day, to be repeated"
        raise InputError([Fault("profile.csv", found, rule)])
    profile = tuple(by_clock[clock] | {"interval": str(t)} for t, clock in enumerate(clocks))
    settings |= {"start": start.strftime(LOCAL_TIME_FORMAT), "intervals": count}
    told = ["Prices, loads and generation repeat the scenario's first day by clock time."]
    return draft.with_settings(settings).with_table("profile.csv", profile), told


def _seed(settings: Mapping[str, Any]) -> dict[str, object]:
    arrivals = settings.get("arrivals")
    known = arrivals.get("seed") if isinstance(arrivals, dict) else None
    return {} if known is None else {"seed": known}


def _span(read: list[Session], rules: SessionRules) -> tuple[date, int]:
    """First day and number of days: as asked, else all that the sessions need."""
    first = rules.first_day or min(session.arrival for session in read).date()
    last = max(
        (s.arrival + timedelta(hours=s.stay_h or 0.0) for s in read if s.arrival.date() >= first),
        default=datetime.combine(first, time()),
    )
    if rules.days is not None:
        if not 1 <= rules.days <= MOST_DAYS:
            raise InputError([Fault("days", f"{rules.days}", f"should be 1 to {MOST_DAYS}")])
        return first, rules.days
    days = (last.date() - first).days + 1
    if days > MOST_DAYS:
        last_arrival = max(s.arrival for s in read).date()
        if (last_arrival - first).days + 1 <= MOST_DAYS:
            return first, MOST_DAYS
        rule = f"at most {MOST_DAYS} at once: choose the first day and how many"
        raise InputError([Fault("days", f"sessions over {days} days from {first}", rule)])
    return first, days


def _arrivals(
    sessions: list[Session], settings: Mapping[str, Any], rules: SessionRules
) -> tuple[tuple[Row, ...], list[str]]:
    """Rows of arrivals.csv and what was assumed for them."""
    station, options = settings.get("station"), settings.get("option")
    efficiency = station.get("efficiency") if isinstance(station, dict) else None
    usable = isinstance(efficiency, int | float) and 0 < efficiency <= 1
    if not usable or not isinstance(options, list) or not options:
        rule = "the scenario should have a station's efficiency and price options"
        raise InputError([Fault("scenario.toml", "neither or one of them", rule)])
    assert efficiency is not None  # noqa: S101 - told above
    averages = sorted((float(o["average_kw"]), str(o["name"])) for o in options)
    chosen, told = _options(sessions, averages, rules)
    enlarged = 0
    rows = []
    for session, option, name in zip(sessions, chosen, _names(sessions), strict=True):
        into_battery = session.energy_kwh * float(efficiency)
        soc_out = rules.soc_out if session.soc_out is None else session.soc_out
        battery = session.battery_kwh or rules.battery_kwh
        if session.soc_in is not None and session.battery_kwh is None and soc_out > session.soc_in:
            battery = into_battery / (soc_out - session.soc_in)
        if into_battery > soc_out * battery:
            battery, enlarged = math.ceil(into_battery / soc_out * 10) / 10, enlarged + 1
        rows.append(
            {
                "vehicle": name,
                "arrival": session.arrival.strftime(LOCAL_TIME_FORMAT),
                "option": option,
                "battery_kwh": repr(battery),
                "soc_in": repr(soc_out - into_battery / battery),
                "soc_out": repr(soc_out),
                "max_kw": "" if session.max_kw is None else repr(session.max_kw),
            }
        )
    told.append(
        f"Energy is what the session drew from the grid; times {efficiency:g} it goes into the "
        f"battery. Where the table has none, batteries are of {rules.battery_kwh:g} kWh and are "
        f"left at {rules.soc_out:.0%}; soc_in follows from the energy."
    )
    if enlarged:
        told.append(f"{enlarged} batteries were enlarged to hold the energy of their session.")
    return tuple(rows), told


def _options(
    sessions: list[Session], averages: list[tuple[float, str]], rules: SessionRules
) -> tuple[list[str], list[str]]:
    """The price option of each session: its own, drawn by shares, or by its average power."""
    names = [name for _, name in averages]
    if rules.option_share:
        shares = [rules.option_share.get(name, 0.0) for name in names]
        if set(rules.option_share) - set(names) or abs(sum(shares) - 1) > 1e-6:
            found = ", ".join(f"{k}={v:g}" for k, v in rules.option_share.items())
            rule = f"should be shares of {', '.join(names)} with sum 1"
            raise InputError([Fault("option share", found, rule)])
        drawn = np.random.default_rng(rules.seed).choice(len(names), len(sessions), p=shares)
        return [names[i] for i in drawn], [f"Options are drawn by shares, seed {rules.seed}."]
    if any(session.option for session in sessions):
        return [session.option for session in sessions], ["Options are the table's."]
    chosen, too_fast, unknown = [], 0, 0
    for session in sessions:
        if session.stay_h is None:
            unknown += 1
            chosen.append(names[-1])
            continue
        needed_kw = session.energy_kwh / max(session.stay_h, 1e-9)
        slowest = next((name for kw, name in averages if kw >= needed_kw), None)
        too_fast += slowest is None
        chosen.append(slowest or names[-1])
    counts = ", ".join(f"{name} {count}" for name, count in sorted(Counter(chosen).items()))
    told = [f"Each session has the slowest option that returns it by when it left: {counts}."]
    if too_fast:
        told.append(
            f"{too_fast} sessions drew more than any option's average power and have {names[-1]}; "
            "they are returned later than they left."
        )
    if unknown:
        told.append(f"{unknown} sessions without a departure have {names[-1]}.")
    return chosen, told


def _names(sessions: list[Session]) -> list[str]:
    """Sessions' own names where all are fit and different, else S-0001 and on."""
    own = [session.name for session in sessions]
    fit = all(name and name[0].isalnum() and name.isprintable() and len(name) <= 60 for name in own)
    if fit and len(set(own)) == len(own):
        return own
    return [f"S-{number:04d}" for number in range(1, len(own) + 1)]


class _Reader:
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
                name: self._number(row, place, name)
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
