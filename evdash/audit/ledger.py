"""The audit of the ledger: what it says of each promise, held against events and other files."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from evdash.audit.asked import Asked
from evdash.audit.events import CUTS, known_by
from evdash.audit.record import RunRecord
from evdash.domain.events import Event
from evdash.files.run_tables import LedgerRow, VehicleRow

ENERGY_KWH = 1e-6
KEPT_KWH = 0.01
STATUS = {"kept": "charged", "short": "broken", "released": "released", "open": "charging"}


@dataclass(frozen=True, slots=True)
class Happening:
    """What happened in one interval while a contract was open; `own` are its driver's events."""

    interval: int
    events: tuple[Event, ...]
    own: tuple[Event, ...]

    @property
    def common(self) -> tuple[Event, ...]:
        """Events of the station, the feeder and forecasts."""
        return tuple(event for event in self.events if not event.vehicle)

    @property
    def texts(self) -> set[str]:
        """How the ledger may word what changed the contract: its driver's events, or, where
        there are none or it became short, the common ones, or else all."""
        others = _worded(self.common or self.events)
        return {_worded(self.own), others} if self.own else {others}

    @property
    def is_cut(self) -> bool:
        """Whether its driver gave up time."""
        return any(event.event in CUTS for event in self.own)


def _worded(events: Sequence[Event]) -> str:
    return "; ".join(event.text for event in events)


def ledger_findings(run: RunRecord) -> Iterator[str]:
    """What is wrong with `ledger.csv`."""
    contracts = {row.vehicle: row for row in run.vehicles if row.status != "refused"}
    if [row.vehicle for row in run.ledger] != list(contracts):
        yield "ledger.csv does not hold every contract once, in the order of vehicles.csv"
        return
    for row in run.ledger:
        asked, vehicle = run.asked.get(row.vehicle), contracts[row.vehicle]
        if asked is None:
            continue  # told by the audit of contracts
        # how much a driver gave up at which of several changes is not in the files: if the
        # contract was open at a later one, that may or may not count
        surely, maybe = (happened_to(run, asked, row, cut_kwh=cut) for cut in (True, False))
        for finding in (
            *_energy_findings(row, vehicle, maybe),
            *_time_findings(row, vehicle, (surely, maybe)),
            *_cause_findings(row, maybe),
        ):
            yield f"ledger.csv, {row.vehicle}: {finding}"


def happened_to(run: RunRecord, asked: Asked, row: LedgerRow, *, cut_kwh: bool) -> list[Happening]:
    """What happened while a contract was open: not yet fulfilled, its time not over.

    With `cut_kwh` a first change by its driver gives up all that the ledger says is released.
    """
    name, hours = row.vehicle, run.scenario.interval_minutes / 60
    power = run.power_kw.get(name, np.zeros(run.scenario.intervals))
    owed, deadline = max(row.promised_kwh, row.revised_kwh), asked.deadline
    known, found = known_by(run.scenario, run.scenario.intervals), []
    for interval in sorted({event.interval for event in known}):
        delivered = float(power[:interval].sum()) * hours
        if not asked.first < interval < deadline or owed - delivered <= ENERGY_KWH:
            continue
        events = tuple(event for event in known if event.interval == interval)
        own = tuple(event for event in events if event.vehicle == name)
        found.append(Happening(interval, events, own))
        deadline = _deadline_after(deadline, own)
        if cut_kwh and found[-1].is_cut:
            owed = row.revised_kwh
    return found


def _deadline_after(deadline: int, own: Sequence[Event]) -> int:
    for event in own:
        if event.event == "no_show":
            deadline = min(deadline, event.interval)
        elif event.event == "leaves_early" and event.until_interval is not None:
            deadline = min(deadline, event.until_interval)
    return deadline


def _energy_findings(
    row: LedgerRow, vehicle: VehicleRow, while_open: list[Happening]
) -> Iterator[str]:
    for told, value, right in (
        ("promised_kwh", row.promised_kwh, vehicle.need_kwh),
        ("delivered_kwh", row.delivered_kwh, vehicle.delivered_kwh),
    ):
        if abs(value - right) > ENERGY_KWH:
            yield f"{told} is {value:g}, vehicles.csv has {right:g}"
    own = [event for happening in while_open for event in happening.own]
    asked = sum(event.value or 0.0 for event in own if event.event == "asks_more")
    granted = row.revised_kwh - row.promised_kwh + row.released_kwh
    if not -ENERGY_KWH <= granted <= asked + ENERGY_KWH:
        yield (
            f"promised {row.promised_kwh:g} kWh, released {row.released_kwh:g} kWh and at most "
            f"{asked:g} kWh granted do not make a promise of {row.revised_kwh:g} kWh"
        )
    if row.released_kwh > ENERGY_KWH and not any(event.event in CUTS for event in own):
        yield f"{row.released_kwh:g} kWh released, yet its driver gave nothing up"
    missing = row.revised_kwh - row.delivered_kwh
    right = missing if missing > KEPT_KWH else 0.0
    if abs(row.short_kwh - right) > ENERGY_KWH:
        yield f"short_kwh is {row.short_kwh:g}, worked out again {right:g}"
    if missing < -KEPT_KWH:
        yield f"delivered {-missing:g} kWh more than it was promised"


def _time_findings(
    row: LedgerRow, vehicle: VehicleRow, readings: tuple[list[Happening], ...]
) -> Iterator[str]:
    if row.option != vehicle.option:
        yield f"option is {row.option}, vehicles.csv has {vehicle.option}"
    if row.promised_by_interval != vehicle.deadline_interval:
        yield (
            f"promised_by_interval is {row.promised_by_interval}, vehicles.csv has "
            f"{vehicle.deadline_interval}"
        )
    by = [
        _deadline_after(vehicle.deadline_interval, [e for happened in one for e in happened.own])
        for one in readings
    ]
    if row.revised_by_interval not in by:
        yield f"revised_by_interval is {row.revised_by_interval}, worked out again {by[0]}"
    if STATUS[row.status] != vehicle.status:
        yield f"{row.status}, vehicles.csv says {vehicle.status}"


def _cause_findings(row: LedgerRow, happened: list[Happening]) -> Iterator[str]:
    """`since_interval` and `cause`, held to what happened while the contract was open."""
    since, begins = row.since_interval, row.status in ("short", "released")
    changed = (
        row.revised_kwh > row.promised_kwh + ENERGY_KWH
        or row.released_kwh > ENERGY_KWH
        or row.revised_by_interval < row.promised_by_interval
    )
    telling = [one for one in happened if since is None or one.interval >= since]
    if row.status == "short" and not any(h.interval == since and h.common for h in happened):
        yield "short without an event of the station or the feeder at its since_interval"
    elif row.status == "released" and not any(h.interval == since and h.is_cut for h in happened):
        yield "released without a change by its driver at its since_interval"
    elif not begins and since is not None:
        yield f"{row.status}, yet since_interval is {since}"
    elif not _told_by(row.cause, telling, begins=begins):
        yield f"nothing that happened while it was open reads {row.cause!r}"
    elif changed and not row.cause:
        yield "its terms were changed, yet cause is blank"


def _told_by(cause: str, happened: Sequence[Happening], *, begins: bool) -> bool:
    """Whether a cause is made of what happened, in order; of the first of it where it `begins`."""
    if not cause:
        return not begins
    for n, happening in enumerate(happened[:1] if begins else happened):
        for text in happening.texts:
            if cause == text:
                return True
            rest = cause.removeprefix(f"{text}; ")
            if rest != cause and _told_by(rest, happened[n + 1 :], begins=False):
                return True
    return False
