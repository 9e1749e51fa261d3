"""What was known at the start of each interval, put together again from a run's files.

Who held a contract, what was still owed by when, who asked, what the feeder and energy prices
were expected to be. The last plan is in no file; nothing here needs it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from evdash.audit.asked import Asked
from evdash.audit.events import as_known_at, events_of
from evdash.audit.record import RunRecord, kind_of
from evdash.domain.limits import Floats
from evdash.domain.scenario import Scenario
from evdash.files.run_tables import LedgerRow, VehicleRow

ENERGY_KWH = 1e-6


@dataclass(frozen=True, slots=True)
class Owed:
    """What is still to come to a vehicle: kWh, grid side, in intervals [first, deadline)."""

    vehicle: str
    owed_kwh: float
    first: int
    deadline: int
    min_kw: float
    max_kw: float
    revenue: float = 0.0
    """What admitting it brings, $; nothing once it has its contract."""


@dataclass(frozen=True, slots=True)
class Moment:
    """The start of an interval: contracts open, newcomers past the door, the inputs known then.

    `untold` are contracts of which the files do not say what was owed: events before and after
    changed them. `admitted` are names of newcomers. `is_last_word`: nothing happens later.
    """

    interval: int
    known: Scenario
    contracts: tuple[Owed, ...]
    newcomers: tuple[Owed, ...]
    admitted: frozenset[str]
    untold: tuple[str, ...]
    is_last_word: bool


def moments(run: RunRecord) -> tuple[Moment, ...]:
    """Every interval's, in order."""
    n_intervals = run.given.intervals
    happens = sorted({event.interval for event in run.given.events})
    known = {k: as_known_at(run.given, k) for k in (0, *happens)}
    contracts: list[list[Owed]] = [[] for _ in range(n_intervals)]
    untold: list[list[str]] = [[] for _ in range(n_intervals)]
    for entry in run.ledger:
        if entry.vehicle in run.asked:
            for k, owed in _owed(run, entry, happens):
                if owed is None:
                    untold[k].append(entry.vehicle)
                else:
                    contracts[k].append(owed)
    newcomers: list[list[VehicleRow]] = [[] for _ in range(n_intervals)]
    for row in run.vehicles:
        asked = run.asked.get(row.vehicle)
        if asked is not None and not asked.door and kind_of(row.reason) != "promises short":
            newcomers[asked.first].append(row)
    return tuple(
        Moment(
            interval=k,
            known=known[max(t for t in known if t <= k)],
            contracts=tuple(contracts[k]),
            newcomers=tuple(_newcomer(run.asked[row.vehicle]) for row in newcomers[k]),
            admitted=frozenset(row.vehicle for row in newcomers[k] if row.status != "refused"),
            untold=tuple(untold[k]),
            is_last_word=not any(t > k for t in happens),
        )
        for k in range(n_intervals)
    )


def _newcomer(asked: Asked) -> Owed:
    return Owed(
        vehicle=asked.arrival.vehicle,
        owed_kwh=asked.need_kwh,
        first=asked.first,
        deadline=asked.deadline,
        min_kw=asked.min_kw,
        max_kw=asked.max_kw,
        revenue=asked.revenue,
    )


def _owed(
    run: RunRecord, entry: LedgerRow, happens: Sequence[int]
) -> Iterator[tuple[int, Owed | None]]:
    """A contract in each interval at whose start it is open; None where the files do not tell.

    Before anything happened to it, it is owed what it was made for; once nothing more happens,
    what it was still to get is what it got.
    """
    asked, name = run.asked[entry.vehicle], entry.vehicle
    power_kw = run.power_kw.get(name, np.zeros(run.given.intervals))
    had = np.concatenate([[0.0], np.cumsum(power_kw)]) * run.given.interval_minutes / 60
    bearing = [t for t in happens if asked.first < t < asked.deadline] if entry.cause else []
    made = replace(_newcomer(asked), revenue=0.0)
    back = [
        event.from_interval
        for event in events_of(run.given, name, asked.first)
        if event.event == "late" and event.from_interval is not None
    ]
    last = replace(made, first=max([asked.first, *back]), deadline=entry.revised_by_interval)
    for k in range(asked.first + 1, asked.deadline):
        before, after = any(t <= k for t in bearing), any(t > k for t in bearing)
        if before and after:
            yield k, None
            continue
        terms, total = (last, float(had[-1])) if before else (made, asked.need_kwh)
        to_come = total - float(had[k])
        if to_come > ENERGY_KWH and terms.deadline > k:
            yield k, replace(terms, owed_kwh=to_come)


def least_cost(owed: Owed, price_per_kwh: Floats, now: int, hours: float) -> float:
    """The least its energy can cost from `now` on, $, were it alone and the feeder unlimited.

    `price_per_kwh` (intervals,). The cheapest intervals at its highest power; a lower bound.
    """
    left, cost = owed.owed_kwh, 0.0
    for price in sorted(price_per_kwh[max(now, owed.first) : owed.deadline].tolist()):
        taken = min(left, owed.max_kw * hours)
        cost, left = cost + taken * price, left - taken
    return cost
