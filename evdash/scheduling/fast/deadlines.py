"""Rows the LP implies, for branch and bound to find covers in: what must be done by when."""

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.fast.charges import Charges
from evdash.scheduling.fast.columns import Columns
from evdash.scheduling.problem import Bools, Problem
from evdash.scheduling.rows import Rows


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
