"""Lets things happen on random days and holds every shortfall against the least possible.

python -m benchmarks.events [--days 1000] [--first-seed 1] [--workers 2] [--file FILE]

Days are appended to FILE as they are done, and those already in it are not run again.
Exit status 0 if every shortfall is the least an independent MILP finds, nobody new was admitted
while a promise was short, and every promise and limit else was kept; else 3.
"""

import argparse
import os
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from pydantic import TypeAdapter
from rich.console import Console
from rich.table import Table

from benchmarks.kept_days import run_kept
from benchmarks.random_days import random_scenario
from benchmarks.random_events import random_events
from benchmarks.recourse_by_milp import BOTH, OTHER, Least, claims_of, least_of, most_more
from benchmarks.soundness import problems_of_step
from evdash.domain.trace import Happening, State, Trace
from evdash.horizon.day import start_day, step
from evdash.horizon.happen import happen
from evdash.horizon.recourse import LEFT_BEHIND, SHED, UNPROVEN, UNPROVEN_FEWEST
from evdash.metrics.breaches import linear_breaches
from evdash.metrics.ledger import LedgerEntry, ledger
from evdash.metrics.records import executed_power
from evdash.scheduling.p1 import p1_policy

SAME_KWH, SAME_USD = 1e-4, 1e-3
"""What floating point and the hair between two objectives may come to."""


@dataclass
class Result:
    """One day in numbers, and everything wrong with it."""

    seed: int
    problems: list[str] = field(default_factory=list)
    kinds: Counter[str] = field(default_factory=Counter)
    counts: Counter[str] = field(default_factory=Counter)
    fates: Counter[str] = field(default_factory=Counter)
    short_kwh: float = 0.0
    largest_difference_kwh: float = 0.0
    seconds: list[float] = field(default_factory=list)


FORM = TypeAdapter(Result)


def run_one(seed: int) -> Result:
    """Run the random day of a seed with random events."""
    rng, result, policy = np.random.default_rng(seed + 1_000_000), Result(seed), p1_policy()
    trace = start_day(random_scenario(seed))
    while not trace.is_over:
        events = random_events(rng, trace)
        if events:
            before, began = trace.state, time.perf_counter()
            trace = happen(trace, events)
            result.seconds.append(time.perf_counter() - began)
            judge(result, trace, before)
        trace = step(trace, policy)
    result.problems += [p for s in trace.steps for p in problems_of_step(s)]
    result.problems += day_problems(trace)
    entries = ledger(trace)
    result.fates.update(entry.status for entry in entries)
    result.short_kwh = sum(entry.short_kwh for entry in entries)
    return result


def judge(result: Result, trace: Trace, before: State) -> None:
    """Hold the last happening against the independent MILP."""
    happening, inputs = trace.happenings[-1], trace.inputs
    result.kinds.update(event.event for event in happening.events)
    result.counts["happenings"] += 1
    at = f"interval {happening.interval}"
    claims = claims_of(inputs, before, happening.events)
    least = least_of(inputs, happening.interval, claims)
    if least is None:
        least = least_of(inputs, happening.interval, claims, OTHER)
    elif not _same(least, happening):
        least = least_of(inputs, happening.interval, claims, BOTH)
    if least is None:
        result.counts["not worked again in time"] += 1
        return
    firm = {claim.vehicle for claim in claims if claim.firm}
    owed = {c.vehicle: c for c in (*before.contracts, *before.waiting)}
    after = owed | {revision.vehicle: revision.after for revision in happening.revisions}
    short = sum(after[vehicle].short_kwh for vehicle in firm)
    result.counts["short"] += short > SAME_KWH
    if short < least.short_kwh - SAME_KWH:
        # what was cut before keeps the lowest power of its smaller terms, see the docs
        result.counts["less than the least"] += 1
        if not any(contract.is_short for contract in owed.values()):
            result.problems.append(f"{at}: {short} kWh short, least possible {least.short_kwh}")
        return
    result.largest_difference_kwh = max(result.largest_difference_kwh, short - least.short_kwh)
    if short > least.short_kwh + SAME_KWH:
        result.problems.append(f"{at}: {short:.5f} kWh short, least {least.short_kwh:.5f}")
    count = sum(after[vehicle].short_kwh > SAME_KWH for vehicle in firm)
    told = UNPROVEN_FEWEST in happening.note
    result.counts["fewest not proven"] += told
    if count != least.vehicles and least.short_kwh > SAME_KWH and not told:
        result.problems.append(f"{at}: {count} vehicles short, fewest {least.vehicles}")
    _judge_drivers(result, trace, happening, before, least.given_up_kwh)
    result.counts["more than fewest"] += told and count > least.vehicles
    result.counts["least not proven"] += UNPROVEN in happening.note
    result.counts["shed without the optimiser"] += SHED in happening.note
    result.counts["solvers left behind"] += LEFT_BEHIND in happening.note


