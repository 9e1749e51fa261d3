"""The audit of contracts: every promise worked out again from the scenario's own arrivals."""

import math
from collections.abc import Iterator

import numpy as np

from evdash.audit.asked import Asked
from evdash.audit.events import CUTS, events_of, is_there
from evdash.audit.record import RunRecord
from evdash.checker.contracts import Promise
from evdash.domain.events import Event
from evdash.domain.limits import Floats
from evdash.files.run_tables import VehicleRow

ENERGY_KWH = 1e-6
KEPT_KWH = 0.01
POWER_KW = 1e-6
MONEY = 1e-6


def contract_findings(run: RunRecord) -> Iterator[str]:
    """What is wrong with who was served, how much, when and for how much money."""
    rows = {row.vehicle: row for row in run.vehicles}
    if len(rows) != len(run.vehicles):
        yield "vehicles.csv names a vehicle twice"
    for name in sorted(set(rows) ^ set(run.asked)):
        yield f"{name} is in only one of arrivals.csv and vehicles.csv"
    for name in sorted(set(run.power_kw) - set(rows)):
        yield f"{name} is charged in power.csv and missing in vehicles.csv"
    order = [run.asked[row.vehicle].first for row in run.vehicles if row.vehicle in run.asked]
    if order != sorted(order):
        yield "vehicles.csv is not in the order in which vehicles ask"
    for name, asked in run.asked.items():
        if name in rows:
            yield from _vehicle_findings(run, asked, rows[name])


def _vehicle_findings(run: RunRecord, asked: Asked, row: VehicleRow) -> Iterator[str]:
    scenario, name = run.scenario, row.vehicle
    power = run.power_kw.get(name, np.zeros(scenario.intervals))
    delivered = math.fsum(power.tolist()) * scenario.interval_minutes / 60
    for told, value, right in (
        ("need_kwh", row.need_kwh, asked.need_kwh),
        ("arrival_interval", row.arrival_interval, asked.first),
        ("deadline_interval", row.deadline_interval, asked.deadline),
        ("delivered_kwh", row.delivered_kwh, delivered),
    ):
        if abs(value - right) > ENERGY_KWH:
            yield f"{name}: {told} is {value:g}, worked out again {right:g}"
    if row.option != asked.option.name:
        yield f"{name}: option is {row.option}, arrivals.csv says {asked.option.name}"
    drawn = np.flatnonzero(power)
    completed = int(drawn[-1]) if row.status == "charged" and len(drawn) else None
    if row.completed_interval != completed:
        yield (
            f"{name}: completed_interval is {_told(row.completed_interval)}, worked out again "
            f"{_told(completed)}"
        )
    own = events_of(scenario, name, asked.first)
    yield from _fate_findings(row, own, asked, delivered)
    # what is still owed at any time is at least what was still to come
    owed = delivered if row.status in ("broken", "released") or own else asked.need_kwh
    promise = Promise(name, asked.first, asked.deadline, owed, asked.min_kw, asked.max_kw)
    yield from _power_findings(run, promise, power, own)


def _told(interval: int | None) -> str:
    return "blank" if interval is None else str(interval)


def _fate_findings(
    row: VehicleRow, own: list[Event], asked: Asked, delivered: float
) -> Iterator[str]:
    name, need, price = row.vehicle, asked.need_kwh, asked.option.price_per_kwh
    more = sum(event.value or 0.0 for event in own if event.event == "asks_more")
    by_what_it_got = row.status in ("broken", "released") or (more and row.status == "charged")
    due = price * (delivered if by_what_it_got else need)
    due = 0.0 if row.status == "refused" else due
    if abs(row.revenue - due) > MONEY:
        yield f"{name}: revenue is {row.revenue:g} $, worked out again {due:g} $"
    if row.status == "refused" and delivered > ENERGY_KWH:
        yield f"{name}: refused, yet charged {delivered:g} kWh"
    if row.status == "charging":
        yield f"{name}: told to be charging still, yet the day is over"
    cut = any(event.event in CUTS for event in own)
    if row.status == "released" and not cut:
        yield f"{name}: told to have given up a part, yet its driver changed nothing"
    elif row.status not in ("refused", "released") and need - delivered > KEPT_KWH:
        yield f"{name}: promised {need:.3f} kWh, got {delivered:.3f} kWh: a broken promise"
    if row.status == "released" and need - delivered <= KEPT_KWH:
        yield f"{name}: told to have given up a part, yet it got its {need:.3f} kWh"
    if row.status == "broken" and not more and need - delivered <= KEPT_KWH:
        yield f"{name}: told to be broken, yet it got its {need:.3f} kWh"
    if delivered - need - more > KEPT_KWH:
        yield f"{name}: asked for {need + more:.3f} kWh, got {delivered:.3f} kWh"


def _power_findings(
    run: RunRecord, promise: Promise, power: Floats, own: list[Event]
) -> Iterator[str]:
    name, hours = promise.vehicle, run.scenario.interval_minutes / 60
    owed = promise.owed_kwh
    for interval in np.flatnonzero(power):
        drawn = float(power[interval])
        clock = f"{run.scenario.time_of(int(interval)):%H:%M}"
        lowest = min(promise.min_kw, owed / hours)
        if not promise.first <= interval < promise.deadline:
            yield f"{name}: charges at {clock}, outside its promised time"
        if not is_there(own, int(interval)):
            yield f"{name}: charges at {clock}, when it is away"
        if drawn > promise.max_kw + POWER_KW:
            yield f"{name}: {drawn:.3f} kW at {clock}, above its {promise.max_kw:g} kW"
        if drawn < lowest - POWER_KW:
            yield f"{name}: {drawn:.3f} kW at {clock}, below the {lowest:g} kW a charger can hold"
        owed -= drawn * hours
