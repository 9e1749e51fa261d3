"""The fast solver against the plain formulation: `python -m benchmarks.solver [--quick]`.

For every case the whole day is timed, drawing arrivals and building models included, and every
interval; then plain P1, by HiGHS and by CBC, each with a limit, is given all intervals of some of
the days, and ours those that took plain P1 longest, in the same run. Prints tables, as Markdown,
and the growth with vehicles, intervals and feeder nodes, and says where a case is not what it is
said to be; exit status 3 then.
"""

import argparse
import platform
import resource
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from statistics import median

import highspy
import numpy as np
import pulp
from rich.box import MARKDOWN
from rich.console import Console
from rich.table import Table

from benchmarks import growth, plain
from benchmarks.cases import CASES, Case
from evdash.domain.plan import Plan, Snapshot
from evdash.domain.scenario import Scenario
from evdash.horizon.day import run_day, start_day
from evdash.scheduling.p1 import p1_policy
from evdash.scheduling.problem import OPTIMALITY_USD

PEAK_MB = 600.0


@dataclass(slots=True)
class Measured:
    """What one case took, as s on the clock and s of the processor.

    On a machine that does nothing else the two agree; the solver runs on one thread.
    """

    case: Case
    days: list[tuple[float, float]] = field(default_factory=list)
    intervals: list[tuple[float, float]] = field(default_factory=list)
    gaps: list[float] = field(default_factory=list)
    arrived: int = 0
    refused: int = 0
    both_bind: list[int] = field(default_factory=list)
    peak_mb: float = 0.0

    @property
    def proven(self) -> float:
        """The share of intervals that ended within a cent of their bound."""
        return float(np.mean(np.array(self.gaps) <= OPTIMALITY_USD))

    def broken(self) -> Iterator[str]:
        """What the case is said to be and is not."""
        case, refused = self.case, self.refused / self.arrived
        if min(self.both_bind) < case.both_bind:
            yield (
                f"both limits bind in {min(self.both_bind)} intervals, at least {case.both_bind}"
            )
        low, high = case.refused
        if not low <= refused <= high:
            yield f"{refused:.0%} refused, between {low:.0%} and {high:.0%}"
        if self.proven < case.proven:
            yield f"{self.proven:.2%} of intervals proven, at least {case.proven:.0%}"
        if self.peak_mb > PEAK_MB:
            yield f"{self.peak_mb:.0f} MB at the peak, at most {PEAK_MB:.0f}"


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
    policy = p1_policy()

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


HEADINGS = (
    "case",
    "seeds",
    "day, median",
    "target",
    "day, longest",
    "target",
    "worst interval",
    "target",
    "proven",
    "worst gap $",
    "refused",
    "both bind",
    "peak MB",
)


def measure(cases: Sequence[Case], console: Console) -> list[str]:
    """Print the table of days and intervals; returns what a case is said to be and is not."""
    table = Table(*HEADINGS, title="P1 over whole days, s (clock / processor)", box=MARKDOWN)
    broken: list[str] = []
    for case in cases:
        measured, began = Measured(case), time.perf_counter()
        for seed in range(1, case.seeds + 1):
            timed_day(case.scenario(seed), measured)
        measured.peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        table.add_row(*_row(measured))
        broken += [f"{case.title}: {what}" for what in measured.broken()]
        console.print(f"{case.title}: done in {time.perf_counter() - began:.0f} s", style="dim")
    console.print(table)
    return broken


def _row(measured: Measured) -> tuple[str, ...]:
    case = measured.case
    return (
        case.title,
        str(case.seeds),
        both(measured.days, median),
        _target(case.day_target_seconds),
        both(measured.days, max),
        _target(case.longest_target_seconds),
        both(measured.intervals, max),
        _target(case.worst_target_seconds),
        f"{measured.proven:.2%}",
        f"{max(measured.gaps):.4f}",
        f"{measured.refused / measured.arrived:.0%}",
        f"{min(measured.both_bind)}–{max(measured.both_bind)}",
        f"{measured.peak_mb:.0f}",
    )


def _target(seconds: float | None) -> str:
    return "–" if seconds is None else f"{seconds:g}"


def main() -> int:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a tenth of the seeds")
    names = [case.name for case in CASES]
    parser.add_argument("--case", choices=names, nargs="+", help="only these rows, no growth")
    parser.add_argument("--limit", type=float, default=60.0, help="s for plain P1 on an interval")
    parser.add_argument("--plain-days", type=int, default=1, help="days a case for plain P1")
    parser.add_argument("--growth", action="store_true", help="only the growth")
    parser.add_argument("--svg", type=Path, help="where to draw the growth")
    chosen = parser.parse_args()
    cases = [case for case in CASES if chosen.case is None or case.name in chosen.case]
    if chosen.quick:
        cases = [replace(case, seeds=max(1, case.seeds // 10)) for case in cases]
    console, broken, began = Console(width=240), [], time.perf_counter()
    console.print(
        f"{platform.machine()}, Python {platform.python_version()}, "
        f"HiGHS {highspy.Highs().version()}, PuLP {pulp.__version__}, NumPy {np.__version__}"
    )
    if not chosen.growth:
        broken = measure(cases, console)
        if chosen.plain_days:
            console.print(plain.table(cases, chosen.plain_days, chosen.limit))
    if chosen.growth or chosen.case is None:
        points = growth.measured(seeds=1 if chosen.quick else 3)
        console.print(growth.table(points))
        if chosen.svg:
            growth.save_svg(points, chosen.svg)
    console.print(f"{time.perf_counter() - began:.0f} s in all")
    for what in broken:
        console.print(what)
    return 3 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
