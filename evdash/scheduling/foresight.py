"""P1 for a whole day with everyone known who will come: windows open when vehicles arrive.

The fast path's program with other windows. Its deadline rows go, as they count on every window
being open now; its stages and cuts stay what they are.
"""

from dataclasses import dataclass, replace

import numpy as np

from evdash.domain.limits import Floats
from evdash.domain.plan import Snapshot
from evdash.domain.vehicles import Request
from evdash.scheduling.fast.charges import Charges, charges_of
from evdash.scheduling.fast.columns import Columns
from evdash.scheduling.fast.relaxation import (
    Relaxation,
    charger_count,
    charger_on,
    energy_owed,
    feeder_limit,
    limited_slots,
    power_only_under_contract,
    program_of,
)
from evdash.scheduling.highs import LpPoint
from evdash.scheduling.problem import Bools, Ints, Problem, problem_of
from evdash.scheduling.rows import Indices, Rows


def known_problem(snapshot: Snapshot, coming: tuple[Request, ...]) -> tuple[Problem, Ints]:
    """P1 with those who are still to come beside those who ask now.

    Also the slot in which each vehicle's window opens, (vehicles,), 0 for who is here.
    """
    problem = problem_of(replace(snapshot, requests=(*snapshot.requests, *coming)))
    arrival = {request.vehicle: request.arrival_interval for request in coming}
    opens = [max(0, arrival.get(name, 0) - snapshot.now) for name in problem.vehicles]
    return problem, np.array(opens, dtype=np.int64)


@dataclass(frozen=True, slots=True)
class KnownDay:
    """The linear program of P1 with everyone known, and which of its rows are scarce capacity.

    `feeder_rows` (limited slots,) belong to the slots `limited`, `charger_rows` to those where
    chargers can bind.
    """

    relaxation: Relaxation
    limited: Indices
    feeder_rows: Indices
    charger_rows: Indices

    def capacity_price(self, point: LpPoint) -> tuple[Floats, Floats]:
        """What one kWh of headroom, $/kWh, and one charger, $, is worth in each slot, (slots,)."""
        relaxation = self.relaxation
        n_slots, hours = relaxation.problem.n_slots, relaxation.problem.interval_hours
        headroom, charger = np.zeros(n_slots), np.zeros(n_slots)
        headroom[self.limited] = -point.row_dual[self.feeder_rows] / hours
        charger[relaxation.charger_slots] = -point.row_dual[self.charger_rows]
        return headroom, charger


def known_day(problem: Problem, opens: Ints) -> KnownDay:
    """The linear program of a problem whose windows open at `opens` (vehicles,)."""
    headroom_kw = problem.rows.headroom_kw()
    charges = _within_windows(problem, opens)
    window = problem.window & (np.arange(problem.n_slots) >= opens[:, None])
    slots = _crowded(problem, charges, window)
    at = _columns(window, slots)
    rows = Rows()
    energy_owed(rows, at, charges)
    charger_on(rows, at, charges, problem)
    power_only_under_contract(rows, at, charges, problem)
    above = rows.count
    feeder_limit(rows, at, charges, headroom_kw)
    between = rows.count
    charger_count(rows, at, problem, slots)
    program = program_of(problem, charges, at, rows)
    return KnownDay(
        Relaxation(problem, charges, headroom_kw, slots, at, program, slice(above, rows.count)),
        limited_slots(at, charges, headroom_kw),
        np.arange(above, between),
        np.arange(between, rows.count),
    )


def _within_windows(problem: Problem, opens: Ints) -> Charges:
    charges = charges_of(problem)
    slots = np.maximum(0, charges.slots - opens)
    return replace(charges, slots=slots, servable=charges.servable & (charges.fewest <= slots))


def _crowded(problem: Problem, charges: Charges, window: Bools) -> Bools:
    """Slots with more windows open than chargers, (slots,)."""
    count = (window & charges.servable[:, None]).sum(axis=0)
    return np.asarray(count > problem.chargers)


def _columns(window: Bools, charger_slots: Bools) -> Columns:
    vehicle, slot = np.nonzero(window)
    with_d = charger_slots[slot]
    d = np.where(with_d, len(vehicle) + np.cumsum(with_d) - 1, -1)
    u = len(vehicle) + int(with_d.sum()) + np.arange(len(window))
    return Columns(vehicle, slot, d, u)
