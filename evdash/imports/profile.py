"""Prices, loads and generation by date and time as a scenario's profile (`docs/importing.md`)."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import date, datetime, time, timedelta

import numpy as np

from evdash.domain.arrivals import LOCAL_TIME_FORMAT
from evdash.domain.scenario import ProfileRow
from evdash.errors import Fault, InputError
from evdash.files.draft import Draft
from evdash.files.wording import shown
from evdash.imports.clock import Reading, changes_between, clock_at, first_day_faults
from evdash.imports.columns import checked
from evdash.imports.days import interval_minutes_of, interval_of, start_of, with_days
from evdash.imports.profile_columns import FIELDS, REQUIRED, TARGETS, UNITS
from evdash.imports.series import (
    MAX_FAULTS,
    Moments,
    bridged,
    held,
    in_order,
    means,
    missing_runs,
    moment_of,
    time_in,
    usual_step_s,
)
from evdash.imports.tables import ForeignTable

MOST_DAYS = 366
LARGEST = 1e9
CLOCK = "%Y-%m-%d %H:%M"


@dataclass(frozen=True, slots=True)
class ProfileRules:
    """How a table by time is read: `columns` and `units` by field.

    `peak_kw` is what load or generation in kW or MW is divided by, the table's own peak where
    none is stated. `first_day` is the scenario's first, and `days` how many it has; as they are
    where None. A value holds for `hold_minutes` at most, the table's usual step where None.
    `at_end`: times are the ends of what they stand for.
    """

    columns: Mapping[str, str]
    units: Mapping[str, str]
    reading: Reading = field(default_factory=Reading)
    peak_kw: Mapping[str, float] = field(default_factory=dict)
    first_day: date | None = None
    days: int | None = None
    hold_minutes: float | None = None
    at_end: bool = False


@dataclass(frozen=True, slots=True)
class _Span:
    """The scenario's intervals: when the first begins, how long they are, how many."""

    start: datetime
    minutes: int
    count: int

    @property
    def length_s(self) -> float:
        return 60.0 * self.minutes

    def time_of(self, interval: int) -> datetime:
        return moment_of(self.start, interval, self.minutes)


def with_profile(
    draft: Draft, table: ForeignTable, rules: ProfileRules
) -> tuple[Draft, tuple[str, ...]]:
    """The draft with the table's values over its intervals, and what was done to them.

    Raises InputError with every fault by file, row and column; nothing is filled in.
    """
    columns = checked(rules.columns, table.columns, FIELDS, REQUIRED)
    fields = [name for name in TARGETS if name in columns]
    _refuse_unstated(fields, rules)
    began = start_of(draft.settings)
    draft, span, moved = _on_its_days(draft, began, rules)
    table, turned = in_order(table, columns["time"], rules.reading)
    told = [*table.notices, *turned]
    moments = Moments(table, columns["time"], rules.reading)
    values = {name: _numbers(table, columns[name], name, rules, moments) for name in fields}
    seconds = moments.seconds(clock_at(span.start, moments.zone), span.start)
    step_s = usual_step_s(seconds, table.name) if len(seconds) > 1 else 0.0
    hold_s = rules.hold_minutes * 60 if rules.hold_minutes else step_s
    if not hold_s:
        usual_step_s(seconds, table.name)  # tells that one row says nothing of how long it holds
    told.append(_span_text(len(seconds), step_s, hold_s, rules, span))
    known: dict[str, np.ndarray] = {}
    faults: list[Fault] = []
    for name in fields:
        there = np.flatnonzero(~np.isnan(values[name]))  # a blank is as good as no row
        begins, ends = held(seconds[there], hold_s, rules.at_end)
        known[name] = means(begins, ends, values[name][there], span.length_s, span.count)
        places = [f"{table.places[i]}, column {columns[name]}" for i in there]
        faults += _gaps(places, seconds[there], known[name], span)
        over = bridged(begins, ends, step_s, span.length_s * span.count)
        if len(over):
            told.append(_bridged_text(columns[name], begins[over], ends[over], span))
    if faults:
        raise InputError(faults[:MAX_FAULTS])
    for name in fields:
        known[name], text = _scaled(known[name], values[name], name, columns[name], rules)
        told.append(text)
    told += _clock_texts(moments, span)
    kept = [column for name, column in TARGETS.items() if name not in fields]
    if kept:
        told.append(f"As before, interval by interval: {', '.join(kept)}.")
    return _with_rows(draft, known), (*moved, *told)


