"""A snapshot as the arrays P1 is written in."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evdash.domain.limits import Floats, LimitRows
from evdash.domain.plan import Snapshot
from evdash.domain.tariff import Tariff
from evdash.domain.vehicles import Request

Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]

OPTIMALITY_USD = 0.01
"""A plan counts as optimal within this of the proven bound: absolute, as P1 passes zero."""


TIE_USD = 0.98 * OPTIMALITY_USD
"""How far above the proven bound a plan may cost in exchange for being earlier, or found sooner."""


@dataclass(frozen=True, slots=True)
class Problem:
    """P1 at one interval. Vehicles: the contracts first, then the requests worth asking about.

    Shapes: owed_kwh, intervals_left, low_kw, high_kw and revenue (vehicles,); tail_kw (vehicles,
    slots). `revenue` in $ is what admitting brings, 0 for contracts. `low_kw` is the lower
    end of (6b), min(min_kw, owed/Δt). `first_slot`, (vehicles,) or one for all, is the first
    in which a vehicle is there: 0 but for who is late.
    """

    vehicles: tuple[str, ...]
    n_contracts: int
    owed_kwh: Floats
    intervals_left: Ints
    low_kw: Floats
    high_kw: Floats
    revenue: Floats
    tariff: Tariff
    chargers: int
    rows: LimitRows
    tail_kw: Floats
    first_slot: Ints | int = 0

    @property
    def n_vehicles(self) -> int:
        return len(self.vehicles)

    @property
    def n_slots(self) -> int:
        return len(self.tariff)

    @property
    def interval_hours(self) -> float:
        """Δt, h."""
        return self.tariff.interval_hours

    @property
    def window(self) -> Bools:
        """(7a): in which slots each vehicle may charge, (vehicles, slots)."""
        slots, first = np.arange(self.n_slots), np.reshape(self.first_slot, (-1, 1))
        return (first <= slots) & (slots < self.intervals_left[:, None])

    def objective(self, admitted: Bools, power_kw: Floats) -> float:
        """The value P1 minimises, $: energy cost less the revenue of new contracts."""
        return self.tariff.cost(power_kw) - float(self.revenue @ admitted)

    @property
    def tail_objective(self) -> float:
        """The value of keeping the last plan's tail and admitting nobody, $."""
        return self.tariff.cost(self.tail_kw)


@dataclass(frozen=True, slots=True)
class Solution:
    """A feasible point of P1 and a proven bound on its optimum, $.

    Shapes: admitted (vehicles,), power_kw (vehicles, slots).
    """

    admitted: Bools
    power_kw: Floats
    bound: float


def problem_of(snapshot: Snapshot) -> Problem:
    """The arrays of P1 for a snapshot.

    The last plan's tail was certified, yet floating point may leave it a hair outside the
    limits computed afresh (3.2999999 kWh owed where min_kw is 3.3). Bounds and limits are
    therefore taken no tighter than the tail, which stays feasible to the last bit.
    """
    contracts, n = snapshot.contracts, len(snapshot.contracts)
    newcomers = candidates(snapshot)
    requests = [contract.request for contract in contracts] + list(newcomers)
    tail = snapshot.tail_kw
    running = tail > 0
    owed = np.array([r.need_kwh for r in requests])
    owed[:n] = tail.sum(axis=1) * snapshot.interval_hours
    low = np.minimum([r.min_kw for r in requests], owed / snapshot.interval_hours)
    high = np.array([r.max_kw for r in requests], dtype=float)
    if tail.size:
        low[:n] = np.minimum(low[:n], np.where(running, tail, np.inf).min(axis=1))
        high[:n] = np.maximum(high[:n], tail.max(axis=1))
    ends = np.array([r.deadline_interval for r in requests], dtype=np.int64)
    return Problem(
        vehicles=tuple(r.vehicle for r in requests),
        n_contracts=n,
        owed_kwh=owed,
        intervals_left=np.maximum(0, ends - snapshot.now),
        low_kw=low,
        high_kw=high,
        revenue=np.array([0.0] * n + [r.revenue for r in newcomers]),
        tariff=snapshot.tariff,
        chargers=snapshot.chargers,
        rows=_rows_no_tighter_than(snapshot.rows, tail.sum(axis=0)),
        tail_kw=np.vstack([tail, np.zeros((len(newcomers), snapshot.n_slots))]),
        first_slot=_first_slots(snapshot, requests),
    )


def contracts_problem(
    snapshot: Snapshot, owed_kwh: Floats | None = None, n_firm: int | None = None
) -> Problem:
    """The arrays of the contracts alone, under the snapshot's limits as they are.

    Unlike `problem_of` nothing is taken from the tail, which these limits may have undone.
    `owed_kwh` (contracts,) is what is to be delivered, if not what is owed by the terms in
    force; the first `n_firm`, if not all, are those whose drivers did not change their terms.
    """
    requests = [contract.request for contract in snapshot.contracts]
    if owed_kwh is None:
        owed_kwh = np.array([contract.owed_kwh for contract in snapshot.contracts])
    ends = np.array([r.deadline_interval for r in requests], dtype=np.int64)
    rows = snapshot.rows
    return Problem(
        vehicles=tuple(r.vehicle for r in requests),
        n_contracts=len(requests) if n_firm is None else n_firm,
        owed_kwh=owed_kwh,
        intervals_left=np.maximum(0, ends - snapshot.now),
        low_kw=np.minimum([r.min_kw for r in requests], owed_kwh / snapshot.interval_hours),
        high_kw=np.array([r.max_kw for r in requests], dtype=float),
        revenue=np.array([r.pays(kwh) for r, kwh in zip(requests, owed_kwh, strict=True)]),
        tariff=snapshot.tariff,
        chargers=snapshot.chargers,
        rows=LimitRows(rows.elements, rows.coefficient, np.maximum(0.0, rows.limit_kw)),
        tail_kw=snapshot.tail_kw,
        first_slot=_first_slots(snapshot, requests),
    )


def _first_slots(snapshot: Snapshot, requests: Sequence[Request]) -> Ints:
    """The slots from which vehicles are there, (vehicles,)."""
    begins = np.array([r.arrival_interval for r in requests], dtype=np.int64)
    return np.maximum(0, begins - snapshot.now)


def candidates(snapshot: Snapshot) -> tuple[Request, ...]:
    """The requests that some schedule could serve."""
    return tuple(request for request in snapshot.requests if not request.refusal)


def _rows_no_tighter_than(rows: LimitRows, station_kw: Floats) -> LimitRows:
    used = np.outer(station_kw, rows.coefficient[:, 0])
    return LimitRows(
        rows.elements, rows.coefficient, np.maximum(np.maximum(0.0, rows.limit_kw), used)
    )
