"""Values by time: from when to when each holds on the scenario's clock, and interval means.

A value holds from its row's time to the next row's, or, where times are the ends of what they
stand for, from the row before to its own; in either case no longer than `hold`. What no value
holds over is a gap.
"""

from collections import Counter
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np

from evdash.errors import Fault, InputError
from evdash.files.wording import shown
from evdash.imports.clock import Clock, Reading, placed, read_time
from evdash.imports.tables import ForeignTable

MAX_FAULTS = 200
SPAN = " - "
"""Between both ends where a cell tells a span, `01.03.2024 00:00 - 01.03.2024 01:00`."""
SKIPPED = "no time of that zone, as clocks are put forward over it"
ENOUGH = 1e-6
"""Seconds by which a whole interval may seem uncovered for rounding."""


def in_order(table: ForeignTable, column: str, reading: Reading) -> tuple[ForeignTable, list[str]]:
    """The table from its earliest row on where it runs backwards in time, and that it did."""
    first, last = (time_in(row[column], reading) for row in (table.rows[0], table.rows[-1]))
    if isinstance(first, str) or isinstance(last, str):
        return table, []
    if (first.tzinfo is None) != (last.tzinfo is None) or first <= last:
        return table, []
    turned = replace(table, rows=table.rows[::-1], places=table.places[::-1])
    return turned, ["Rows run backwards in time and were read from the last one on."]


def time_in(text: str, reading: Reading) -> datetime | str:
    """A cell's moment, a span's beginning; else what is allowed instead."""
    return read_time(text.partition(SPAN)[0], reading) if text else "should be a date and time"


class Moments:
    """The times of a table's rows, read from top to bottom; `faults` gathers what is wrong.

    An hour that comes twice as clocks are put back is the earlier one as long as times increase,
    then the later one; `repeated` counts such rows.
    """

    def __init__(self, table: ForeignTable, column: str, reading: Reading) -> None:
        self.table, self.column, self.reading = table, column, reading
        self.zone = reading.tz()
        self.faults: list[Fault] = []
        self.repeated = 0
        self.times: list[datetime | None] = []
        before: datetime | None = None
        for row, place in zip(table.rows, table.places, strict=True):
            before = self._read(row[column], f"{place}, column {column}", before)
            self.times.append(before)
        known = {time.tzinfo is None for time in self.times if time is not None}
        if len(known) > 1:
            rule = "all should have an offset from UTC, or the time zone be named"
            self.faults.append(Fault(table.name, "times with and without an offset", rule))
        elif self.zone is None and known == {False}:
            rule = "name the station's time zone, such as America/Los_Angeles"
            self.faults.append(Fault(table.name, "times with an offset from UTC", rule))

    def _read(self, text: str, where: str, before: datetime | None) -> datetime | None:
        """A row's moment: in UTC where its offset is known, else as it stands."""
        moment = time_in(text, self.reading)
        if isinstance(moment, str):
            self.faults.append(Fault(where, shown(text), moment))
            return None
        here, odd = placed(moment, self.zone)
        if odd == "skipped":
            self.faults.append(Fault(where, f"{shown(text)}, {SKIPPED}", "should be left out"))
            return None
        if here.tzinfo is None:
            return here
        moment_utc = here.astimezone(UTC)
        if odd == "twice":
            self.repeated += 1
            if before is not None and before.tzinfo is not None and before >= moment_utc:
                moment_utc = here.replace(fold=1).astimezone(UTC)
        return moment_utc

    def seconds(self, clock: Clock, start: datetime) -> np.ndarray:
        """Times in s after `start` on the scenario's clock, shape (rows,), increasing.

        InputError tells every row whose time cannot be read or is not after the one before.
        """
        local = [None if time is None else clock.local(time) for time in self.times]
        for place, before, time in zip(self.table.places[1:], local, local[1:], strict=False):
            if before is None or time is None or time > before:
                continue
            where = f"{place}, column {self.column}"
            if time == before:
                rule = "each time once; name the time zone if clocks were put back"
                self.faults.append(Fault(where, f"{time} a second time", rule))
            else:
                rule = f"should be after the row before, {before}; an hour that comes twice as "
                rule += "clocks are put back is told apart where the time zone is named"
                self.faults.append(Fault(where, f"{time}", rule))
        if self.faults:
            raise InputError(self.faults[:MAX_FAULTS])
        return np.array([(time - start).total_seconds() for time in local if time is not None])


def usual_step_s(seconds: np.ndarray, name: str) -> float:
    """The commonest step between rows, s; the shortest of equally common ones."""
    if len(seconds) < 2:
        rule = "should be at least two, or say how long a value holds"
        raise InputError([Fault(name, "one row", rule)])
    counts = Counter(np.diff(seconds).tolist())
    return float(min(counts, key=lambda step: (-counts[step], step)))


def held(seconds: np.ndarray, hold_s: float, at_end: bool) -> tuple[np.ndarray, np.ndarray]:
    """From when and until when each row's value holds, s, both of shape (rows,).

    `at_end`: rows tell the end of what they stand for, not its beginning.
    """
    if at_end:
        return np.maximum(np.append(-np.inf, seconds[:-1]), seconds - hold_s), seconds
    return seconds, np.minimum(np.append(seconds[1:], np.inf), seconds + hold_s)


def bridged(begins: np.ndarray, ends: np.ndarray, step_s: float, until_s: float) -> np.ndarray:
    """Rows whose value holds beyond the usual step within the scenario, indices."""
    longer = ends - begins > step_s + ENOUGH
    return np.flatnonzero(longer & (ends > 0) & (begins < until_s))


def means(
    begins: np.ndarray, ends: np.ndarray, values: np.ndarray, length_s: float, count: int
) -> np.ndarray:
    """Time-weighted mean of each interval, shape (count,); NaN where part of it has no value.

    `values` of shape (rows,) hold from `begins` to `ends`, s after the first interval begins.
    The mean times `length_s` is the integral, so that energy is conserved; a value that covers
    its interval whole is returned unchanged.
    """
    found = np.full(count, np.nan)
    for t in range(count):
        first, last = t * length_s, (t + 1) * length_s
        low = int(np.searchsorted(ends, first, side="right"))
        high = int(np.searchsorted(begins, last, side="left"))
        weights = np.minimum(ends[low:high], last) - np.maximum(begins[low:high], first)
        if weights.sum() >= length_s - ENOUGH:
            part = values[low:high]
            same = len(set(part.tolist())) == 1
            found[t] = part[0] if same else float(weights @ part) / weights.sum()
    return found


def missing_runs(values: np.ndarray) -> list[tuple[int, int]]:
    """First and last interval of every run without a value."""
    runs: list[tuple[int, int]] = []
    for t in np.flatnonzero(np.isnan(values)).tolist():
        if runs and runs[-1][1] == t - 1:
            runs[-1] = (runs[-1][0], t)
        else:
            runs.append((t, t))
    return runs


def moment_of(start: datetime, interval: int, minutes: int) -> datetime:
    """When an interval begins."""
    return start + timedelta(minutes=minutes * interval)
