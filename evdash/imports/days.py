"""Which days a scenario stands for: when it begins, and its profile over more of them."""

from collections.abc import Mapping
from datetime import datetime, time, timedelta
from typing import Any

from evdash.domain.arrivals import LOCAL_TIME_FORMAT
from evdash.errors import Fault, InputError
from evdash.files.draft import Draft, Row
from evdash.files.wording import shown

LONGEST = 6
"""Digits of an interval's number; there are not so many intervals."""


def start_of(settings: Mapping[str, Any]) -> datetime:
    """When a draft begins, local time; InputError where it does not say."""
    began = settings.get("start")
    if isinstance(began, str):
        try:
            began = datetime.strptime(began.strip(), LOCAL_TIME_FORMAT)
        except ValueError:
            began = settings["start"]
    if not isinstance(began, datetime):
        raise InputError([Fault("start", shown(began), "should be a date and time")])
    return began


def interval_minutes_of(settings: Mapping[str, Any]) -> int:
    """Minutes of an interval; InputError where they do not divide an hour."""
    minutes = settings.get("interval_minutes")
    if not isinstance(minutes, int) or minutes < 1 or 60 % minutes:
        raise InputError([Fault("interval_minutes", shown(minutes), "should divide 60")])
    return minutes


def interval_of(row: Row) -> int | None:
    """The interval a row of profile.csv is for; None where it names none."""
    text = row["interval"].strip()
    return int(text) if text.isascii() and text.isdigit() and len(text) <= LONGEST else None


def with_days(draft: Draft, start: datetime, count: int) -> tuple[Draft, list[str]]:
    """The draft beginning at `start` with `count` intervals.

    Its profile is kept at the moments it has; at others its first day is repeated by clock time.
    """
    settings = dict(draft.settings)
    told = []
    if settings.pop("arrivals_until", None) is not None:
        told.append("arrivals_until is left out: vehicles may arrive until the end.")
    minutes = int(settings["interval_minutes"])
    began = start_of(settings)
    known: dict[datetime, Row] = {}
    by_clock: dict[time, Row] = {}
    for row in draft.tables.get("profile.csv", ()):
        if (interval := interval_of(row)) is not None:
            moment = began + timedelta(minutes=minutes * interval)
            known[moment] = row
            by_clock.setdefault(moment.time(), row)
    moments = [start + timedelta(minutes=minutes * t) for t in range(count)]
    missing = sorted({m.time() for m in moments if m not in known and m.time() not in by_clock})
    if missing:
        found = f"no row for {missing[0]:%H:%M}" + (
            f" and {len(missing) - 1} other times" if len(missing) > 1 else ""
        )
        rule = "the profile should have every clock time of a day, to be repeated"
        raise InputError([Fault("profile.csv", found, rule)])
    profile = tuple(
        (known.get(moment) or by_clock[moment.time()]) | {"interval": str(t)}
        for t, moment in enumerate(moments)
    )
    kept = sum(moment in known for moment in moments)
    if kept:
        told.append(f"Prices, loads and generation are kept in {kept} intervals.")
    if kept < count:
        where = "in the others" if kept else "all through"
        told.append(
            f"Prices, loads and generation repeat the scenario's first day by clock time {where}."
        )
    settings |= {"start": start.strftime(LOCAL_TIME_FORMAT), "intervals": count}
    return draft.with_settings(settings).with_table("profile.csv", profile), told
