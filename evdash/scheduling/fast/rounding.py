"""Cuts for one vehicle by mixed-integer rounding, found where a point violates them.

A vehicle that owes s and takes at most p in a slot runs in at least m = ⌈s/p⌉ slots. For any
set S of its slots,

    Σ_{t∈S} P/g + Σ_{t∉S} D ≥ m·u,   g = max(r, low),   r = s − (m − 1)·p.

If j of the slots outside S run, S holds at least s − j·p = (m − 1 − j)·p + r, which is at least
(m − j)·r since p ≥ r; and where low ≥ r, every running slot of S holds at least low. Where D is
not written, u stands for it (D ≤ u). The set that a point violates most is S = {t: P/g < D}.
These few rows take almost all of the difficulty out of D's integrality.
"""

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.effort import Effort
from evdash.scheduling.fast.relaxation import Relaxation
from evdash.scheduling.highs import LpPoint, Rows, Session

VIOLATION_SLOTS = 1e-3
"""How far Σ must lie below m·u for a cut to be worth a row."""


def relaxed_and_cut(
    relaxation: Relaxation, session: Session, effort: Effort, rounds: int
) -> LpPoint | None:
    """The LP's optimum as the session stands, its point cut off so often at most; None if none."""
    point = session.relaxed(effort)
    for _ in range(rounds):
        if point is None:
            break
        cuts = violated_cuts(relaxation, point.values)
        if cuts.count == 0:
            break
        session.add_rows(cuts.matrix(relaxation.columns.total), *cuts.limits())
        point = session.relaxed(effort)
    return point


def violated_cuts(relaxation: Relaxation, values: Floats) -> Rows:
    """The most violated cut of every vehicle that has one at the point `values` (columns,)."""
    at, charges = relaxation.columns, relaxation.charges
    n, n_vehicles = at.vehicle, len(at.u)
    g, m, u = np.maximum(charges.least_kw, 1e-12), charges.fewest, values[at.u]
    has_d = at.d >= 0
    on = np.where(has_d, values[at.d], u[n])
    full = values[: at.n_pairs] / g[n]
    reached = np.bincount(n, np.minimum(full, on), minlength=n_vehicles)
    cut = (m > 1) & (charges.rest_kw < charges.top_kw) & (reached < m * u - VIOLATION_SLOTS)
    rows = Rows()
    if not cut.any():
        return rows
    row = np.cumsum(cut) - 1
    in_set = cut[n] & (full < on)
    by_d, by_u = cut[n] & ~in_set & has_d, cut[n] & ~in_set & ~has_d
    slots_by_u = np.bincount(n[by_u], minlength=n_vehicles)
    rows.add(
        int(cut.sum()),
        0.0,
        np.inf,
        (row[n[in_set]], np.flatnonzero(in_set), 1 / g[n[in_set]]),
        (row[n[by_d]], at.d[by_d], 1.0),
        (row[cut], at.u[cut], (slots_by_u - m)[cut]),
    )
    return rows
