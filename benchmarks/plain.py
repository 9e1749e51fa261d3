"""Plain P1 on single intervals, by HiGHS and by CBC as they come, beside the fast solver.

Twice: with the feeder node by node, all flows and voltages variables, as the paper writes it; and
on the reduced rows, where only the charging is the paper's.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import pulp
from rich.table import Table

from evdash.domain.scenario import Scenario
from evdash.scheduling.equations import P1, Equation, build
from evdash.scheduling.fast.solver import solve_fast
from evdash.scheduling.p1 import SECONDS_PER_INTERVAL
from evdash.scheduling.problem import Problem
from tests.grid.node_by_node import p1_node_by_node

HARD = 3
"""So many intervals are compared, those the paper's formulation takes longest for."""


@dataclass(frozen=True, slots=True)
class Interval:
    """A problem and where it comes from."""

    scenario: Scenario
    now: int
    problem: Problem

    @property
    def as_in_paper(self) -> Sequence[Equation]:
        """P1 with the feeder node by node."""
        return tuple(p1_node_by_node(self.scenario, self.now))


@dataclass(frozen=True, slots=True)
class Plain:
    """Seconds for the same intervals; those of a solver stopped at its limit count as the limit."""

    ours: float
    paper_highs: float
    paper_cbc: float
    reduced_highs: float
    reduced_cbc: float
    stopped: int

    @staticmethod
    def table(limit_seconds: float) -> Table:
        """The headings of `cells`."""
        return Table(
            "case",
            "ours",
            "as in the paper: HiGHS",
            "CBC",
            "on reduced rows: HiGHS",
            "CBC",
            "stopped",
            title=f"plain P1 on its {HARD} worst intervals, all together, s on the clock; "
            f"at most {limit_seconds:g} s each",
        )

    def cells(self) -> tuple[str, ...]:
        """Seconds, and how many times ours."""
        others = (self.paper_highs, self.paper_cbc, self.reduced_highs, self.reduced_cbc)
        return (
            f"{self.ours:.2f}",
            *(f"{seconds:.1f} ({seconds / self.ours:.0f}×)" for seconds in others),
            f"{self.stopped} of {4 * HARD}",
        )


def compared(candidates: Sequence[Interval], limit_seconds: float) -> Plain:
    """The candidates the paper's formulation takes longest for, by every formulation."""
    highs, cbc = plain_solvers(limit_seconds)
    timed = [(plain(one, one.as_in_paper, highs), one) for one in candidates]
    worst = sorted(timed, key=lambda one: -one[0])[:HARD]
    intervals = [interval for _, interval in worst]
    taken = [
        [took for took, _ in worst],
        [plain(one, one.as_in_paper, cbc) for one in intervals],
        [plain(one, P1, highs) for one in intervals],
        [plain(one, P1, cbc) for one in intervals],
    ]
    stopped = sum(took >= limit_seconds for times in taken for took in times)
    return Plain(sum(ours(one.problem) for one in intervals), *map(sum, taken), stopped)


def plain(interval: Interval, equations: Sequence[Equation], solver: pulp.LpSolver) -> float:
    """Seconds plain P1 takes with this solver, model building included."""
    began = time.perf_counter()
    build(interval.problem, equations).lp.solve(solver)
    return time.perf_counter() - began


def ours(problem: Problem) -> float:
    """Seconds the fast solver takes."""
    began = time.perf_counter()
    solve_fast(problem, SECONDS_PER_INTERVAL)
    return time.perf_counter() - began


def plain_solvers(seconds: float) -> tuple[pulp.LpSolver, pulp.LpSolver]:
    """HiGHS and CBC as they come, to half a cent, on one thread, within `seconds`."""
    return (
        pulp.HiGHS(msg=False, timeLimit=seconds, gapRel=0, gapAbs=0.004, threads=1),
        pulp.PULP_CBC_CMD(msg=False, timeLimit=seconds, gapRel=0, gapAbs=0.004, threads=1),
    )