def _same(least: Least, happening: Happening) -> bool:
    """Whether all that is short now, and as many, is what was found."""
    contracts = (*happening.after.contracts, *happening.after.waiting)
    short = [contract.short_kwh for contract in contracts if contract.short_kwh > SAME_KWH]
    return abs(sum(short) - least.short_kwh) <= SAME_KWH and len(short) == least.vehicles


def _judge_drivers(
    result: Result, trace: Trace, happening: Happening, before: State, least_kwh: float
) -> None:
    """What drivers give up is the least beside all promises; more is granted as far as it can."""
    at, inputs = f"interval {happening.interval}", trace.inputs
    claims = claims_of(inputs, before, happening.events)
    own = {claim.vehicle: claim for claim in claims if not claim.firm}
    asks = [event for event in happening.events if event.event == "asks_more"]
    after = {revision.vehicle: revision.after for revision in happening.revisions}
    if own and not any(event.subject in own for event in asks):
        given_up = sum(
            claim.owed_kwh - (after[name].request.need_kwh - after[name].delivered_kwh)
            for name, claim in own.items()
            if name in after
        )
        result.counts["given up"] += given_up > SAME_KWH
        if abs(given_up - least_kwh) > SAME_KWH:
            result.problems.append(f"{at}: {given_up:.5f} kWh given up, least {least_kwh:.5f}")
    if len(asks) == 1 and not own and not happening.after.is_short and not before.is_short:
        _judge_more(result, trace, happening, before)


def _judge_more(result: Result, trace: Trace, happening: Happening, before: State) -> None:
    asks = next(event for event in happening.events if event.event == "asks_more")
    claims = claims_of(trace.inputs, before, happening.events)
    contract = next((c for c in before.contracts if c.vehicle == asks.subject), None)
    if contract is None or asks.subject not in {claim.vehicle for claim in claims}:
        return  # nothing to ask more of: it has all its energy, or has just left
    request = contract.request
    full = (1 - request.soc_in) * request.battery_kwh / trace.scenario.station.efficiency
    extra = min(asks.amount, full - request.need_kwh)
    most = (
        most_more(trace.inputs, happening.interval, claims, request.vehicle, extra)
        if extra > SAME_KWH
        else 0.0
    )
    granted = sum(r.promised_kwh for r in happening.revisions if r.vehicle == request.vehicle)
    result.counts["asked for more"] += 1
    result.counts["granted some"] += granted > SAME_KWH
    if abs(granted - most) > SAME_KWH:
        at = f"interval {happening.interval}"
        result.problems.append(f"{at}: {granted:.5f} kWh more granted, most {most:.5f}")


def day_problems(trace: Trace) -> Iterator[str]:
    """Promises as last agreed that were not kept, limits broken, newcomers taken too soon."""
    drawn: dict[str, float] = {}
    for interval, vehicle, power_kw in executed_power(trace):
        drawn[vehicle] = drawn.get(vehicle, 0.0) + power_kw * trace.scenario.interval_hours
        if not _there(trace, vehicle, interval):
            yield f"{vehicle} charges in interval {interval}, when it is away"
    for entry in ledger(trace):
        yield from _entry_problems(entry, drawn.get(entry.vehicle, 0.0))
    for breach in linear_breaches(trace):
        if breach.by_station:
            yield f"interval {breach.interval}: {breach.element} worsened by {breach.depth}"
    for taken in trace.steps:
        if taken.before.is_short and taken.plan.admitted:
            yield f"interval {taken.interval}: admits someone while promises are short"


