"""P1's relaxation as one array program: what every stage of the fast solver works on.

First what a charge comes to in whole slots, `Charges`, the numbers all rows and cuts are made of:
powers are mean kW over a slot, so that energy owed is a sum of powers, in kW·slots. Then which
variables there are, `Columns`, in this order: P of every vehicle and slot of its window; D, only
where chargers can bind; u. Elsewhere D need not be written: P is 0 or between low and p, which
HiGHS branches on as a semi-continuous column. Then the rows, and last those the LP implies, for
branch and bound to find covers in: what must be done by when.
"""

from dataclasses import dataclass

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.highs import Indices, LinearProgram, Rows
from evdash.scheduling.problem import Bools, Ints, Problem

WHOLE = 1e-9
"""Keeps 5.000000000000001 slots at 5."""


@dataclass(frozen=True, slots=True)
class Charges:
    """Each vehicle's charge; all arrays (vehicles,).

    `owed_kw` s: energy owed, kW·slots. `top_kw` p: the most it can take in a slot,
    min(high, s). `fewest` m = ⌈s/p⌉: the fewest slots. `rest_kw` r = s − (m − 1)·p: what the
    last of the fewest slots holds. `least_kw` max(r, low): with j < m slots elsewhere, the
    slots left hold at least this for each of the m − j missing. `slots` L: where the
    window ends, and its length but for who is late. `servable`: whether any number of slots
    within the window can hold the charge.
    """

    owed_kw: Floats
    low_kw: Floats
    top_kw: Floats
    fewest: Ints
    rest_kw: Floats
    least_kw: Floats
    slots: Ints
    servable: Bools


def charges_of(problem: Problem) -> Charges:
    """The charge of every vehicle of a problem."""
    s, low = problem.owed_kwh / problem.interval_hours, problem.low_kw
    p = np.minimum(problem.high_kw, s)
    slots = np.minimum(problem.intervals_left, problem.n_slots)
    there = slots - problem.first_slot
    per_slot = np.where(p > 0, p, 1.0)
    m = np.maximum(1, np.ceil(s / per_slot - WHOLE)).astype(np.int64)
    r = np.clip(s - (m - 1) * p, 0.0, p)
    return Charges(
        owed_kw=s,
        low_kw=low,
        top_kw=p,
        fewest=m,
        rest_kw=r,
        least_kw=np.maximum(r, low),
        slots=slots,
        servable=(m <= there) & (m * low <= s + WHOLE) & (s <= m * p + WHOLE),
    )


@dataclass(frozen=True, slots=True)
class Columns:
    """Where each variable stands. A pair is a vehicle and a slot of its window.

    `vehicle`, `slot` (pairs,): of P's columns 0, 1, …; `d` (pairs,): column of D, or −1 where
    there is none; `u` (vehicles,).
    """

    vehicle: Indices
    slot: Indices
    d: Indices
    u: Indices

    @property
    def n_pairs(self) -> int:
        return len(self.vehicle)

    @property
    def total(self) -> int:
        return self.n_pairs + int((self.d >= 0).sum()) + len(self.u)


def columns_of(problem: Problem, charger_slots: Bools) -> Columns:
    """Which variables there are."""
    vehicle, slot = np.nonzero(problem.window)
    with_d = charger_slots[slot]
    d = np.where(with_d, len(vehicle) + np.cumsum(with_d) - 1, -1)
    u = len(vehicle) + int(with_d.sum()) + np.arange(problem.n_vehicles)
    return Columns(vehicle, slot, d, u)


@dataclass(frozen=True, slots=True)
class Relaxation:
    """The program, its columns and what they were made from.

    `shared` are the rows that bind vehicles to one another; every other is one vehicle's own.
    """

    problem: Problem
    charges: Charges
    headroom_kw: Floats
    charger_slots: Bools
    columns: Columns
    program: LinearProgram
    shared: slice

    def power_kw(self, values: Floats) -> Floats:
        """P of a point, (vehicles, slots), kW."""
        power = np.zeros((self.problem.n_vehicles, self.problem.n_slots))
        power[self.columns.vehicle, self.columns.slot] = values[: self.columns.n_pairs]
        return power


