"""Runs many random days and reports every promise or limit broken; there should be none.

python -m benchmarks.reliability [--days 1000] [--first-seed 1] [--workers 2] [--file FILE]

Days are appended to FILE as they are done, and those already in it are not run again: ten thousand
take an hour and more, and can be stopped.

Exit status 0 if not one interval was infeasible and not one contract broken, else 3.
"""

import argparse
import os
import sys
import time
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import TypeAdapter
from rich.console import Console
from rich.table import Table

from benchmarks.kept_days import run_kept
from benchmarks.random_days import random_scenario
from benchmarks.soundness import contracts_made, executed_power, problems_of_day
from evdash.domain.trace import Trace
from evdash.horizon.day import run_day, start_day
from evdash.scheduling.p1 import p1_policy


@dataclass(frozen=True, slots=True)
class Result:
    """One day in numbers. `seconds`: solving time of each interval; gaps in $."""

    seed: int
    problems: tuple[str, ...]
    vehicles: int
    admitted: int
    refusals: Counter[str]
    statuses: Counter[str]
    seconds: tuple[float, ...]
    largest_gap: float
    largest_miss_kwh: float
    day_seconds: float
    interval_minutes: int
    negative_prices: bool
    full_chargers: int
    full_headroom: int


def run_one(seed: int) -> Result:
    """Run the random day of a seed with the paper's policy and hold it against everything."""
    began = time.perf_counter()
    trace = run_day(start_day(random_scenario(seed)), p1_policy())
    day_seconds = time.perf_counter() - began
    reports = [step.plan.report for step in trace.steps]
    gaps = [r.objective - r.bound for r in reports if r.bound is not None and r.objective]
    scenario, executed = trace.scenario, executed_power(trace)
    misses = [
        abs(request.need_kwh - float(executed[name].sum()) * scenario.interval_hours)
        for name, request in contracts_made(trace).items()
    ]
    full_chargers, full_headroom = _full_intervals(trace)
    return Result(
        seed=seed,
        problems=tuple(problems_of_day(trace)),
        vehicles=len(trace.inputs.arrivals),
        admitted=len(misses),
        refusals=Counter(_kinds(trace)),
        statuses=Counter(report.status for report in reports),
        seconds=tuple(report.seconds for report in reports),
        largest_gap=max(gaps, default=0.0),
        largest_miss_kwh=max(misses, default=0.0),
        day_seconds=day_seconds,
        interval_minutes=scenario.interval_minutes,
        negative_prices=bool((scenario.price_per_kwh < 0).any()),
        full_chargers=full_chargers,
        full_headroom=full_headroom,
    )


def _full_intervals(trace: Trace) -> tuple[int, int]:
    """In how many intervals every charger ran, and in how many no headroom was left."""
    headroom_kw = trace.inputs.rows.headroom_kw()
    chargers = trace.scenario.station.chargers
    full = sum(0 < chargers == step.plan.charging[0] for step in trace.steps)
    filled = sum(
        step.station_kw > max(1e-3, headroom_kw[step.interval] - 1e-3) for step in trace.steps
    )
    return int(full), int(filled)


def _kinds(trace: Trace) -> Iterable[str]:
    yield from (refusal.reason.kind for step in trace.steps for refusal in step.plan.refused)
    late = trace.inputs.requests[trace.scenario.intervals]
    yield from (request.refusal.kind for request in late if request.refusal)


FORM = TypeAdapter(Result)


def rows_of(results: list[Result], wall_seconds: float) -> list[tuple[str, str]]:
    """The results in words and numbers, for a table."""
    statuses = sum((r.statuses for r in results), Counter[str]())
    refusals = sum((r.refusals for r in results), Counter[str]())
    seconds = np.concatenate([r.seconds for r in results])
    days = [r.day_seconds for r in results]
    worst_miss = max(r.largest_miss_kwh for r in results)
    lengths = Counter(r.interval_minutes for r in results)
    return [
        ("seeds", f"{results[0].seed} to {results[-1].seed}"),
        ("days", f"{len(results)}"),
        ("  by interval length", ", ".join(f"{m} min {lengths[m]}" for m in sorted(lengths))),
        ("  with negative prices", f"{sum(r.negative_prices for r in results)}"),
        ("intervals", f"{len(seconds):,}"),
        ("  all chargers in use", f"{sum(r.full_chargers for r in results):,}"),
        ("  all headroom in use", f"{sum(r.full_headroom for r in results):,}"),
        ("vehicles", f"{sum(r.vehicles for r in results):,}"),
        ("contracts", f"{sum(r.admitted for r in results):,}"),
        ("refused", ", ".join(f"{kind} {n:,}" for kind, n in refusals.most_common())),
        ("infeasible intervals", f"{statuses['fallback']}"),
        ("days with any problem", f"{sum(bool(r.problems) for r in results)}"),
        (
            "largest error in energy delivered",
            f"{worst_miss:.1e} kWh",
        ),
        ("intervals not proven to the cent", f"{statuses['feasible']}"),
        ("largest gap to the bound", f"{max(r.largest_gap for r in results):.4f} $"),
        ("seconds an interval", f"median {np.median(seconds):.3f}, worst {seconds.max():.2f}"),
        ("seconds a day", f"median {np.median(days):.2f}, worst {max(days):.1f}"),
        ("wall time", f"{wall_seconds:.0f} s"),
    ]


def main(arguments: list[str] | None = None) -> int:
    """Run, print the table, name every problem with its seed."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.reliability", description=__doc__)
    parser.add_argument("--days", type=int, default=1000, help="how many days (1000)")
    parser.add_argument("--first-seed", type=int, default=1, help="seed of the first day (1)")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("--file", type=Path, help="where days are kept, and taken from")
    chosen = parser.parse_args(arguments)
    began = time.perf_counter()
    seeds = range(chosen.first_seed, chosen.first_seed + chosen.days)
    results = run_kept(run_one, seeds, chosen.workers, FORM, told="random days", file=chosen.file)
    table = Table("", "", title="Random days", show_header=False)
    for label, value in rows_of(results, time.perf_counter() - began):
        table.add_row(label, value)
    console = Console(width=110)
    console.print(table)
    broken = [result for result in results if result.problems]
    for result in broken:
        for problem in result.problems:
            console.print(f"seed {result.seed}: {problem}")
    return 3 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
