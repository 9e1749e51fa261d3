"""Races policies on the same days and prints what each earns of what the oracle could.

python -m benchmarks.policies [--seeds 100] [--preset NAME ...] [--policies NAME ...]
                              [--forecast] [--file FILE] [--svg FILE] [--workers 1]

Intervals of confidence are 95 % and paired: every policy meets the very same days. Days are
appended to FILE as they are done, and those already in it are not raced again. With
`--forecast`, bid-price is also given forecasts that are wrong, and what that costs is printed.
"""

import argparse
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table
from scipy import stats

from benchmarks.race_days import (
    ANTICIPATING,
    FORECASTS,
    ORACLE,
    RIGHT,
    Job,
    RacedDay,
    append_days,
    race,
    read_days,
)
from benchmarks.race_drawing import COLOURS, save_svg
from evdash.files.bundled import bundled_scenarios
from evdash.policies.registry import RULES

SLOW = "p1-plain"
"""Decides as p1 does and takes minutes a day."""
FILE = Path(__file__).parents[1] / "data" / "results" / "race.csv"

Contestant = tuple[str, str]


def jobs(
    preset: str, seeds: int, contestants: Sequence[Contestant], known: Sequence[RacedDay]
) -> list[Job]:
    """What is still to be raced of a preset's days."""
    done = {day.key for day in known}
    bounds = {(day.preset, day.seed): day.most_profit for day in known}
    left = []
    for seed in range(1, seeds + 1):
        missing = tuple(one for one in contestants if (preset, seed, *one) not in done)
        if missing:
            left.append(Job(preset, seed, missing, bounds.get((preset, seed))))
    return left


def interval(values: Sequence[float]) -> tuple[float, float]:
    """Mean, and half the width of its 95 % interval of confidence."""
    mean = float(np.mean(values))
    if len(values) < 2:
        return mean, float("nan")
    return mean, float(stats.sem(values) * stats.t.ppf(0.975, len(values) - 1))


def report(
    console: Console, preset: str, contestants: Sequence[Contestant], days: Sequence[RacedDay]
) -> None:
    """One preset's table, best share first; only days that every contestant has been through."""
    found = {day.key: day for day in days if day.preset == preset}
    compared = (("p1", RIGHT), *contestants)
    seeds = [
        seed
        for seed in sorted({day.seed for day in found.values()})
        if all((preset, seed, *one) in found for one in compared)
    ]
    if not seeds:
        return
    table = Table(title=f"{preset}, {len(seeds)} days")
    for column in (
        "",
        "profit / oracle's bound",
        "over p1, $ a day",
        "admitted",
        "limits broken",
        "promises broken",
        "CPU a day, s",
        "slowest step, CPU s",
    ):
        table.add_column(column, justify="left" if not column else "right")
    rows = {one: [found[preset, seed, *one] for seed in seeds] for one in contestants}
    base = [found[preset, seed, "p1", RIGHT].profit for seed in seeds]
    for one in sorted(contestants, key=lambda c: -np.mean([day.share for day in rows[c]])):
        mine = rows[one]
        share, half = interval([day.share for day in mine])
        over, over_half = interval([day.profit - p for day, p in zip(mine, base, strict=True)])
        table.add_row(
            one[0] if one[1] == RIGHT else f"{one[0]}, {one[1]}",
            f"{share:.3f} ± {half:.3f}",
            f"{over:+.2f} ± {over_half:.2f}",
            f"{np.mean([day.admitted for day in mine]):.1f}",
            f"{sum(day.broken_limits for day in mine)}",
            f"{sum(day.broken_promises for day in mine)}",
            f"{np.mean([day.day_cpu_s for day in mine]):.2f}",
            f"{max(day.slowest_step_cpu_s for day in mine):.2f}",
        )
    console.print(table)


def shares(
    presets: Sequence[str], days: Sequence[RacedDay]
) -> dict[str, dict[str, tuple[float, float]]]:
    """Mean share of the oracle's bound, and half width, by preset and policy, as drawn."""
    return {
        preset: {
            policy: interval(mine)
            for policy in COLOURS
            for mine in [
                [d.share for d in days if d.key[2:] == (policy, RIGHT) and d.preset == preset]
            ]
            if mine
        }
        for preset in presets
    }


def contestants_of(policies: Sequence[str], forecast: bool) -> list[Contestant]:
    """The policies, and the anticipating one once more for every wrong forecast."""
    told = [(name, RIGHT) for name in policies]
    if forecast and ANTICIPATING in policies:
        told += [(ANTICIPATING, wrong) for wrong in FORECASTS]
    return told


def main() -> None:
    """Race what is missing, and print."""
    presets = [folder.name for folder in bundled_scenarios()]
    usual = [ORACLE, *(name for name in RULES if name not in (ORACLE, SLOW))]
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("--seeds", type=int, default=100)
    options.add_argument("--preset", nargs="+", choices=presets, default=presets)
    options.add_argument("--policies", nargs="+", choices=list(RULES), default=usual)
    options.add_argument("--forecast", action="store_true")
    options.add_argument("--file", type=Path, default=FILE)
    options.add_argument("--svg", type=Path, help="where to draw the shares")
    options.add_argument("--workers", type=int, default=1)
    chosen = options.parse_args()
    contestants = contestants_of(chosen.policies, chosen.forecast)
    console = Console()
    with ProcessPoolExecutor(chosen.workers) as pool:
        for preset in chosen.preset:
            left = jobs(preset, chosen.seeds, contestants, read_days(chosen.file))
            raced = pool.map(race, left)
            for days in track(raced, preset, len(left), console=Console(stderr=True)):
                append_days(chosen.file, days)
            report(console, preset, contestants, read_days(chosen.file))
    if chosen.svg:
        save_svg(shares(chosen.preset, read_days(chosen.file)), chosen.svg)


if __name__ == "__main__":
    main()
