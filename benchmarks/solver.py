"""The fast solver against the plain formulation: `python -m benchmarks.solver [--quick]`.

For every case the whole day is timed, drawing arrivals and building models included, and every
interval; then the hardest intervals are given to plain P1 by HiGHS and by CBC, each with a limit,
in the same run. Prints a table and the growth with vehicles, intervals and feeder nodes.
"""

import argparse
import heapq
import platform
import resource
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import count
from pathlib import Path
from statistics import median

import highspy
import numpy as np
import pulp
from rich.console import Console
from rich.table import Table

from benchmarks import growth
from benchmarks.cases import CASES, Case
from evdash.domain.plan import Plan, Snapshot
from evdash.domain.scenario import Scenario
from evdash.horizon.day import run_day, start_day
from evdash.scheduling.equations import P1, build
from evdash.scheduling.fast.solver import solve_fast
from evdash.scheduling.p1 import SECONDS_PER_INTERVAL, p1_policy
from evdash.scheduling.problem import OPTIMALITY_USD, Problem, Solution

CANDIDATES, HARD = 6, 3
"""Plain P1 is given our slowest intervals and those with most requests, so many of each; the
ones it takes longest for are compared."""


@dataclass(slots=True)
class Measured:
    """What one case took, as s on the clock and s of the processor, and its slowest intervals.

    On a machine that does nothing else the two agree; the solver runs on one thread.
    """

    case: Case
    days: list[tuple[float, float]] = field(default_factory=list)
    intervals: list[tuple[float, float]] = field(default_factory=list)
    gaps: list[float] = field(default_factory=list)
    arrived: int = 0
    refused: int = 0
    both_bind: list[int] = field(default_factory=list)
    slowest: list[tuple[float, int, Problem]] = field(default_factory=list)
    busiest: list[tuple[int, int, Problem]] = field(default_factory=list)
    counter: Iterator[int] = field(default_factory=count)

    def note(self, took: float, problem: Problem) -> None:
        """Remember the problem if it is among the slowest or the busiest."""
        number, requests = next(self.counter), problem.n_vehicles - problem.n_contracts
        heapq.heappush(self.slowest, (took, number, problem))
        heapq.heappush(self.busiest, (requests, number, problem))
        for heap in (self.slowest, self.busiest):
            if len(heap) > CANDIDATES:
                heapq.heappop(heap)

    def candidates(self) -> list[Problem]:
        """The slowest and the busiest intervals, each once."""
        noted = {number: problem for _, number, problem in (*self.slowest, *self.busiest)}
        return [noted[number] for number in sorted(noted)]


def now() -> tuple[float, float]:
    """The clock and the processor's time, s."""
    return time.perf_counter(), time.process_time()


def since(began: tuple[float, float]) -> tuple[float, float]:
    """What has passed since `began`, s."""
    clock, processor = now()
    return clock - began[0], processor - began[1]


def both(times: Sequence[tuple[float, float]], summary: Callable[[Sequence[float]], float]) -> str:
    """Clock and processor time, summed up: `0.120 / 0.118`."""
    clock, processor = zip(*times, strict=True)
    return f"{summary(clock):.3f} / {summary(processor):.3f}"


def timed_day(scenario: Scenario, measured: Measured) -> None:
    """Run a day, drawing arrivals and building models included, and note what it took."""

    def solve(problem: Problem, seconds: float) -> Solution:
        began = time.process_time()
        solution = solve_fast(problem, seconds)
        measured.note(time.process_time() - began, problem)
        return solution

    policy = p1_policy(solve)

    def timed_policy(snapshot: Snapshot) -> Plan:
        began = now()
        plan = policy(snapshot)
        measured.intervals.append(since(began))
        return plan

    began = now()
    trace = run_day(start_day(scenario), timed_policy)
    measured.days.append(since(began))
    binding = 0
    headroom = trace.inputs.rows.headroom_kw()
    for step in trace.steps:
        report, plan = step.plan.report, step.plan
        bound = -np.inf if report.bound is None else report.bound
        measured.gaps.append(0.0 if report.objective is None else report.objective - bound)
        measured.arrived += len(step.requests)
        measured.refused += len(plan.refused)
        full = plan.charging[0] >= scenario.station.chargers
        binding += bool(full and plan.station_kw[0] > headroom[step.interval] - 1.0)
    measured.both_bind.append(binding)


