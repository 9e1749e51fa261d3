"""P1 for a whole day with everyone known who will come: windows open when vehicles arrive.

The fast path's program with other windows. Its deadline rows go, as they count on every window
being open now; its stages and cuts stay what they are.
"""

from dataclasses import replace

import numpy as np

from evdash.domain.limits import Floats
from evdash.domain.plan import Snapshot
from evdash.domain.vehicles import Request
from evdash.scheduling.fast.relaxation import (
    Relaxation,
    charges_of,
    columns_of,
    limited_slots,
    program_of,
    rows_of,
)
from evdash.scheduling.highs import LpPoint
from evdash.scheduling.problem import problem_of


def known_day(snapshot: Snapshot, coming: tuple[Request, ...]) -> Relaxation:
    """P1's relaxation with those who are still to come beside those who ask now."""
    problem = problem_of(replace(snapshot, requests=(*snapshot.requests, *coming)))
    charges, headroom_kw = charges_of(problem), problem.rows.headroom_kw()
    open_windows = problem.window & charges.servable[:, None]
    crowded = np.asarray(open_windows.sum(axis=0) > problem.chargers)
    at = columns_of(problem, crowded)
    rows, own = rows_of(problem, charges, at, headroom_kw, crowded)
    program, shared = program_of(problem, charges, at, rows), slice(own, rows.count)
    return Relaxation(problem, charges, headroom_kw, crowded, at, program, shared)


def capacity_price(day: Relaxation, point: LpPoint) -> tuple[Floats, Floats]:
    """What one kWh of headroom, $/kWh, and one charger, $, is worth in each slot, (slots,)."""
    headroom, charger = np.zeros((2, day.problem.n_slots))
    limited = limited_slots(day.columns, day.charges, day.headroom_kw)
    for_feeder, for_chargers = np.split(point.row_dual[day.shared], [len(limited)])
    headroom[limited] = -for_feeder / day.problem.interval_hours
    charger[day.charger_slots] = -for_chargers
    return headroom, charger
