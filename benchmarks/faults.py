"""Makes the solver fail at random intervals of random days, in every way, and looks on.

python -m benchmarks.faults [--days 200] [--first-seed 1] [--workers 2]

Exit status 0 if no step was lost, no promise or limit broken, and the interval after each fault
was decided as if nothing had been; else 3.
"""

import argparse
import os
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.random_days import random_scenario
from benchmarks.soundness import contract_problems, problems_of_step
from evdash.domain.plan import Plan, Policy, Snapshot
from evdash.domain.trace import Trace
from evdash.errors import SolverFailure
from evdash.horizon.day import run_day, start_day
from evdash.scheduling import guarded
from evdash.scheduling.effort import Effort
from evdash.scheduling.fast.solver import solve_fast
from evdash.scheduling.p1 import Solver, p1_policy
from evdash.scheduling.problem import Problem, Solution

SHARE = 0.25
"""How many intervals the solver fails in."""
HANG_SECONDS, IDLE_SECONDS, LOOK_SECONDS = 3.0, 0.2, 0.05


def out_of_work(problem: Problem, effort: Effort) -> Solution:
    """No point was found within the limit of work."""
    raise SolverFailure("HiGHS found no plan: Not Solved")


def crashed(problem: Problem, effort: Effort) -> Solution:
    """The library raises an error of its own."""
    raise RuntimeError("HiGHS stopped working")


def out_of_memory(problem: Problem, effort: Effort) -> Solution:
    """There is no memory left."""
    raise MemoryError("HiGHS")


def hanging(problem: Problem, effort: Effort) -> Solution:
    """It does not come back, whatever its limit."""
    threading.Event().wait(HANG_SECONDS)
    return solve_fast(problem, effort)


def called_infeasible(problem: Problem, effort: Effort) -> Solution:
    """A problem that has a solution is called infeasible."""
    raise SolverFailure("HiGHS found no plan: Infeasible")


def optimal_beyond_the_truth(problem: Problem, effort: Effort) -> Solution:
    """Nothing decided, and yet a bound that would prove it, and more."""
    admitted = np.arange(problem.n_vehicles) < problem.n_contracts
    return Solution(admitted, problem.tail_kw, problem.tail_objective + 100.0)


def spoilt(change: Callable[[Problem, np.ndarray], np.ndarray]) -> Solver:
    """The right answer with its powers changed."""

    def solve(problem: Problem, effort: Effort) -> Solution:
        right = solve_fast(problem, effort)
        return replace(right, power_kw=change(problem, right.power_kw.copy()))

    return solve


def _nan(_: Problem, power: np.ndarray) -> np.ndarray:
    power[0, 0] = np.nan
    return power


def _everyone_at_once(problem: Problem, power: np.ndarray) -> np.ndarray:
    return np.where(problem.window, problem.high_kw[:, None], power)


FAULTS: Mapping[str, Solver] = {
    "out of work": out_of_work,
    "crash": crashed,
    "out of memory": out_of_memory,
    "never back": hanging,
    "called infeasible": called_infeasible,
    "a bound that is not true": optimal_beyond_the_truth,
    "not a number": spoilt(_nan),
    "infinite": spoilt(lambda _, power: np.where(power > 0, np.inf, power)),
    "1e-6 off": spoilt(lambda _, power: power * (1 + 1e-6)),
    "1e-3 off": spoilt(lambda _, power: power * (1 - 1e-3)),
    "far over the limits": spoilt(lambda _, power: power * 3),
    "everyone at once": spoilt(_everyone_at_once),
    "nothing charged": spoilt(lambda _, power: power * 0),
    "another shape": spoilt(lambda _, power: power[:, :-1]),
}


