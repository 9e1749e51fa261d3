"""P1's relaxation as one array program: what every stage of the fast solver works on.

Letters are those of the paper and of `charges.Charges`.
"""

from dataclasses import dataclass

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.fast.charges import Charges
from evdash.scheduling.fast.columns import Columns, columns_of
from evdash.scheduling.fast.deadlines import energy_by_deadlines, slots_by_deadlines
from evdash.scheduling.highs import LinearProgram
from evdash.scheduling.problem import Bools, Problem
from evdash.scheduling.rows import Indices, Rows


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


def relaxation_of(
    problem: Problem, charges: Charges, headroom_kw: Floats, charger_slots: Bools
) -> Relaxation:
    """P1 with D continuous, and gone where chargers cannot bind."""
    at = columns_of(problem, charger_slots)
    rows = Rows()
    energy_owed(rows, at, charges)
    charger_on(rows, at, charges, problem)
    power_only_under_contract(rows, at, charges, problem)
    own = rows.count
    feeder_limit(rows, at, charges, headroom_kw)
    charger_count(rows, at, problem, charger_slots)
    energy_by_deadlines(rows, at, charges, problem, headroom_kw)
    slots_by_deadlines(rows, at, charges, problem, charger_slots)
    program, shared = program_of(problem, charges, at, rows), slice(own, rows.count)
    return Relaxation(problem, charges, headroom_kw, charger_slots, at, program, shared)


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