def made_from(problem: Problem) -> Relaxation:
    """The relaxation of a problem, chargers only where they can bind."""
    charges, headroom_kw = charges_of(problem), problem.rows.headroom_kw()
    slots = contested_slots(problem, charges, headroom_kw)
    return relaxation_of(problem, charges, headroom_kw, slots)


def contested_slots(problem: Problem, charges: Charges, headroom_kw: Floats) -> Bools:
    """Slots in which more vehicles could run than chargers exist, shape (slots,).

    A slot has as many open windows as there are vehicles with L_n > t, less who is late. And
    however many are open: one more than chargers, each at its lowest power, must fit under the
    headroom.
    """
    open_windows = problem.window & charges.servable[:, None]
    crowd = problem.chargers + 1
    if len(charges.slots) < crowd:
        return np.zeros(problem.n_slots, dtype=bool)
    lowest = np.sort(np.where(open_windows, charges.low_kw[:, None], np.inf), axis=0)[:crowd]
    return np.asarray(lowest.sum(axis=0) <= headroom_kw * (1 + 1e-9) + 1e-9)


def relaxation_of(
    problem: Problem, charges: Charges, headroom_kw: Floats, charger_slots: Bools
) -> Relaxation:
    """P1 with D continuous, and gone where chargers cannot bind."""
    at = columns_of(problem, charger_slots)
    rows, own = rows_of(problem, charges, at, headroom_kw, charger_slots)
    energy_by_deadlines(rows, at, charges, problem, headroom_kw)
    slots_by_deadlines(rows, at, charges, problem, charger_slots)
    program, shared = program_of(problem, charges, at, rows), slice(own, rows.count)
    return Relaxation(problem, charges, headroom_kw, charger_slots, at, program, shared)


def rows_of(
    problem: Problem, charges: Charges, at: Columns, headroom_kw: Floats, charger_slots: Bools
) -> tuple[Rows, int]:
    """The rows of (1)–(9), and how many of them, at the front, are one vehicle's own."""
    rows = Rows()
    energy_owed(rows, at, charges)
    charger_on(rows, at, charges, problem)
    power_only_under_contract(rows, at, charges, problem)
    own = rows.count
    feeder_limit(rows, at, charges, headroom_kw)
    charger_count(rows, at, problem, charger_slots)
    return rows, own


def program_of(problem: Problem, charges: Charges, at: Columns, rows: Rows) -> LinearProgram:
    """The rows with the objective of (P1), (5a) and the powers of (6b) as bounds."""
    cost, lower, upper = np.zeros(at.total), np.zeros(at.total), np.ones(at.total)
    cost[: at.n_pairs] = problem.tariff.cost_per_kw[at.slot]
    cost[at.u] = -problem.revenue
    upper[: at.n_pairs] = charges.top_kw[at.vehicle]
    contract = np.arange(problem.n_vehicles) < problem.n_contracts
    lower[at.u] = contract
    upper[at.u] = contract | charges.servable
    return LinearProgram(cost, rows.matrix(at.total), *rows.limits(), lower, upper)


def energy_owed(rows: Rows, at: Columns, charges: Charges) -> None:
    """(7b) Σ_t P = s·u."""
    n = np.arange(len(at.u))
    pairs = np.arange(at.n_pairs)
    rows.add(len(n), 0.0, 0.0, (at.vehicle, pairs, 1.0), (n, at.u, -charges.owed_kw))


def charger_on(rows: Rows, at: Columns, charges: Charges, problem: Problem) -> None:
    """(6a), (6b) low·D ≤ P ≤ p·D, D ≤ u; contracts have the last as a bound."""
    pairs = np.flatnonzero(at.d >= 0)
    n, d, row = at.vehicle[pairs], at.d[pairs], np.arange(len(pairs))
    rows.add(len(row), -np.inf, 0.0, (row, pairs, 1.0), (row, d, -charges.top_kw[n]))
    rows.add(len(row), 0.0, np.inf, (row, pairs, 1.0), (row, d, -charges.low_kw[n]))
    new = n >= problem.n_contracts
    n, d, row = n[new], d[new], row[: new.sum()]
    rows.add(len(row), -np.inf, 0.0, (row, d, 1.0), (row, at.u[n], -1.0))


