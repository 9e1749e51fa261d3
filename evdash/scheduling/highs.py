"""HiGHS by arrays: a linear or mixed-integer program in, values and proven bound out."""

from dataclasses import dataclass
from typing import Any

import highspy
import numpy as np
from scipy.sparse import csr_matrix

from evdash.domain.limits import Floats
from evdash.errors import SolverFailure
from evdash.scheduling.problem import Bools

FEASIBILITY_TOLERANCE = 1e-9


@dataclass(frozen=True, slots=True)
class LinearProgram:
    """min cost·x  subject to  row_lower ≤ matrix x ≤ row_upper, lower ≤ x ≤ upper.

    `integer` marks the columns that must be whole; None for a pure LP.
    """

    cost: Floats
    matrix: csr_matrix
    row_lower: Floats
    row_upper: Floats
    lower: Floats
    upper: Floats
    integer: Bools | None = None


@dataclass(frozen=True, slots=True)
class Outcome:
    """What HiGHS found: values (None if nothing feasible), objective, proven lower bound."""

    values: Floats | None
    objective: float
    bound: float
    finished: bool


def minimise(
    program: LinearProgram,
    *,
    seconds: float,
    absolute_gap: float = 0.0,
    nodes: int | None = None,
    start: Floats | None = None,
) -> Outcome:
    """Solve within `seconds`, or `nodes` of branch and bound; infeasible gives no values.

    Relative gaps are off throughout: P1's objective passes through zero.
    """
    solver = highspy.Highs()
    options: dict[str, Any] = {
        "output_flag": False,
        "threads": 1,
        "random_seed": 0,
        "time_limit": max(0.01, seconds),
        "mip_rel_gap": 0.0,
        "mip_abs_gap": absolute_gap,
        "primal_feasibility_tolerance": FEASIBILITY_TOLERANCE,
        "mip_feasibility_tolerance": FEASIBILITY_TOLERANCE,
    }
    if nodes is not None:
        options["mip_max_nodes"] = nodes
    for name, value in options.items():
        solver.setOptionValue(name, value)
    if solver.passModel(_highs_model(program)) == highspy.HighsStatus.kError:
        raise SolverFailure("HiGHS refused the model")
    if start is not None:
        guess = highspy.HighsSolution()
        guess.col_value = start
        solver.setSolution(guess)
    solver.run()
    return _outcome(solver, is_mip=program.integer is not None)


def _highs_model(program: LinearProgram) -> Any:
    model = highspy.HighsLp()
    rows, columns = program.matrix.shape
    model.num_row_, model.num_col_ = rows, columns
    model.col_cost_ = program.cost
    model.col_lower_, model.col_upper_ = program.lower, program.upper
    model.row_lower_, model.row_upper_ = program.row_lower, program.row_upper
    model.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    model.a_matrix_.start_ = program.matrix.indptr
    model.a_matrix_.index_ = program.matrix.indices
    model.a_matrix_.value_ = program.matrix.data
    if program.integer is not None:
        kinds = (highspy.HighsVarType.kContinuous, highspy.HighsVarType.kInteger)
        model.integrality_ = [kinds[int(whole)] for whole in program.integer]
    return model


def _outcome(solver: Any, is_mip: bool) -> Outcome:
    status, info = solver.getModelStatus(), solver.getInfo()
    finished = status == highspy.HighsModelStatus.kOptimal
    feasible = info.primal_solution_status == highspy.SolutionStatus.kSolutionStatusFeasible
    if not feasible:
        return Outcome(None, np.inf, info.mip_dual_bound if is_mip else -np.inf, finished)
    objective = info.objective_function_value
    lp_bound = objective if finished else -np.inf
    return Outcome(
        values=np.array(solver.getSolution().col_value),
        objective=objective,
        bound=info.mip_dual_bound if is_mip else lp_bound,
        finished=finished,
    )
