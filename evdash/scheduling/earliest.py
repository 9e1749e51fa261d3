"""Among plans of equal worth, the earliest: room later is room for who comes next."""

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.effort import Effort
from evdash.scheduling.highs import LinearProgram, Rows, Session
from evdash.scheduling.problem import Bools, Problem


def earliest_first(
    problem: Problem, charging: Bools, power_kw: Floats, cost_limit: float, effort: Effort
) -> Floats:
    """Decision 6: with u and D fixed, minimise Σ (t − now)·P·Δt at a cost of at most the limit.

    `power_kw` (vehicles, slots) is the plan to start from, returned unchanged if nothing
    earlier is found; `cost_limit` bounds the energy cost, $.
    """
    vehicle, slot = np.nonzero(charging)
    if not len(vehicle):
        return power_kw
    hours, headroom = problem.interval_hours, problem.rows.headroom_kw()
    pairs, rows = np.arange(len(vehicle)), Rows()
    energy = power_kw.sum(axis=1) * hours
    rows.add(problem.n_vehicles, energy, energy, (vehicle, pairs, hours))
    # with one port the tightest row of a slot implies its others
    rows.add(problem.n_slots, -np.inf, headroom, (slot, pairs, 1.0))
    rows.add(1, -np.inf, cost_limit, (0 * pairs, pairs, problem.tariff.cost_per_kw[slot]))
    row_lower, row_upper = rows.limits()
    program = LinearProgram(
        cost=(slot * hours).astype(np.float64),
        matrix=rows.matrix(len(pairs)),
        row_lower=row_lower,
        row_upper=row_upper,
        lower=problem.low_kw[vehicle],
        upper=problem.high_kw[vehicle],
    )
    point = Session(program).relaxed(effort)
    if point is None:
        return power_kw
    earlier = np.zeros_like(power_kw)
    earlier[vehicle, slot] = point.values
    return earlier
