"""HiGHS by arrays: a linear or mixed-integer program in, values and proven bound out.

Its rows are gathered block by block as arrays, in `Rows`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import highspy
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_matrix

from evdash.domain.limits import Floats
from evdash.errors import SolverFailure
from evdash.scheduling.effort import ITERATIONS, Effort, Meter

TOLERANCE = 1e-9
Indices = NDArray[np.intp]
Entries = tuple[Indices, Indices, ArrayLike]
"""Row within the block, column, coefficient; the coefficient may be one number for all."""
Kinds = NDArray[np.uint8]
WHOLE, SEMI_CONTINUOUS = 1, 2
"""Kinds of columns, 0 for any other; a semi-continuous one is 0 or within its bounds."""

MIP_PRESOLVE = "off"
"""HiGHS 1.15's presolve errs on one mixed-integer program in some hundreds (`reference.py`);
here no error was seen without it, and it saves no time."""

OPTIONS: Mapping[str, Any] = {
    "output_flag": False,
    "threads": 1,
    "random_seed": 0,
    "mip_rel_gap": 0.0,  # P1's objective passes through zero
    "mip_detect_symmetry": False,
    "mip_heuristic_run_feasibility_jump": False,  # took half the time and found nothing
    "primal_feasibility_tolerance": TOLERANCE,
    "dual_feasibility_tolerance": TOLERANCE,
    "mip_feasibility_tolerance": TOLERANCE,
}


@dataclass(slots=True)
class Rows:
    """Blocks of rows so far; `add` appends one."""

    count: int = 0
    row: list[Indices] = field(default_factory=list)
    column: list[Indices] = field(default_factory=list)
    value: list[Floats] = field(default_factory=list)
    lower: list[Floats] = field(default_factory=list)
    upper: list[Floats] = field(default_factory=list)

    def add(self, n_rows: int, lower: ArrayLike, upper: ArrayLike, *blocks: Entries) -> None:
        """Append `n_rows` rows: lower ≤ Σ blocks ≤ upper."""
        for row, column, value in blocks:
            self.row.append(row + self.count)
            self.column.append(column)
            self.value.append(_spread(value, len(row)))
        self.lower.append(_spread(lower, n_rows))
        self.upper.append(_spread(upper, n_rows))
        self.count += n_rows

    def limits(self) -> tuple[Floats, Floats]:
        """Lower and upper limit of every row so far."""
        if self.count == 0:
            return np.empty(0), np.empty(0)
        return np.concatenate(self.lower), np.concatenate(self.upper)

    def matrix(self, n_columns: int) -> csr_matrix:
        """All rows so far as one sparse matrix; a column appears once in a row."""
        if self.count == 0:
            return csr_matrix((0, n_columns))
        row, value = np.concatenate(self.row), np.concatenate(self.value)
        order = np.argsort(row, kind="stable")
        starts = np.zeros(self.count + 1, dtype=np.int32)
        np.cumsum(np.bincount(row, minlength=self.count), out=starts[1:])
        columns = np.concatenate(self.column)[order].astype(np.int32)
        return csr_matrix((value[order], columns, starts), shape=(self.count, n_columns))


def _spread(value: ArrayLike, length: int) -> Floats:
    array = np.empty(length)
    array[:] = value
    return array


@dataclass(frozen=True, slots=True)
class LinearProgram:
    """min cost·x  subject to  row_lower ≤ matrix x ≤ row_upper, lower ≤ x ≤ upper."""

    cost: Floats
    matrix: csr_matrix
    row_lower: Floats
    row_upper: Floats
    lower: Floats
    upper: Floats


@dataclass(frozen=True, slots=True)
class LpPoint:
    """The optimum of an LP: values and reduced costs, each (columns,), row duals, objective."""

    values: Floats
    reduced_cost: Floats
    row_dual: Floats
    objective: float


@dataclass(frozen=True, slots=True)
class MilpOutcome:
    """What branch and bound found: values (None if nothing feasible) and a proven lower bound.

    `bound` is inf where infeasibility was proven, −inf where nothing was.
    """

    values: Floats | None
    bound: float


class Session:
    """One program held open in HiGHS, so that what is solved next starts from the last basis."""

    def __init__(self, program: LinearProgram) -> None:
        self.everything = np.arange(len(program.cost), dtype=np.int32)
        self.solver = highspy.Highs()
        self._set(OPTIONS)
        matrix = program.matrix
        status = self.solver.passModel(
            len(program.cost),
            len(program.row_lower),
            matrix.nnz,
            int(highspy.MatrixFormat.kRowwise),
            int(highspy.ObjSense.kMinimize),
            0.0,
            program.cost,
            program.lower,
            program.upper,
            program.row_lower,
            program.row_upper,
            matrix.indptr[:-1],
            matrix.indices,
            matrix.data,
            np.zeros(len(program.cost), dtype=np.int32),
        )
        if status == highspy.HighsStatus.kError:
            raise SolverFailure("HiGHS refused the model")

    def bound(self, columns: NDArray[np.integer], lower: Floats, upper: Floats) -> None:
        """Give `columns` new bounds."""
        self.solver.changeColsBounds(len(columns), columns.astype(np.int32), lower, upper)

    def add_rows(self, matrix: csr_matrix, lower: Floats, upper: Floats) -> None:
        """Append rows; the basis stays a start for what is solved next."""
        self.solver.addRows(
            len(lower),
            lower,
            upper,
            matrix.nnz,
            matrix.indptr[:-1],
            matrix.indices,
            matrix.data,
        )

    def relaxed(self, effort: Effort) -> LpPoint | None:
        """The LP's optimum; None if it is infeasible or the effort was spent on it."""
        self._set({"presolve": "choose"})
        self._run_simplex(effort)
        if self.solver.getModelStatus() != highspy.HighsModelStatus.kOptimal:
            return None
        solution = self.solver.getSolution()
        return LpPoint(
            values=np.array(solution.col_value),
            reduced_cost=np.array(solution.col_dual),
            row_dual=np.array(solution.row_dual),
            objective=self.solver.getInfo().objective_function_value,
        )

    @property
    def infeasible(self) -> bool:
        """Whether what was last solved was proven to have no feasible point."""
        return bool(self.solver.getModelStatus() == highspy.HighsModelStatus.kInfeasible)

    def branched(
        self,
        kinds: Kinds,
        effort: Effort,
        *,
        nodes: int,
        absolute_gap: float = 0.0,
        target: float = -np.inf,
    ) -> MilpOutcome:
        """The MILP with columns of these kinds, by at most `nodes` of branch and bound.

        Ends early at a gap of `absolute_gap` or at a point no dearer than `target`.
        """
        self._set({"mip_max_nodes": nodes, "presolve": MIP_PRESOLVE})
        self._set({"mip_abs_gap": absolute_gap, "objective_target": target})
        count = len(self.everything)
        self.solver.changeColsIntegrality(count, self.everything, kinds)
        if kinds.any():
            self._run_branching(effort)
        else:
            self._run_simplex(effort)
        outcome = self._integer_outcome(bool(kinds.any()))
        self.solver.changeColsIntegrality(count, self.everything, np.zeros_like(kinds))
        return outcome

    def _integer_outcome(self, branching: bool) -> MilpOutcome:
        if self.infeasible:
            return MilpOutcome(None, np.inf)
        info = self.solver.getInfo()
        bound = info.mip_dual_bound  # −inf after a run that met its target
        if not branching:  # an LP, for which HiGHS sets no such bound
            optimal = self.solver.getModelStatus() == highspy.HighsModelStatus.kOptimal
            bound = info.objective_function_value if optimal else -np.inf
        if info.primal_solution_status != highspy.SolutionStatus.kSolutionStatusFeasible:
            return MilpOutcome(None, bound)
        return MilpOutcome(np.array(self.solver.getSolution().col_value), bound)

    def _run_simplex(self, effort: Effort) -> None:
        columns = max(1, len(self.everything))
        most = min(ITERATIONS * effort.work / columns, float(highspy.kHighsIInf))
        self._set({"simplex_iteration_limit": int(most)})
        self.solver.run()
        iterations = self.solver.getInfo().simplex_iteration_count
        effort.spend(columns * max(1.0, iterations / ITERATIONS))

    def _run_branching(self, effort: Effort) -> None:
        meter = Meter(effort, len(self.everything))
        # a limit on iterations would hold for each linear program alone
        self._set({"simplex_iteration_limit": highspy.kHighsIInf})
        self.solver.setCallback(meter, None)
        self.solver.startCallback(highspy.cb.HighsCallbackType.kCallbackMipInterrupt)
        self.solver.run()
        meter.settle()

    def _set(self, options: Mapping[str, Any]) -> None:
        for name, value in options.items():
            self.solver.setOptionValue(name, value)
