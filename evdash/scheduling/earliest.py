"""Among plans of equal worth, the earliest: room later is room for who comes next."""

import numpy as np
from scipy.sparse import coo_matrix

from evdash.domain.limits import Floats
from evdash.scheduling.highs import LinearProgram, Session
from evdash.scheduling.problem import Bools, Problem


def earliest_first(
    problem: Problem, charging: Bools, power_kw: Floats, cost_limit: float, seconds: float
) -> Floats:
    """Decision 6: with u and D fixed, minimise Σ (t − now)·P·Δt at a cost of at most the limit.

    `power_kw` (vehicles, slots) is the plan to start from, returned unchanged if nothing
    earlier is found; `cost_limit` bounds the energy cost, $.
    """
    vehicle, slot = np.nonzero(charging)
    if not len(vehicle):
        return power_kw
    hours, rows = problem.interval_hours, problem.rows
    columns = np.arange(len(vehicle))
    entries = [(vehicle, np.full(len(vehicle), hours))]
    lower, upper = [power_kw.sum(axis=1) * hours], [power_kw.sum(axis=1) * hours]
    for row in range(len(rows.elements)):
        offset = problem.n_vehicles + row * problem.n_slots
        entries.append((offset + slot, np.full(len(vehicle), rows.coefficient[row, 0])))
        lower.append(np.full(problem.n_slots, -np.inf))
        upper.append(rows.limit_kw[:, row])
    cost_row = problem.n_vehicles + len(rows.elements) * problem.n_slots
    entries.append((np.full(len(vehicle), cost_row), problem.price_per_kwh[slot] * hours))
    matrix = coo_matrix(
        (
            np.concatenate([values for _, values in entries]),
            (np.concatenate([index for index, _ in entries]), np.tile(columns, len(entries))),
        ),
        shape=(cost_row + 1, len(vehicle)),
    ).tocsr()
    program = LinearProgram(
        cost=(slot * hours).astype(np.float64),
        matrix=matrix,
        row_lower=np.concatenate([*lower, [-np.inf]]),
        row_upper=np.concatenate([*upper, [cost_limit]]),
        lower=problem.low_kw[vehicle],
        upper=problem.high_kw[vehicle],
    )
    point = Session(program).relaxed(seconds)
    if point is None:
        return power_kw
    earlier = np.zeros_like(power_kw)
    earlier[vehicle, slot] = point.values
    return earlier
