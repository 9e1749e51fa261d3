"""Who is switched off where there is no time to ask which is best: those who came last, first.

The last resort where recourse finds nothing in time. It needs no solver and cannot fail.
"""

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.problem import Problem

ROUNDING_KW = 1e-9


def shed(problem: Problem) -> Floats:
    """The tail cut down to the chargers and the headroom there are, (vehicles, slots) in kW.

    In every slot the vehicles that came last go first; the last one to go keeps what room is
    left if a charger can hold it. What was lost is caught up with later, whose return is
    nearest first, where there is room and a charger.
    """
    power = np.where(problem.window, problem.tail_kw, 0.0)
    headroom = problem.rows.headroom_kw()
    for slot in range(problem.n_slots):
        _switch_off(problem, power[:, slot], float(headroom[slot]))
    for n in np.argsort(problem.intervals_left, kind="stable"):
        _catch_up(problem, power, int(n), headroom)
    return power


def _switch_off(problem: Problem, power_kw: Floats, room_kw: float) -> None:
    """Cut one slot, (vehicles,), in place."""
    for n in reversed(np.flatnonzero(power_kw > 0)):
        crowded = int((power_kw > 0).sum()) > problem.chargers
        beyond = float(power_kw.sum()) - room_kw
        if not crowded and beyond <= 0:
            return
        left = float(power_kw[n]) - beyond - ROUNDING_KW
        power_kw[n] = left if not crowded and left >= problem.low_kw[n] else 0.0


def _catch_up(problem: Problem, power: Floats, n: int, headroom_kw: Floats) -> None:
    """Add to a vehicle's row, in place, what is missing of its energy."""
    low, high = float(problem.low_kw[n]), float(problem.high_kw[n])
    missing = float(problem.owed_kwh[n]) / problem.interval_hours - float(power[n].sum())
    for slot in np.flatnonzero(problem.window[n]):
        running = power[:, slot] > 0
        if not running[n] and int(running.sum()) >= problem.chargers:
            continue
        room = float(headroom_kw[slot] - power[:, slot].sum()) - ROUNDING_KW
        more = min(missing, room, high - float(power[n, slot]))
        if more > ROUNDING_KW and power[n, slot] + more >= low:
            power[n, slot] += more
            missing -= more