def first_day_for(draft: Draft, table: ForeignTable, column: str, reading: Reading) -> date | None:
    """The table's first whole day, where the scenario's own is none of its days; else None."""
    try:
        own = start_of(draft.settings).date()
    except InputError:
        return None
    ends = [time_in(table.rows[i][column], reading) for i in (0, -1)] if column else []
    days = sorted(end.date() for end in ends if isinstance(end, datetime))
    if len(days) < 2 or days[0] <= own <= days[1]:
        return None
    first = min(end.replace(tzinfo=None) for end in ends if isinstance(end, datetime))
    return days[0] if first.time() == time() or days[0] == days[1] else days[0] + timedelta(1)


def _refuse_unstated(fields: list[str], rules: ProfileRules) -> None:
    faults = []
    if not fields:
        rule = f"should be at least one of {', '.join(TARGETS)}"
        faults.append(Fault("mapping", "no column of values", rule))
    for name in fields:
        unit = rules.units.get(name)
        if unit not in UNITS[name]:
            rule = f"should be {', '.join(UNITS[name])}"
            faults.append(Fault(f"unit of {name}", shown(unit) if unit else "none", rule))
    for name, peak in rules.peak_kw.items():
        if name not in fields or rules.units.get(name) == "pu" or name == "price":
            rule = "is for a load or generation in kW or MW"
            faults.append(Fault(f"peak of {name}", f"{peak:g} kW", rule))
        elif not math.isfinite(peak) or peak <= 0:
            faults.append(Fault(f"peak of {name}", f"{peak:g} kW", "should be above 0 kW"))
    hold = rules.hold_minutes
    if hold is not None and not (math.isfinite(hold) and hold > 0):
        faults.append(Fault("how long a value holds", f"{hold:g} min", "should be above 0 min"))
    faults += first_day_faults(rules.first_day)
    if rules.days is not None and not 1 <= rules.days <= MOST_DAYS:
        faults.append(Fault("days", f"{rules.days}", f"should be 1 to {MOST_DAYS}"))
    if faults:
        raise InputError(faults)


