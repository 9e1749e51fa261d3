"""The audit of what `run --explain` writes, as far as it follows from the other files."""

from collections.abc import Iterator
from typing import cast

from evdash.audit.events import chargers_at
from evdash.audit.record import RunRecord, kind_of
from evdash.files.explanation_rows import BindingRow, ExplanationRow, RevisionRow
from evdash.files.run_tables import IntervalRow

CHARGERS = "chargers"
REACHED_KW = 0.05
REACHED_SHARE = 1e-3
"""Within 0.05 kW or 0.1 % of its limit an element counts as reached."""
ENERGY_KWH = 1e-6


def explained_findings(run: RunRecord) -> Iterator[str]:
    """What is wrong with the tables of a day explained, where there are any."""
    tables = run.explained
    if "explanations.csv" in tables:
        yield from _refusals(run, cast("list[ExplanationRow]", tables["explanations.csv"]))
    if "binding.csv" in tables:
        yield from _bindings(run, cast("list[BindingRow]", tables["binding.csv"]))
    if "revisions.csv" in tables:
        yield from _revisions(run, cast("list[RevisionRow]", tables["revisions.csv"]))


def _refusals(run: RunRecord, rows: list[ExplanationRow]) -> Iterator[str]:
    refused = [row.vehicle for row in run.vehicles if row.status == "refused"]
    if [row.vehicle for row in rows] != refused:
        yield "explanations.csv does not hold everyone refused once, in the order of vehicles.csv"
    reasons = {row.vehicle: kind_of(row.reason) for row in run.vehicles}
    for row in rows:
        if row.cause != reasons.get(row.vehicle):
            yield f"explanations.csv, {row.vehicle}: cause is {row.cause!r}, not its reason's"


def _bindings(run: RunRecord, rows: list[BindingRow]) -> Iterator[str]:
    if len({(row.element, row.interval) for row in rows}) != len(rows):
        yield "binding.csv tells of an element twice in an interval"
    tightest = {(row.binding, row.interval) for row in run.intervals if row.binding}
    if {(row.element, row.interval) for row in rows if row.tightest} != tightest:
        yield "binding.csv: tightest is not what intervals.csv names as binding"
    told = {(row.element, row.interval) for row in rows if row.reached}
    there_are = {row.interval: row for row in run.intervals}
    for interval, row in there_are.items():
        chargers = chargers_at(run.scenario, interval)
        for element, reached in (
            (CHARGERS, 0 < chargers <= row.charging),
            (row.binding, _is_reached(row)),
        ):
            if element and ((element, interval) in told) != reached:
                yield f"binding.csv: {element} is {'' if reached else 'not '}reached in {interval}"
    for entry in rows:
        at = there_are.get(entry.interval)
        if {entry.tightest, entry.reached} not in ({0, 1}, {1}):
            yield f"binding.csv: {entry.element} in {entry.interval} is neither, or not 0 or 1"
        elif entry.reached and entry.element != CHARGERS and (at is None or not _is_reached(at)):
            yield f"binding.csv: {entry.element} is not reached in {entry.interval}"


def _is_reached(row: IntervalRow) -> bool:
    """Whether the station drew all that the tightest element leaves."""
    if row.headroom_kw is None:
        return False
    near = max(REACHED_KW, REACHED_SHARE * row.headroom_kw)
    return row.headroom_kw - row.station_kw <= near


def _revisions(run: RunRecord, rows: list[RevisionRow]) -> Iterator[str]:
    if [row.interval for row in rows] != list(range(1, run.scenario.intervals)):
        yield "revisions.csv does not hold every interval but the first once, in order"
        return
    for row in rows:
        if row.for_newcomers_kwh > row.moved_kwh + ENERGY_KWH:
            yield f"revisions.csv, interval {row.interval}: more moved for newcomers than in all"