def _there(trace: Trace, vehicle: str, interval: int) -> bool:
    for event in trace.inputs.given.events:
        if event.subject != vehicle or event.interval > interval:
            continue
        gone = event.event == "leaves_early" and interval >= event.until_interval
        away = event.event == "late" and interval < event.from_interval
        if gone or away or event.event == "no_show":
            return False
    return True


def _entry_problems(entry: LedgerEntry, drawn_kwh: float) -> Iterator[str]:
    if abs(entry.delivered_kwh - drawn_kwh) > SAME_KWH:
        yield f"{entry.vehicle}: the ledger says {entry.delivered_kwh}, it drew {drawn_kwh}"
    missing = entry.revised_kwh - drawn_kwh
    if abs(missing - entry.short_kwh) > 0.01:
        yield f"{entry.vehicle}: {missing} kWh missing, the ledger says {entry.short_kwh}"
    if entry.status == "short" and not any(change.short_kwh > 0 for change in entry.changes):
        yield f"{entry.vehicle}: short by {entry.short_kwh} kWh and nothing that happened says why"


def rows_of(results: list[Result], wall_seconds: float) -> list[tuple[str, str]]:
    """The results in words and numbers."""
    counts = sum((r.counts for r in results), Counter[str]())
    kinds = sum((r.kinds for r in results), Counter[str]())
    fates = sum((r.fates for r in results), Counter[str]())
    seconds = np.array([s for r in results for s in r.seconds] or [0.0])
    return [
        ("seeds", f"{results[0].seed} to {results[-1].seed}"),
        ("days", f"{len(results)}"),
        ("events", f"{sum(kinds.values()):,}"),
        ("  by kind", ", ".join(f"{kind} {n}" for kind, n in kinds.most_common())),
        ("intervals in which something happened", f"{counts['happenings']:,}"),
        ("  after which promises were short", f"{counts['short']:,}"),
        ("  in which a driver gave something up", f"{counts['given up']:,}"),
        (
            "  in which more was asked, and granted",
            f"{counts['asked for more']:,}, {counts['granted some']:,}",
        ),
        ("contracts", ", ".join(f"{fate} {n:,}" for fate, n in fates.most_common())),
        ("energy short", f"{sum(r.short_kwh for r in results):,.0f} kWh"),
        (
            "largest excess over the least",
            f"{max(r.largest_difference_kwh for r in results):.1e} kWh",
        ),
        ("terms cut before kept below the least", f"{counts['less than the least']}"),
        ("not worked again in time", f"{counts['not worked again in time']}"),
        ("settled without the optimiser", f"{counts['shed without the optimiser']}"),
        ("said not to be proven the least", f"{counts['least not proven']}"),
        (
            "said not to be proven the fewest, and were not",
            f"{counts['fewest not proven']}, {counts['more than fewest']}",
        ),
        ("solvers left behind", f"{counts['solvers left behind']}"),
        ("seconds to settle", f"median {np.median(seconds):.3f}, worst {seconds.max():.2f}"),
        ("days with any problem", f"{sum(bool(r.problems) for r in results)}"),
        ("wall time", f"{wall_seconds:.0f} s"),
    ]


def main(arguments: list[str] | None = None) -> int:
    """Run, print the table, name every problem with its seed."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.events", description=__doc__)
    parser.add_argument("--days", type=int, default=1000, help="how many days (1000)")
    parser.add_argument("--first-seed", type=int, default=1, help="seed of the first day (1)")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("--file", type=Path, help="where days are kept, and taken from")
    chosen = parser.parse_args(arguments)
    began = time.perf_counter()
    seeds = range(chosen.first_seed, chosen.first_seed + chosen.days)
    results = run_kept(run_one, seeds, chosen.workers, FORM, told="random events", file=chosen.file)
    table = Table("", "", title="Random days with random events", show_header=False)
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
