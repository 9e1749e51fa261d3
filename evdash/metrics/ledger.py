"""The ledger: what became of every promise, since when that is known, and by which event."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from evdash.domain.events import Event
from evdash.domain.trace import Happening, Revision, Trace
from evdash.metrics.records import VehicleRecord, vehicle_records

LedgerStatus = Literal["open", "kept", "short", "released"]


@dataclass(frozen=True, slots=True)
class Change:
    """What events of one interval did to one contract.

    `promised_kwh` and `deadline_interval` are the terms agreed afterwards; `more_kwh` is by how
    much its driver's wish changed the promise (negative: given up), `short_kwh` what more of it
    cannot be kept (negative: made good). `events` are those that did it.
    """

    interval: int
    events: tuple[Event, ...]
    promised_kwh: float
    deadline_interval: int
    more_kwh: float
    short_kwh: float

    @property
    def text(self) -> str:
        """The events in plain words."""
        return "; ".join(event.text for event in self.events)


@dataclass(frozen=True, slots=True)
class LedgerEntry:
    """One contract: energy in kWh, grid side; intervals are the first in which it is too late.

    `promised` is the contract as made, `revised` as last agreed with its driver. `short_kwh` is
    what of `revised_kwh` is missing, or is known not to come; `released_kwh` what its driver
    gave up. Status: open (under way, not short), kept, short, released (kept but for what its
    driver gave up).
    """

    vehicle: str
    option: str
    promised_kwh: float
    promised_by_interval: int
    revised_kwh: float
    revised_by_interval: int
    delivered_kwh: float
    short_kwh: float
    released_kwh: float
    status: LedgerStatus
    changes: tuple[Change, ...] = ()

    @property
    def since_interval(self) -> int | None:
        """When it became known that the contract would not be kept as made; None if it is."""
        telling = self._telling()
        return telling[0].interval if telling else None

    @property
    def cause(self) -> str:
        """Which events changed it, in plain words; empty where nothing did."""
        telling = self._telling() or self.changes
        return "; ".join(dict.fromkeys(change.text for change in telling))

    def _telling(self) -> tuple[Change, ...]:
        """The changes that are behind the status."""
        if self.status == "short":
            return tuple(change for change in self.changes if change.short_kwh > 0)
        if self.status == "released":
            return tuple(change for change in self.changes if change.more_kwh < 0)
        return ()


def ledger(trace: Trace) -> tuple[LedgerEntry, ...]:
    """An entry for every contract made so far, in order of arrival."""
    changes: dict[str, list[Change]] = {}
    for happening in trace.happenings:
        for revision in happening.revisions:
            changes.setdefault(revision.vehicle, []).append(change_of(happening, revision))
    return tuple(
        _entry(record, tuple(changes.get(record.vehicle, ())))
        for record in vehicle_records(trace)
        if record.status != "refused"
    )


def broken_promises(entries: Iterable[LedgerEntry]) -> tuple[LedgerEntry, ...]:
    """Contracts that were not kept, or cannot be as things stand: known from that moment on."""
    return tuple(entry for entry in entries if entry.status == "short")


def change_of(happening: Happening, revision: Revision) -> Change:
    """What a happening did to one contract, and by which of its events."""
    own = tuple(e for e in happening.events if e.vehicle == revision.vehicle)
    common = tuple(e for e in happening.events if not e.vehicle)
    events = own if own and revision.short_kwh <= 0 else common or happening.events
    return Change(
        interval=happening.interval,
        events=events,
        promised_kwh=revision.after.promised_kwh,
        deadline_interval=revision.after.request.deadline_interval,
        more_kwh=revision.promised_kwh,
        short_kwh=revision.short_kwh,
    )


def _entry(record: VehicleRecord, changes: tuple[Change, ...]) -> LedgerEntry:
    request = record.request
    status: LedgerStatus = "open" if record.status == "charging" else "kept"
    if record.short_kwh:
        status = "short"
    elif record.status == "released":
        status = "released"
    return LedgerEntry(
        vehicle=record.vehicle,
        option=request.option,
        promised_kwh=request.need_kwh,
        promised_by_interval=request.deadline_interval,
        revised_kwh=record.promised_kwh,
        revised_by_interval=changes[-1].deadline_interval if changes else request.deadline_interval,
        delivered_kwh=record.delivered_kwh,
        short_kwh=record.short_kwh,
        released_kwh=sum(max(0.0, -change.more_kwh) for change in changes),
        status=status,
        changes=changes,
    )
