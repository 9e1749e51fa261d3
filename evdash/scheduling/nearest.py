"""The schedule of given contracts whose first slot is nearest to one wished for."""

import numpy as np
from scipy.sparse import csr_matrix, vstack

from evdash.domain.limits import Floats
from evdash.domain.tariff import Tariff
from evdash.scheduling.effort import Effort
from evdash.scheduling.fast.relaxation import Relaxation, made_from
from evdash.scheduling.highs import (
    SEMI_CONTINUOUS,
    WHOLE,
    Indices,
    Kinds,
    LinearProgram,
    Rows,
    Session,
)
from evdash.scheduling.problem import Problem

NODES = 200
GAP_USD = 0.02


def nearest_schedule(
    problem: Problem, first_kw: Floats, tariff: Tariff, effort: Effort
) -> Floats | None:
    """Power (vehicles, slots), kW, of everyone in the problem; None if none was found.

    A kWh of the first slot's that differs from `first_kw` (vehicles,) costs more than it could
    save by `tariff` in any other; among those nearest the cheapest.
    """
    relaxation = made_from(problem)
    if not problem.n_vehicles:
        return np.zeros((0, problem.n_slots))
    first = np.flatnonzero(relaxation.columns.slot == 0)
    program = _with_deviations(relaxation, first, first_kw, tariff)
    kinds = _kinds(relaxation, program)
    outcome = Session(program).branched(kinds, effort, nodes=NODES, absolute_gap=GAP_USD)
    return None if outcome.values is None else relaxation.power_kw(outcome.values)


def _with_deviations(
    relaxation: Relaxation, first: Indices, first_kw: Floats, tariff: Tariff
) -> LinearProgram:
    """Two columns behind the others for each pair in the first slot: below and above the wish."""
    program, at, hours = relaxation.program, relaxation.columns, relaxation.problem.interval_hours
    pairs, below, wished = len(first), at.total + np.arange(len(first)), first_kw[at.vehicle[first]]
    total, row = at.total + 2 * pairs, np.arange(pairs)
    rows = Rows()
    rows.add(
        pairs, wished, wished, (row, first, 1.0), (row, below, 1.0), (row, below + pairs, -1.0)
    )
    known = program.matrix
    widened = csr_matrix((known.data, known.indices, known.indptr), (known.shape[0], total))
    matrix = csr_matrix(vstack([widened, rows.matrix(total)]))
    matrix.indices, matrix.indptr = matrix.indices.astype(np.int32), matrix.indptr.astype(np.int32)
    dearer = 1.0 + tariff.most_saved_per_kwh
    cost = np.concatenate([np.zeros(at.total), np.full(2 * pairs, dearer * hours)])
    cost[: at.n_pairs] = tariff.cost_per_kw[at.slot]
    lower = np.concatenate([program.lower, np.zeros(2 * pairs)])
    lower[at.u] = 1.0
    return LinearProgram(
        cost=cost,
        matrix=matrix,
        row_lower=np.concatenate([program.row_lower, wished]),
        row_upper=np.concatenate([program.row_upper, wished]),
        lower=lower,
        upper=np.concatenate([program.upper, np.full(2 * pairs, np.inf)]),
    )


def _kinds(relaxation: Relaxation, program: LinearProgram) -> Kinds:
    """D whole; where there is none, P 0 or at least its lowest, which becomes its lower bound."""
    at = relaxation.columns
    low = relaxation.charges.low_kw[at.vehicle]
    kinds: Kinds = np.zeros(len(program.cost), dtype=np.uint8)
    semi = np.flatnonzero((at.d < 0) & (low > 0))
    kinds[semi] = SEMI_CONTINUOUS
    program.lower[semi] = low[semi]
    kinds[at.d[at.d >= 0]] = WHOLE
    return kinds