def plain(problem: Problem, solver: pulp.LpSolver) -> float:
    """Seconds plain P1 takes with this solver, model building included."""
    began = time.perf_counter()
    build(problem, P1).lp.solve(solver)
    return time.perf_counter() - began


def plain_solvers(seconds: float) -> tuple[pulp.LpSolver, pulp.LpSolver]:
    """HiGHS and CBC as they come, to half a cent, on one thread, within `seconds`."""
    return (
        pulp.HiGHS(msg=False, timeLimit=seconds, gapRel=0, gapAbs=0.004, threads=1),
        pulp.PULP_CBC_CMD(msg=False, timeLimit=seconds, gapRel=0, gapAbs=0.004, threads=1),
    )


def measure(cases: Sequence[Case], limit_seconds: float, console: Console) -> Table:
    """The table: days and intervals of each case, and plain P1 on its slowest intervals."""
    title = (
        "P1 over whole days, s (clock / processor); at the right, plain P1 on its worst intervals"
    )
    table = Table(title=title)
    for heading in (
        "case",
        "days",
        "day median",
        "day max",
        "target",
        "worst interval",
        "target",
        "proven",
        "worst gap $",
        "refused",
        "both bind",
        "ours",
        "HiGHS",
        "CBC",
        "peak MB",
    ):
        table.add_column(heading, justify="left" if heading == "case" else "right")
    for case in cases:
        measured = Measured(case)
        for seed in range(1, case.seeds + 1):
            timed_day(case.scenario(seed), measured)
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        highs, cbc = plain_solvers(limit_seconds)
        timed = [(plain(problem, highs), problem) for problem in measured.candidates()]
        worst = sorted(timed, key=lambda one: -one[0])[:HARD]
        ours = sum(_seconds(problem) for _, problem in worst)
        by_plain = (
            sum(took for took, _ in worst),
            sum(plain(problem, cbc) for _, problem in worst),
        )
        proven = np.mean(np.array(measured.gaps) <= OPTIMALITY_USD)
        table.add_row(
            case.title,
            str(case.seeds),
            both(measured.days, median),
            both(measured.days, max),
            _target(case.day_target_seconds),
            both(measured.intervals, max),
            _target(case.worst_target_seconds),
            f"{proven:.2%}",
            f"{max(measured.gaps):.4f}",
            f"{measured.refused / measured.arrived:.0%}",
            f"{min(measured.both_bind)}–{max(measured.both_bind)}",
            f"{ours:.2f}",
            *(f"{seconds:.1f} ({seconds / ours:.0f}×)" for seconds in by_plain),
            f"{memory:.0f}",
        )
        console.print(f"{case.title}: done", style="dim")
    return table


def _target(seconds: float | None) -> str:
    return "–" if seconds is None else f"{seconds:g}"


def _seconds(problem: Problem) -> float:
    began = time.perf_counter()
    solve_fast(problem, SECONDS_PER_INTERVAL)
    return time.perf_counter() - began


def main() -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a tenth of the seeds")
    parser.add_argument("--case", choices=[case.name for case in CASES], help="only this case")
    parser.add_argument("--limit", type=float, default=60.0, help="s for plain P1 on an interval")
    parser.add_argument("--growth", action="store_true", help="only the growth")
    parser.add_argument("--svg", type=Path, help="where to draw the growth")
    chosen = parser.parse_args()
    cases = [case for case in CASES if chosen.case in (None, case.name)]
    if chosen.quick:
        cases = [replace(case, seeds=max(1, case.seeds // 10)) for case in cases]
    console = Console(width=200)
    console.print(
        f"{platform.machine()}, Python {platform.python_version()}, "
        f"HiGHS {highspy.Highs().version()}, PuLP {pulp.__version__}, NumPy {np.__version__}"
    )
    if not chosen.growth:
        console.print(measure(cases, chosen.limit, console))
    if chosen.growth or chosen.case is None:
        points = growth.measured(seeds=1 if chosen.quick else 3)
        console.print(growth.table(points))
        if chosen.svg:
            growth.save_svg(points, chosen.svg)


if __name__ == "__main__":
    main()
