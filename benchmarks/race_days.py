"""Days of the race as rows of a file, so that a long race can be stopped and taken up again."""

import csv
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np

from evdash.domain.arrivals import ArrivalStatistics
from evdash.domain.plan import Policy
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.files.bundled import bundled_scenarios
from evdash.files.overrides import Setting
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import run_day, start_day
from evdash.metrics.breaches import charger_breaches, linear_breaches
from evdash.metrics.service import totals
from evdash.policies.bid_price import forecast_of, informed
from evdash.policies.oracle import Oracle
from evdash.policies.registry import RULES

RIGHT = "right"
ORACLE, ANTICIPATING = "oracle", "bid-price"


@dataclass(frozen=True, slots=True)
class RacedDay:
    """One policy on one day. `most_profit` in $ is the oracle's bound, `profit` what it earned.

    Seconds are of CPU time: they do not depend on what else the machine is doing.
    """

    preset: str
    seed: int
    policy: str
    forecast: str
    most_profit: float
    profit: float
    arrived: int
    admitted: int
    broken_limits: int
    broken_promises: int
    day_cpu_s: float
    slowest_step_cpu_s: float

    @property
    def share(self) -> float:
        """Profit of the most any policy within the limits could earn."""
        return self.profit / self.most_profit

    @property
    def key(self) -> tuple[str, int, str, str]:
        return self.preset, self.seed, self.policy, self.forecast


@dataclass(frozen=True, slots=True)
class Job:
    """What of one day is still to be raced: (policy, forecast) pairs; its bound if known."""

    preset: str
    seed: int
    contestants: tuple[tuple[str, str], ...]
    most_profit: float | None


def race(job: Job) -> list[RacedDay]:
    """Every contestant on the day of a preset and a seed."""
    scenario = scenario_of(job.preset, job.seed)
    trace = start_day(scenario)
    oracle, most = None, job.most_profit
    if most is None or (ORACLE, RIGHT) in job.contestants:
        oracle = Oracle(trace.inputs)
        most = oracle.foresight.most_profit
    raced = []
    for name, forecast in job.contestants:
        began = time.process_time()
        policy = oracle if name == ORACLE else _made(name, forecast, scenario, trace)
        day, slowest = timed(trace, policy, RULES[name].decide)
        broken = [breach for breach in linear_breaches(day) if breach.by_station]
        sums = totals(day)
        raced.append(
            RacedDay(
                preset=job.preset,
                seed=job.seed,
                policy=name,
                forecast=forecast,
                most_profit=most,
                profit=sums.profit,
                arrived=sums.arrived,
                admitted=sums.admitted,
                broken_limits=len(broken) + len(charger_breaches(day)),
                broken_promises=sums.broken,
                day_cpu_s=time.process_time() - began,
                slowest_step_cpu_s=slowest,
            )
        )
    return raced


def _made(name: str, forecast: str, scenario: Scenario, trace: Trace) -> Policy:
    if name != ANTICIPATING or forecast == RIGHT:
        return RULES[name].make(trace.inputs)
    return informed(scenario, FORECASTS[forecast](forecast_of(scenario)))


def scenario_of(preset: str, seed: int) -> Scenario:
    """A bundled scenario with the arrivals of a seed."""
    folder = next(folder for folder in bundled_scenarios() if folder.name == preset)
    return read_scenario(folder, (Setting("arrivals.seed", seed),))


def timed(trace: Trace, policy: Policy, decide=None) -> tuple[Trace, float]:  # type: ignore[no-untyped-def]
    """A day run to its end, and its slowest step, s of CPU time."""
    slowest, began = 0.0, time.process_time()

    def told(_: Trace) -> None:
        nonlocal slowest, began
        now = time.process_time()
        slowest, began = max(slowest, now - began), now

    return run_day(trace, policy, told, decide), slowest


def read_days(file: Path) -> list[RacedDay]:
    """The days of an earlier race; none where there is no file."""
    if not file.exists():
        return []
    kinds = {"str": str, "int": int, "float": float}
    with file.open(encoding="utf-8", newline="") as rows:
        return [
            RacedDay(
                **{one.name: kinds[one.type.__name__](row[one.name]) for one in fields(RacedDay)}
            )
            for row in csv.DictReader(rows)
        ]


def append_days(file: Path, days: Iterable[RacedDay]) -> None:
    """Write days behind those already in a file."""
    begun = file.exists()
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("a", encoding="utf-8", newline="") as rows:
        writer = csv.DictWriter(rows, [one.name for one in fields(RacedDay)], lineterminator="\n")
        if not begun:
            writer.writeheader()
        for day in days:
            told = {k: round(v, 6) if isinstance(v, float) else v for k, v in asdict(day).items()}
            writer.writerow(told)


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
    "30 % more come": _fewer,
    "30 % fewer come": _more,
    "two hours later": _earlier,
    "options the other way round": _other_options,
}
"""How the day differs from what bid-price was told of it."""
