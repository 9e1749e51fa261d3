"""Date-times as files have them, on the scenario's clock.

A scenario's clock never changes: it runs at the offset from UTC that the time zone has at the
scenario's start. Moments with an offset of their own, or read in a named zone, are put on it;
without either, times count as they stand.
"""

import re
from dataclasses import dataclass
from datetime import UTC, date, datetime, timedelta, timezone, tzinfo
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from evdash.domain.arrivals import FIRST_YEAR, LAST_YEAR
from evdash.errors import Fault, InputError

PATTERNS = (
    "%Y-%m-%d %H:%M",
    "%Y-%m-%d %H:%M:%S",
    "%a, %d %b %Y %H:%M:%S GMT",
    "%d.%m.%Y %H:%M",
    "%d.%m.%Y %H:%M:%S",
    "%d.%m.%Y",
)
SLASHED = ("%m/%d/%Y %H:%M", "%m/%d/%Y %H:%M:%S", "%m/%d/%Y %I:%M %p", "%m/%d/%Y %I:%M:%S %p")
"""Month first; the day-first forms are these with %m and %d exchanged."""
ALLOWED = "should be a date and time such as 2019-03-01 06:20, with or without +01:00 or Z"


@dataclass(frozen=True, slots=True)
class Reading:
    """How times are read: `zone` for those without an offset, day or month first for 3/4/2019."""

    zone: str | None = None
    day_first: bool | None = None

    def tz(self) -> tzinfo | None:
        """The zone; InputError where there is none of that name."""
        if self.zone is None:
            return None
        try:
            return ZoneInfo(self.zone)
        except (ZoneInfoNotFoundError, ValueError, OSError) as error:
            rule = "should be a time zone such as America/Los_Angeles or Europe/Berlin"
            raise InputError([Fault("time zone", repr(self.zone), rule)]) from error


def read_time(text: str, reading: Reading) -> datetime | str:
    """A moment, naive or with its offset; else what is allowed instead."""
    tidy = re.sub(r" (?=[+-]\d\d:?\d\d$)", "", re.sub(r"\s+", " ", text.strip()))
    try:
        return _in_bounds(datetime.fromisoformat(tidy))  # the most frequent form, and quick
    except ValueError:
        pass
    slashed = "/" in tidy
    if slashed and reading.day_first is None:
        first, second = (*re.findall(r"\d+", tidy), "0", "0")[:2]
        if int(first) <= 12 and int(second) <= 12:
            return "should say whether the day or the month comes first (day first: yes or no)"
    patterns: tuple[str, ...] = PATTERNS
    if slashed:
        month_first = not reading.day_first and int(re.findall(r"\d+", tidy)[0]) <= 12
        swapped = tuple(p.replace("%m/%d", "%d/%m") for p in SLASHED)
        patterns = SLASHED if month_first else swapped
    for pattern in patterns:
        try:
            moment = datetime.strptime(tidy, pattern)
        except ValueError:
            continue
        return _in_bounds(moment.replace(tzinfo=UTC) if pattern.endswith("GMT") else moment)
    return ALLOWED


def _in_bounds(moment: datetime) -> datetime | str:
    """The moment, in a year a scenario may have."""
    if FIRST_YEAR <= moment.year <= LAST_YEAR:
        return moment
    return f"should be in a year from {FIRST_YEAR} to {LAST_YEAR}"


def first_day_faults(day: date | None) -> list[Fault]:
    """What is wrong with a first day asked for."""
    if day is None or FIRST_YEAR <= day.year <= LAST_YEAR:
        return []
    rule = f"should be in a year from {FIRST_YEAR} to {LAST_YEAR}"
    return [Fault("first day", f"{day}", rule)]


@dataclass(frozen=True, slots=True)
class Clock:
    """The scenario's clock: `offset` from UTC at its start, None where no zone is in play."""

    offset: timedelta | None

    def local(self, moment: datetime) -> datetime:
        """A moment on this clock, without an offset."""
        if moment.tzinfo is None or self.offset is None:
            return moment.replace(tzinfo=None)
        return moment.astimezone(timezone(self.offset)).replace(tzinfo=None)


def placed(moment: datetime, zone: tzinfo | None) -> tuple[datetime, str]:
    """A moment with its offset where a zone is named, and what is odd about it: `skipped` by a
    clock change, `twice` because the clock was put back (the first is meant), or nothing."""
    if moment.tzinfo is not None or zone is None:
        return moment, ""
    here = moment.replace(tzinfo=zone)
    back = here.astimezone(UTC).astimezone(zone).replace(tzinfo=None)
    if back != moment:
        return here, "skipped"
    if here.utcoffset() != here.replace(fold=1).utcoffset():
        return here, "twice"
    return here, ""


def clock_at(start: datetime, zone: tzinfo | None) -> Clock:
    """The clock that `zone` shows at `start`, a local time."""
    return Clock(None if zone is None else start.replace(tzinfo=zone).utcoffset())


def changes_between(start: datetime, end: datetime, zone: tzinfo | None) -> bool:
    """Whether clocks are changed from `start` to `end`, local times."""
    if zone is None:
        return False
    return start.replace(tzinfo=zone).utcoffset() != end.replace(tzinfo=zone).utcoffset()