@dataclass(slots=True)
class Faulty:
    """A policy whose solver fails at random; `injected` remembers where and how."""

    rng: np.random.Generator
    kinds: list[str]
    injected: dict[int, str]
    seconds: dict[int, float]

    def __call__(self, snapshot: Snapshot) -> Plan:
        kind = str(self.rng.choice(self.kinds)) if self.rng.random() < SHARE else ""
        if kind and (snapshot.contracts or snapshot.requests):
            self.injected[snapshot.now] = kind
            policy: Policy = p1_policy(FAULTS[kind])
        else:
            policy = p1_policy()
        began = time.perf_counter()
        try:
            return policy(snapshot)
        finally:
            self.seconds[snapshot.now] = time.perf_counter() - began


@dataclass(frozen=True, slots=True)
class Result:
    """One day: what was injected and how it was answered, and everything that went wrong."""

    seed: int
    answers: Counter[tuple[str, str]]
    problems: tuple[str, ...]
    worst_seconds: float
    recovered: int


def run_one(seed: int) -> Result:
    """Run the random day of a seed with a solver that fails now and then."""
    guarded.IDLE_SECONDS, guarded.LOOK_SECONDS = IDLE_SECONDS, LOOK_SECONDS
    faulty = Faulty(np.random.default_rng(seed), list(FAULTS), {}, {})
    trace = run_day(start_day(random_scenario(seed)), faulty)
    answers: Counter[tuple[str, str]] = Counter()
    problems = list(contract_problems(trace)) + list(_untold(trace))
    recovered = 0
    for step in trace.steps:
        kind, status = faulty.injected.get(step.interval, ""), step.plan.report.status
        if kind:
            answers[kind, status] += 1
        elif faulty.injected.get(step.interval - 1) and status == "optimal":
            recovered += 1
        told = [text for text in problems_of_step(step) if "fallback" not in text]
        problems += told + ([f"interval {step.interval}: {status}"] if _lost(kind, status) else [])
    worst = max((faulty.seconds[k] for k in faulty.injected), default=0.0)
    return Result(seed, answers, tuple(problems), worst, recovered)


def _lost(kind: str, status: str) -> bool:
    """Whether a step without a fault was answered as if there had been one."""
    return not kind and status == "fallback"


def _untold(trace: Trace) -> Iterator[str]:
    """Steps answered by the last plan's tail that do not say so, or why."""
    for step in trace.steps:
        report = step.plan.report
        if report.status == "fallback" and not report.note:
            yield f"interval {step.interval}: fallback without a reason"


def rows_of(results: list[Result], wall_seconds: float) -> list[tuple[str, str]]:
    """The results in words and numbers."""
    answers = sum((r.answers for r in results), Counter[tuple[str, str]]())
    rows = [("days", f"{len(results)}"), ("faults", f"{sum(answers.values()):,}")]
    for kind in FAULTS:
        mine = {status: n for (name, status), n in answers.items() if name == kind}
        rows.append((f"  {kind}", ", ".join(f"{s} {n}" for s, n in sorted(mine.items())) or "none"))
    return [
        *rows,
        ("longest step with a fault", f"{max(r.worst_seconds for r in results):.2f} s"),
        ("proven optimal right after a fault", f"{sum(r.recovered for r in results):,}"),
        ("days with any problem", f"{sum(bool(r.problems) for r in results)}"),
        ("wall time", f"{wall_seconds:.0f} s"),
    ]


def main(arguments: list[str] | None = None) -> int:
    """Run, print the table, name every problem with its seed."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults", description=__doc__)
    parser.add_argument("--days", type=int, default=200, help="how many days (200)")
    parser.add_argument("--first-seed", type=int, default=1, help="seed of the first day (1)")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes")
    chosen = parser.parse_args(arguments)
    began = time.perf_counter()
    with ProcessPoolExecutor(chosen.workers) as pool:
        results = list(pool.map(run_one, range(chosen.first_seed, chosen.first_seed + chosen.days)))
    table = Table("", "", title="Days with a failing solver", show_header=False)
    for label, value in rows_of(results, time.perf_counter() - began):
        table.add_row(label, value)
    console = Console(width=110)
    console.print(table)
    for result in results:
        for problem in result.problems:
            console.print(f"seed {result.seed}: {problem}")
    return 3 if any(result.problems for result in results) else 0


if __name__ == "__main__":
    sys.exit(main())
