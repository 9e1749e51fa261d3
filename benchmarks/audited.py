"""Random days with random events, their files audited: is anything found that is not so?

python -m benchmarks.audited [--days 50] [--first-seed 1] [--network lindistflow] [--workers 2]

Days of more than 60 intervals are left out. Broken promises are found and told, as they should be.
Exit status 0 if nothing else is found, also against P1's optima as the plain formulation proves
them; else 3.
"""

import argparse
import os
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from rich.console import Console

from benchmarks.random_days import random_scenario
from benchmarks.random_events import random_events
from evdash.audit.audit import audit_run
from evdash.cli.optimum import prove
from evdash.domain.trace import Network, Trace
from evdash.files.run_export import RunLabel, judge, run_files
from evdash.horizon.day import start_day, step
from evdash.horizon.happen import happen
from evdash.metrics.breaches import linear_breaches
from evdash.scheduling.p1 import p1_policy

MOST_INTERVALS = 60
BROKEN = "a broken promise"


@dataclass(frozen=True, slots=True)
class Audited:
    """A day's intervals, those of which P1 was proven anew and told, and what was found."""

    seed: int
    intervals: int
    proven: int
    untold: int
    findings: tuple[str, ...]


def audited(network: Network, seed: int) -> Audited:
    """Run the random day of a seed, write its files, audit them; long days are left out."""
    if random_scenario(seed).intervals > MOST_INTERVALS:
        return Audited(seed, 0, 0, 0, ())
    trace = day_with_events(seed, network)
    with tempfile.TemporaryDirectory() as place:
        write(Path(place), trace)
        audit = audit_run(Path(place))
        proofs = prove(audit.run)
    findings = (*audit.findings, *proofs.findings)
    return Audited(
        seed,
        len(trace.steps),
        proofs.proven,
        len(proofs.open),
        tuple(finding for finding in findings if BROKEN not in finding),
    )


def day_with_events(seed: int, network: Network) -> Trace:
    """The random day of a seed, with random events."""
    rng, policy = np.random.default_rng(seed + 1_000_000), p1_policy()
    trace = start_day(random_scenario(seed), network)
    while not trace.is_over:
        events = random_events(rng, trace)
        trace = step(happen(trace, events) if events else trace, policy)
    return trace


def write(folder: Path, trace: Trace) -> None:
    """The files of a run by P1."""
    label = RunLabel("p1", trace.inputs.network, trace.scenario.arrivals.seed, 1.0)
    files = run_files(trace, judge(trace, linear_breaches(trace)), label)
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8", newline="")


def told(results: list[Audited]) -> Iterator[str]:
    """What came of it, line by line."""
    days = [one for one in results if one.intervals]
    intervals, proven = sum(d.intervals for d in days), sum(d.proven for d in days)
    yield (
        f"{len(days)} days, {intervals} intervals; P1 proven anew in {proven}, "
        f"{sum(d.untold for d in days)} not told by the files or not proven"
    )
    yield from (f"seed {one.seed}: {finding}" for one in days for finding in one.findings)


def main(arguments: list[str] | None = None) -> int:
    """Run, and name everything found with its seed."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.audited", description=__doc__)
    parser.add_argument("--days", type=int, default=50, help="how many seeds (50)")
    parser.add_argument("--first-seed", type=int, default=1, help="the first (1)")
    parser.add_argument("--network", choices=("lindistflow", "ac"), default="lindistflow")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes")
    chosen = parser.parse_args(arguments)
    seeds = range(chosen.first_seed, chosen.first_seed + chosen.days)
    with ProcessPoolExecutor(chosen.workers) as pool:
        results = list(pool.map(partial(audited, chosen.network), seeds))
    console = Console(soft_wrap=True, markup=False, highlight=False)
    for line in told(results):
        console.print(line)
    return 3 if any(one.findings for one in results) else 0


if __name__ == "__main__":
    sys.exit(main())
