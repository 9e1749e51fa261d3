"""The audit of the ledger: what it says of each promise, held against the other files."""

from collections.abc import Iterator

from evdash.audit.events import CUTS, events_of
from evdash.audit.record import RunRecord
from evdash.files.run_tables import LedgerRow, VehicleRow

ENERGY_KWH = 1e-6
KEPT_KWH = 0.01
STATUS = {"kept": "charged", "short": "broken", "released": "released", "open": "charging"}


def ledger_findings(run: RunRecord) -> Iterator[str]:
    """What is wrong with `ledger.csv`; a run of a version without one has none to check."""
    if not run.ledger:
        return
    contracts = {row.vehicle: row for row in run.vehicles if row.status != "refused"}
    if [row.vehicle for row in run.ledger] != list(contracts):
        yield "ledger.csv does not hold every contract once, in the order of vehicles.csv"
        return
    for row in run.ledger:
        yield from _entry_findings(run, row, contracts[row.vehicle])


def _entry_findings(run: RunRecord, row: LedgerRow, vehicle: VehicleRow) -> Iterator[str]:
    name, own = row.vehicle, events_of(run.scenario, row.vehicle, vehicle.arrival_interval)
    asked = sum(event.value or 0.0 for event in own if event.event == "asks_more")
    least = 0.0 if any(event.event in CUTS for event in own) else vehicle.need_kwh
    for told, value, right in (
        ("promised_kwh", row.promised_kwh, vehicle.need_kwh),
        ("promised_by_interval", row.promised_by_interval, vehicle.deadline_interval),
        ("delivered_kwh", row.delivered_kwh, vehicle.delivered_kwh),
    ):
        if abs(value - right) > ENERGY_KWH:
            yield f"ledger.csv, {name}: {told} is {value:g}, vehicles.csv has {right:g}"
    if not least - ENERGY_KWH <= row.revised_kwh <= vehicle.need_kwh + asked + ENERGY_KWH:
        yield f"ledger.csv, {name}: no event explains a promise of {row.revised_kwh:g} kWh"
    if row.revised_by_interval > vehicle.deadline_interval:
        yield f"ledger.csv, {name}: its time was made longer"
    missing = row.revised_kwh - row.delivered_kwh
    if abs(row.short_kwh - (missing if missing > KEPT_KWH else 0.0)) > ENERGY_KWH:
        yield f"ledger.csv, {name}: short_kwh is {row.short_kwh:g}, worked out again {missing:g}"
    if STATUS[row.status] != vehicle.status:
        yield f"ledger.csv, {name}: {row.status}, vehicles.csv says {vehicle.status}"
    if row.status == "short" and not _known(run, row):
        yield f"ledger.csv, {name}: short without an event of the station or the feeder"


def _known(run: RunRecord, row: LedgerRow) -> bool:
    """Whether something the driver did not do happened when the shortfall became known."""
    return any(
        event.interval == row.since_interval and not event.vehicle for event in run.scenario.events
    )
