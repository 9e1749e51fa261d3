"""Which variables the fast formulation has, and where they stand.

In this order: P of every vehicle and slot of its window; D, only where chargers can bind; u.
Elsewhere D need not be written: P is 0 or between low and p, which HiGHS branches on as a
semi-continuous column.
"""

from dataclasses import dataclass

import numpy as np

from evdash.scheduling.problem import Bools, Problem
from evdash.scheduling.rows import Indices


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
