"""Plain P1, by HiGHS and by CBC as they come, on its own worst intervals, and ours on the same.

Plain: as the paper writes it, the feeder node by node, its injections, flows and voltages all
variables. Every interval of a day is given to it; those it takes longest for are its worst.
"""

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import pulp
from rich.box import MARKDOWN
from rich.table import Table

from benchmarks.cases import Case
from evdash.domain.plan import Plan, Snapshot
from evdash.domain.scenario import Scenario
from evdash.horizon.day import run_day, start_day
from evdash.scheduling.effort import Effort
from evdash.scheduling.equations import build
from evdash.scheduling.fast.solver import solve_fast
from evdash.scheduling.p1 import WORK, p1_policy
from evdash.scheduling.problem import Problem, problem_of
from tests.grid.node_by_node import p1_node_by_node

HARD = 3
"""So many intervals are compared, those that plain P1 takes longest for."""


@dataclass(frozen=True, slots=True)
class Interval:
    """A problem and where it comes from."""

    scenario: Scenario
    now: int
    problem: Problem


@dataclass(frozen=True, slots=True)
class Beside:
    """Seconds of the processor for plain P1's worst intervals, plain and ours, (intervals,).

    What plain P1 would still have taken where it was `stopped` is not counted.
    """

    plain: Sequence[float]
    ours: Sequence[float]
    stopped: int

    def cells(self) -> tuple[str, ...]:
        """Seconds, how many times ours, and how often plain P1 was stopped."""
        plain, ours = sum(self.plain), sum(self.ours)
        return f"{plain:.1f}", f"{ours:.2f}", f"{plain / ours:.0f}×", f"{self.stopped}"


def table(cases: Sequence[Case], days: int, limit_seconds: float) -> Table:
    """One row a case: plain P1's worst intervals of the first `days` days, by either solver."""
    shown = Table(
        "case",
        "intervals",
        *("HiGHS", "ours", "times", "stopped"),
        *("CBC", "ours", "times", "stopped"),
        title=f"plain P1 on its {HARD} worst intervals and ours on the same, all together, "
        f"s of the processor, at most {limit_seconds:g} s each on the clock",
        box=MARKDOWN,
    )
    for case in cases:
        intervals = [
            interval
            for seed in range(1, min(days, case.seeds) + 1)
            for interval in intervals_of(case.scenario(seed))
        ]
        cells = [
            cell
            for solver in plain_solvers(limit_seconds)
            for cell in on_its_worst(intervals, solver, limit_seconds).cells()
        ]
        shown.add_row(case.title, str(len(intervals)), *cells)
    return shown


def intervals_of(scenario: Scenario) -> list[Interval]:
    """The intervals of a day that have anybody to decide on or to plan for."""
    policy, found = p1_policy(), []

    def noting(snapshot: Snapshot) -> Plan:
        problem = problem_of(snapshot)
        if problem.n_vehicles:
            found.append(Interval(scenario, snapshot.now, problem))
        return policy(snapshot)

    run_day(start_day(scenario), noting)
    return found


def on_its_worst(
    intervals: Sequence[Interval], solver: pulp.LpSolver, limit_seconds: float
) -> Beside:
    """Plain P1 on every interval by this solver, and ours where that took longest."""
    taken = [both_times(lambda one=one: solve_plain(one, solver)) for one in intervals]
    worst = sorted(range(len(intervals)), key=lambda i: -taken[i][1])[:HARD]
    ours = [
        both_times(lambda i=i: solve_fast(intervals[i].problem, Effort(WORK)))[1] for i in worst
    ]
    stopped = sum(taken[i][0] >= limit_seconds for i in worst)
    return Beside([taken[i][1] for i in worst], ours, stopped)


def solve_plain(interval: Interval, solver: pulp.LpSolver) -> None:
    """Plain P1, model building included."""
    equations = tuple(p1_node_by_node(interval.scenario, interval.now))
    build(interval.problem, equations).lp.solve(solver)


def both_times(work: Callable[[], object]) -> tuple[float, float]:
    """What some work takes on the clock and of the processor, that of CBC's process with it, s."""
    clock, processor = time.perf_counter(), sum(os.times()[:4])
    work()
    return time.perf_counter() - clock, sum(os.times()[:4]) - processor


def plain_solvers(limit_seconds: float) -> tuple[pulp.LpSolver, pulp.LpSolver]:
    """HiGHS and CBC as they come, to half a cent, on one thread, within their limit."""
    limits = {"msg": False, "timeLimit": limit_seconds, "gapRel": 0, "gapAbs": 0.004, "threads": 1}
    return pulp.HiGHS(**limits), pulp.PULP_CBC_CMD(**limits)