def power_only_under_contract(rows: Rows, at: Columns, charges: Charges, problem: Problem) -> None:
    """(6a) where there is no D: P ≤ p·u for newcomers; contracts have it as a bound."""
    pairs = np.flatnonzero((at.d < 0) & (at.vehicle >= problem.n_contracts))
    n, row = at.vehicle[pairs], np.arange(len(pairs))
    rows.add(len(row), -np.inf, 0.0, (row, pairs, 1.0), (row, at.u[n], -charges.top_kw[n]))


def feeder_limit(rows: Rows, at: Columns, charges: Charges, headroom_kw: Floats) -> None:
    """(1)–(4), (8) Σ_n P ≤ headroom, in the limited slots."""
    tight = limited_slots(at, charges, headroom_kw)
    place = np.full(len(headroom_kw), -1)
    place[tight] = np.arange(len(tight))
    pairs = np.flatnonzero(place[at.slot] >= 0)
    rows.add(len(tight), -np.inf, headroom_kw[tight], (place[at.slot[pairs]], pairs, 1.0))


def limited_slots(at: Columns, charges: Charges, headroom_kw: Floats) -> Indices:
    """Slots where all together could exceed the headroom, in order."""
    most = np.bincount(at.slot, charges.top_kw[at.vehicle], minlength=len(headroom_kw))
    return np.flatnonzero(most > headroom_kw)


def charger_count(rows: Rows, at: Columns, problem: Problem, charger_slots: Bools) -> None:
    """(9) Σ_n D ≤ N̄, where chargers can bind."""
    place = np.cumsum(charger_slots) - 1
    pairs = np.flatnonzero(at.d >= 0)
    n_rows = int(charger_slots.sum())
    rows.add(n_rows, -np.inf, problem.chargers, (place[at.slot[pairs]], at.d[pairs], 1.0))


def energy_by_deadlines(
    rows: Rows, at: Columns, charges: Charges, problem: Problem, headroom_kw: Floats
) -> None:
    """Σ_n max(0, s − p·(L − τ)⁺)·u ≤ headroom summed before τ, for each deadline τ.

    What cannot be charged after τ must be charged before, the more so by who is late.
    Implied by the LP, but whole u's make covers of it, and those are found in one row.
    """
    deadlines = np.unique(charges.slots[charges.slots > 0])
    after = np.maximum(0, charges.slots - deadlines[:, None])
    share = np.maximum(0.0, charges.owed_kw - charges.top_kw * after)
    limit = np.cumsum(headroom_kw)[deadlines - 1]
    _knapsacks(rows, at, problem.n_contracts, share * _possible(charges, problem), limit)


def slots_by_deadlines(
    rows: Rows, at: Columns, charges: Charges, problem: Problem, charger_slots: Bools
) -> None:
    """Σ_n max(0, m − (L − τ)⁺)·u ≤ chargers·τ, for each deadline τ up to where chargers bind."""
    reach = int(np.max(np.flatnonzero(charger_slots), initial=-1)) + 1
    deadlines = np.unique(charges.slots[(charges.slots > 0) & (charges.slots <= reach)])
    after = np.maximum(0, charges.slots - deadlines[:, None])
    share = np.maximum(0.0, charges.fewest - after)
    limit = problem.chargers * deadlines.astype(np.float64)
    _knapsacks(rows, at, problem.n_contracts, share * _possible(charges, problem), limit)


def _possible(charges: Charges, problem: Problem) -> Bools:
    return charges.servable | (np.arange(problem.n_vehicles) < problem.n_contracts)


def _knapsacks(rows: Rows, at: Columns, n_contracts: int, share: Floats, limit: Floats) -> None:
    """Rows Σ share·u ≤ limit that newcomers could exceed; share (rows, vehicles)."""
    can_bind = (share.sum(axis=1) > limit) & (share[:, n_contracts:].sum(axis=1) > 0)
    share, limit = share[can_bind], limit[can_bind]
    row, n = np.nonzero(share)
    rows.add(len(limit), -np.inf, limit, (row, at.u[n], share[row, n]))
