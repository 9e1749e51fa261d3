"""Races every policy on the same days and prints what each earns of what the oracle could.

python -m benchmarks.policies [--seeds 100] [--preset NAME ...] [--workers 2] [--forecast]

Intervals of confidence are 95 % and paired: every policy meets the very same days. With
`--forecast`, bid-price is given forecasts that are wrong instead, and its loss is printed.
"""

import argparse
import os
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table
from scipy import stats

from evdash.domain.scenario import ArrivalStatistics, Scenario
from evdash.domain.trace import Trace
from evdash.files.bundled import bundled_scenarios
from evdash.files.overrides import Setting
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import run_day, start_day
from evdash.metrics.breaches import charger_breaches, linear_breaches
from evdash.metrics.totals import totals
from evdash.policies.bid_price import SAMPLES, anticipating, forecast_of
from evdash.policies.futures import sample_futures
from evdash.policies.oracle import Oracle
from evdash.policies.registry import RULES

ORACLE = "oracle"


@dataclass(frozen=True, slots=True)
class Raced:
    """One policy on one day. `share`: its profit over the most any policy could earn."""

    policy: str
    share: float
    profit: float
    admitted: int
    broken_limits: int
    broken_promises: int
    slowest_step_seconds: float


def race(job: tuple[str, int]) -> list[Raced]:
    """Every policy on the day of a preset and a seed."""
    preset, seed = job
    trace = start_day(scenario_of(preset, seed))
    oracle = Oracle(trace.inputs)
    most = oracle.foresight.most_profit
    raced = [_raced(ORACLE, timed(trace, oracle), most)]
    for name, rule in RULES.items():
        if name != ORACLE:
            day = timed(trace, rule.make(trace.inputs), rule.decide)
            raced.append(_raced(name, day, most))
    return raced


def misled(job: tuple[str, int]) -> list[Raced]:
    """P1, and bid-price with right and wrong forecasts, on the day of a preset and a seed."""
    preset, seed = job
    scenario = scenario_of(preset, seed)
    trace = start_day(scenario)
    most = Oracle(trace.inputs).foresight.most_profit
    raced = [_raced("p1", timed(trace, RULES["p1"].make(trace.inputs)), most)]
    for name, wrong in FORECASTS.items():
        futures = sample_futures(scenario, wrong(forecast_of(scenario)), SAMPLES, seed)
        raced.append(_raced(name, timed(trace, anticipating(scenario, futures)), most))
    return raced


def _fewer(known: ArrivalStatistics) -> ArrivalStatistics:
    return known.model_copy(update={"vehicles_per_day": known.vehicles_per_day / 1.3})


def _more(known: ArrivalStatistics) -> ArrivalStatistics:
    return known.model_copy(update={"vehicles_per_day": known.vehicles_per_day / 0.7})


def _earlier(known: ArrivalStatistics) -> ArrivalStatistics:
    share = tuple(np.roll(known.hourly_share, -2))
    return known.model_copy(update={"hourly_share": share})


def _other_options(known: ArrivalStatistics) -> ArrivalStatistics:
    """The shares of the first and the last option exchanged."""
    names, shares = zip(*known.option_share.items(), strict=True)
    return known.model_copy(update={"option_share": dict(zip(names, shares[::-1], strict=True))})


FORECASTS: Mapping[str, Callable[[ArrivalStatistics], ArrivalStatistics]] = {
    "forecast right": lambda known: known,
    "30 % more come than forecast": _fewer,
    "30 % fewer come than forecast": _more,
    "all come two hours later than forecast": _earlier,
    "option shares the other way round": _other_options,
}


def scenario_of(preset: str, seed: int) -> Scenario:
    """A bundled scenario with the arrivals of a seed."""
    folder = next(folder for folder in bundled_scenarios() if folder.name == preset)
    return read_scenario(folder, (Setting("arrivals.seed", seed),))


def timed(trace: Trace, policy, decide=None) -> tuple[Trace, float]:  # type: ignore[no-untyped-def]
    """A day run to its end, and its slowest step, s."""
    slowest, began = 0.0, time.perf_counter()

    def told(_: Trace) -> None:
        nonlocal slowest, began
        now = time.perf_counter()
        slowest, began = max(slowest, now - began), now

    return run_day(trace, policy, told, decide), slowest


def _raced(name: str, day: tuple[Trace, float], most: float) -> Raced:
    trace, slowest = day
    sums = totals(trace)
    broken = [breach for breach in linear_breaches(trace) if breach.by_station]
    return Raced(
        policy=name,
        share=sums.profit / most,
        profit=sums.profit,
        admitted=sums.admitted,
        broken_limits=len(broken) + len(charger_breaches(trace)),
        broken_promises=sums.broken,
        slowest_step_seconds=slowest,
    )


def interval(values: list[float]) -> tuple[float, float]:
    """Mean, and half the width of its 95 % interval of confidence."""
    mean = float(np.mean(values))
    if len(values) < 2:
        return mean, float("nan")
    return mean, float(stats.sem(values) * stats.t.ppf(0.975, len(values) - 1))


def report(console: Console, preset: str, days: list[list[Raced]]) -> None:
    """One preset's table, best share first."""
    table = Table(title=f"{preset}, {len(days)} days")
    for column in (
        "",
        "profit / oracle's bound",
        "over p1, $ a day",
        "admitted",
        "limits broken",
        "promises broken",
        "slowest step, s",
    ):
        table.add_column(column, justify="left" if not column else "right")
    baseline = [_of(day, "p1").profit for day in days]
    for name in sorted((r.policy for r in days[0]), key=lambda n: -_mean_share(days, n)):
        mine = [_of(day, name) for day in days]
        share, half = interval([r.share for r in mine])
        over, over_half = interval([r.profit - p for r, p in zip(mine, baseline, strict=True)])
        table.add_row(
            name,
            f"{share:.3f} ± {half:.3f}",
            f"{over:+.2f} ± {over_half:.2f}",
            f"{np.mean([r.admitted for r in mine]):.1f}",
            f"{sum(r.broken_limits for r in mine)}",
            f"{sum(r.broken_promises for r in mine)}",
            f"{max(r.slowest_step_seconds for r in mine):.2f}",
        )
    console.print(table)


def _of(day: list[Raced], name: str) -> Raced:
    return next(raced for raced in day if raced.policy == name)


def _mean_share(days: list[list[Raced]], name: str) -> float:
    return float(np.mean([_of(day, name).share for day in days]))


def main() -> None:
    """Race, and print."""
    presets = [folder.name for folder in bundled_scenarios()]
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--seeds", type=int, default=100)
    options.add_argument("--preset", nargs="+", choices=presets, default=presets)
    options.add_argument("--workers", type=int, default=os.cpu_count())
    options.add_argument("--forecast", action="store_true")
    chosen = options.parse_args()
    console = Console()
    with ProcessPoolExecutor(chosen.workers) as pool:
        for preset in chosen.preset:
            jobs = [(preset, seed) for seed in range(1, chosen.seeds + 1)]
            days: Iterator[list[Raced]] = pool.map(misled if chosen.forecast else race, jobs)
            told = track(days, preset, len(jobs), console=Console(stderr=True))
            report(console, preset, list(told))


if __name__ == "__main__":
    main()
