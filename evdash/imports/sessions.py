"""Recorded sessions as a scenario's arrivals, by the rules of `docs/importing.md`."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from datetime import date, datetime, time, timedelta
from typing import Any

from evdash.errors import Fault, InputError
from evdash.files.draft import Draft
from evdash.imports.clock import Reading, changes_between, first_day_faults
from evdash.imports.columns import checked
from evdash.imports.days import interval_minutes_of, with_days
from evdash.imports.session_arrivals import arrival_rows
from evdash.imports.session_columns import FIELDS, REQUIRED
from evdash.imports.session_rows import Session, SessionReader, SessionRules
from evdash.imports.tables import ForeignTable

MOST_DAYS = 31


def with_sessions(
    draft: Draft, table: ForeignTable, rules: SessionRules
) -> tuple[Draft, tuple[str, ...]]:
    """The draft with these vehicles and as many intervals as they need, and what was assumed.

    Raises InputError with every fault by file, row and column.
    """
    columns = checked(rules.columns, table.columns, FIELDS, REQUIRED)
    rules = replace(rules, reading=_in_zone(table, rules.reading))
    if faults := [*first_day_faults(rules.first_day), *rules.faults()]:
        raise InputError(faults)
    read, told = SessionReader(table, columns, rules).sessions()
    first, days = _span(read, rules)
    settings, minutes = dict(draft.settings), interval_minutes_of(draft.settings)
    start = datetime.combine(first, time())
    end = start + timedelta(days=days)
    inside = [session for session in read if start <= session.arrival < end]
    if len(inside) < len(read):
        told.append(f"{len(read) - len(inside)} sessions outside the chosen days are left out.")
    if not inside:
        rule = f"sessions are from {read[0].arrival:%Y-%m-%d} to {read[-1].arrival:%Y-%m-%d}"
        raise InputError([Fault("days", f"no session from {first} on", rule)])
    rows, more = arrival_rows(inside, settings, rules)
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
    told = [
        f"{len(inside)} sessions over {days} days from {first}.",
        *table.notices,
        *told,
        *more,
        *kept,
    ]
    return changed.with_settings(settings).with_table("arrivals.csv", rows), tuple(told)


def days_of(table: ForeignTable, rules: SessionRules) -> dict[date, int]:
    """How many sessions begin on each day that has any; InputError where they cannot be read."""
    columns = checked(rules.columns, table.columns, FIELDS, REQUIRED)
    rules = replace(rules, reading=_in_zone(table, rules.reading))
    read, _ = SessionReader(table, columns, rules).sessions()
    return dict(sorted(Counter(session.arrival.date() for session in read).items()))


def _in_zone(table: ForeignTable, reading: Reading) -> Reading:
    """The reading in the zone that the table names, as ACN-Data does, where none was asked for."""
    zones = {row.get("timezone", "") for row in table.rows} - {""}
    if reading.zone is not None or len(zones) != 1:
        return reading
    return replace(reading, zone=zones.pop())


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
