"""Cleaning a plan: what a solver gives to 1e-7 becomes exact within bounds."""

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.problem import Bools, Problem

RESIDUAL_KW = 1e-9


def cleaned(problem: Problem, admitted: Bools, power_kw: Floats) -> Floats:
    """Power with D rounded, bounds kept to the bit and every energy owed met exactly.

    `power_kw` (vehicles, slots) is expected to be feasible to solver tolerance. What
    clipping leaves over or short is moved within each vehicle's own bounds, in the slots
    where the feeder has most room.
    """
    running = (power_kw > 0.5 * problem.low_kw[:, None]) & (power_kw > RESIDUAL_KW)
    running &= problem.window & admitted[:, None]
    low, high = problem.low_kw[:, None], problem.high_kw[:, None]
    clean = np.where(running, np.clip(power_kw, low, high), 0.0)
    owed_kw = np.where(admitted, problem.owed_kwh, 0.0) / problem.interval_hours
    headroom = problem.rows.headroom_kw()
    for n in np.flatnonzero(np.abs(clean.sum(axis=1) - owed_kw) > 0):
        missing = owed_kw[n] - clean[n].sum()
        room = headroom - clean.sum(axis=0)
        for slot in sorted(np.flatnonzero(running[n]), key=lambda t: -room[t]):
            moved = np.clip(
                missing,
                problem.low_kw[n] - clean[n, slot],
                problem.high_kw[n] - clean[n, slot],
            )
            clean[n, slot] += moved
            missing -= moved
            if missing == 0:
                break
    return clean