def _on_its_days(
    draft: Draft, began: datetime, rules: ProfileRules
) -> tuple[Draft, _Span, list[str]]:
    """The draft on the days asked for, its intervals, and what was done for it."""
    minutes = interval_minutes_of(draft.settings)
    start = datetime.combine(rules.first_day or began.date(), began.time())
    told: list[str] = []
    if rules.days is not None:
        draft, told = with_days(draft, began, rules.days * 24 * 60 // minutes)
    count = draft.settings.get("intervals")
    rows = draft.tables.get("profile.csv", ())
    known = {interval_of(row) for row in rows}
    if not isinstance(count, int) or count != len(rows) or known != {*range(len(rows))}:
        rule = "should have one row for each interval of scenario.toml"
        raise InputError([Fault("profile.csv", f"{len(rows)} rows", rule)])
    moved, more = _moved(draft, start, began)
    return moved, _Span(start, minutes, count), told + more


def _numbers(
    table: ForeignTable, column: str, name: str, rules: ProfileRules, moments: Moments
) -> np.ndarray:
    """A column in $/kWh, kW or pu, shape (rows,), NaN where it is blank; faults go to `moments`."""
    unit = rules.units[name]
    size = UNITS[name][unit]
    most = _most(name)
    low, high = (-most if name == "price" else 0.0) / size, most / size
    found = np.full(len(table.rows), np.nan)
    for i, (row, place) in enumerate(zip(table.rows, table.places, strict=True)):
        if not row[column]:
            continue
        try:
            value = float(row[column])
        except ValueError:
            value = math.nan
        if not low <= value <= high:
            rule = f"should be a number from {low:,g} to {high:,g} {unit}"
            moments.faults.append(Fault(f"{place}, column {column}", shown(row[column]), rule))
            continue
        # divided by whole numbers where it can be, so that 25 ct are 0.25 $ and not nearly so
        found[i] = value / round(1 / size) if size < 1 else value * size
    if np.isnan(found).all() and not moments.faults:
        moments.faults.append(Fault(f"{table.name}, column {column}", "no number", "should have"))
    return found


def _most(name: str) -> float:
    """The largest value of a field, $/kWh or kW."""
    declared = ProfileRow.model_fields[TARGETS[name]].metadata
    return next(float(m.le) for m in declared if hasattr(m, "le")) if name == "price" else LARGEST


def _gaps(
    places: Sequence[str], seconds: np.ndarray, known: np.ndarray, span: _Span
) -> list[Fault]:
    """Every run of intervals without a value, by the row it comes after."""
    first = span.start + timedelta(seconds=float(seconds[0]))
    last = span.start + timedelta(seconds=float(seconds[-1]))
    rule = (
        f"every interval should be covered; rows are from {first:{CLOCK}} to {last:{CLOCK}}. "
        "Choose another first day, or let values hold for longer"
    )
    faults = []
    for low, high in missing_runs(known):
        row = int(np.searchsorted(seconds, low * span.length_s, side="right")) - 1
        begin, end = span.time_of(low), span.time_of(high + 1)
        which = f"interval {low}" if low == high else f"intervals {low} to {high}"
        found = f"no value for all of {begin:{CLOCK}} to {end:{CLOCK}}, {which}"
        faults.append(Fault(places[max(row, 0)], found, rule))
    return faults


def _scaled(
    known: np.ndarray, values: np.ndarray, name: str, column: str, rules: ProfileRules
) -> tuple[np.ndarray, str]:
    """Means as profile.csv has them, and how they came about."""
    unit, target = rules.units[name], TARGETS[name]
    said = f"{target} is {column} in {unit}"
    if name == "price" or unit == "pu":
        return known, f"{said}."
    stated = rules.peak_kw.get(name)
    peak = float(np.nanmax(values)) if stated is None else stated
    if peak <= 0:
        raise InputError([Fault(f"column {column}", "no power above 0", "state its peak in kW")])
    whose = "the table's own peak" if stated is None else "the stated peak"
    return known / peak, f"{said}, per unit of {whose}, {peak:,g} kW."


def _span_text(rows: int, step_s: float, hold_s: float, rules: ProfileRules, span: _Span) -> str:
    each = f", usually one each {step_s / 60:g} min" if rows > 1 else ""
    told = (
        f"{rows:,} rows{each}, on {span.count} intervals of {span.minutes} min from "
        f"{span.start:{CLOCK}}: an interval has the time-weighted mean of the values that hold "
        "in it, energy unchanged"
    )
    how = "until its time" if rules.at_end else "from its time"
    return f"{told}; a row holds {how}, for {hold_s / 60:g} min at most."


def _bridged_text(column: str, begins: np.ndarray, ends: np.ndarray, span: _Span) -> str:
    longest = int(np.argmax(ends - begins))
    where = span.start + timedelta(seconds=float(begins[longest]))
    minutes = (ends[longest] - begins[longest]) / 60
    return (
        f"Gaps in {column}: {len(begins)} values hold for longer than the usual step, one from "
        f"{where:{CLOCK}} for {minutes:g} min."
    )


def _clock_texts(moments: Moments, span: _Span) -> list[str]:
    told = []
    if moments.repeated:
        told.append(
            f"{moments.repeated} rows are in an hour that comes twice as clocks are put back; the "
            "first of them is the earlier."
        )
    if changes_between(span.start, span.time_of(span.count), moments.zone):
        day = f"{span.start:%Y-%m-%d}"
        told.append(f"Clocks change within these days; the scenario's go on as on {day}.")
    if moments.zone is not None:
        told.append(f"The scenario's clock is that of {moments.zone} at its start.")
    return told


def _with_rows(draft: Draft, known: Mapping[str, np.ndarray]) -> Draft:
    rows = []
    for row in draft.tables["profile.csv"]:
        interval = interval_of(row)
        filled = {TARGETS[name]: repr(float(values[interval])) for name, values in known.items()}
        rows.append(row | filled)
    return draft.with_table("profile.csv", tuple(rows))


def _moved(draft: Draft, start: datetime, began: datetime) -> tuple[Draft, list[str]]:
    """The draft beginning on another day, recorded arrivals moved along."""
    if start == began:
        return draft, []
    told = [f"The scenario begins at {start:{CLOCK}}."]
    changed = draft.with_settings(
        dict(draft.settings) | {"start": start.strftime(LOCAL_TIME_FORMAT)}
    )
    if not draft.is_recorded or not draft.tables.get("arrivals.csv"):
        return changed, told
    rows = []
    for row in draft.tables["arrivals.csv"]:
        try:
            moment = datetime.strptime(row["arrival"].strip(), LOCAL_TIME_FORMAT)
        except ValueError:
            rows.append(row)  # HH:MM, which moves by itself, or a fault that is told when checked
            continue
        rows.append(row | {"arrival": (moment + (start - began)).strftime(LOCAL_TIME_FORMAT)})
    told.append(f"Arrivals are moved along by {(start - began).days} days.")
    return changed.with_table("arrivals.csv", tuple(rows)), told
