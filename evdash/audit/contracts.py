"""The audit of contracts: every promise worked out again from the scenario's own arrivals."""

import math
from collections.abc import Iterator

import numpy as np

from evdash.audit.events import CUTS, events_of, is_there
from evdash.audit.record import RunRecord
from evdash.checker.contracts import Promise
from evdash.domain.events import Event
from evdash.domain.limits import Floats
from evdash.domain.scenario import Arrival, RecordedArrivals
from evdash.files.run_tables import VehicleRow

ENERGY_KWH = 1e-6
KEPT_KWH = 0.01
POWER_KW = 1e-6
MONEY = 1e-6


def contract_findings(run: RunRecord) -> Iterator[str]:
    """What is wrong with who was served, how much, when and for how much money."""
    known = run.scenario.arrivals
    arrivals = known.vehicles if isinstance(known, RecordedArrivals) else ()
    rows = {row.vehicle: row for row in run.vehicles}
    if len(rows) != len(run.vehicles):
        yield "vehicles.csv names a vehicle twice"
    for name in sorted(set(rows) ^ {arrival.vehicle for arrival in arrivals}):
        yield f"{name} is in only one of arrivals.csv and vehicles.csv"
    for name in sorted(set(run.power_kw) - set(rows)):
        yield f"{name} is charged in power.csv and missing in vehicles.csv"
    for arrival in arrivals:
        if arrival.vehicle in rows:
            yield from _vehicle_findings(run, arrival, rows[arrival.vehicle])


def _vehicle_findings(run: RunRecord, arrival: Arrival, row: VehicleRow) -> Iterator[str]:
    scenario, name = run.scenario, arrival.vehicle
    option = next(option for option in scenario.option if option.name == arrival.option)
    need = (arrival.soc_out - arrival.soc_in) * arrival.battery_kwh / scenario.station.efficiency
    max_kw = min(scenario.station.max_kw, arrival.max_kw or math.inf)
    minutes = (arrival.arrival - scenario.start).total_seconds() / 60
    first = math.ceil(minutes / scenario.interval_minutes)
    hours = scenario.interval_minutes / 60
    stay = math.ceil(need / (min(option.average_kw, max_kw) * hours) - 1e-9)
    deadline = min(first + stay, scenario.intervals)
    power = run.power_kw.get(name, np.zeros(scenario.intervals))
    delivered = math.fsum(power.tolist()) * hours
    for told, value, right in (
        ("need_kwh", row.need_kwh, need),
        ("arrival_interval", row.arrival_interval, first),
        ("deadline_interval", row.deadline_interval, deadline),
        ("delivered_kwh", row.delivered_kwh, delivered),
    ):
        if abs(value - right) > ENERGY_KWH:
            yield f"{name}: {told} is {value:g}, worked out again {right:g}"
    if row.option != arrival.option:
        yield f"{name}: option is {row.option}, arrivals.csv says {arrival.option}"
    own = events_of(scenario, name, row.arrival_interval)
    yield from _fate_findings(row, own, need, delivered, option.price_per_kwh)
    # what is still owed at any time is at least what was still to come
    owed = delivered if row.status in ("broken", "released") or own else need
    promise = Promise(name, first, deadline, owed, scenario.station.min_kw, max_kw)
    yield from _power_findings(run, promise, power, own)


def _fate_findings(
    row: VehicleRow, own: list[Event], need: float, delivered: float, price: float
) -> Iterator[str]:
    name = row.vehicle
    asked = sum(event.value or 0.0 for event in own if event.event == "asks_more")
    by_what_it_got = row.status in ("broken", "released") or (asked and row.status == "charged")
    due = price * (delivered if by_what_it_got else need)
    due = 0.0 if row.status == "refused" else due
    if abs(row.revenue - due) > MONEY:
        yield f"{name}: revenue is {row.revenue:g} $, worked out again {due:g} $"
    if row.status == "refused" and delivered > ENERGY_KWH:
        yield f"{name}: refused, yet charged {delivered:g} kWh"
    cut = any(event.event in CUTS for event in own)
    if row.status == "released" and not cut:
        yield f"{name}: told to have given up a part, yet its driver changed nothing"
    elif row.status not in ("refused", "released") and need - delivered > KEPT_KWH:
        yield f"{name}: promised {need:.3f} kWh, got {delivered:.3f} kWh: a broken promise"
    if row.status == "broken" and not asked and need - delivered <= KEPT_KWH:
        yield f"{name}: told to be broken, yet it got its {need:.3f} kWh"
    if delivered - need - asked > KEPT_KWH:
        yield f"{name}: asked for {need + asked:.3f} kWh, got {delivered:.3f} kWh"


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
