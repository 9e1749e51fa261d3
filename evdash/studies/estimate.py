"""What a study will take, told before it is begun."""

import math

from evdash.domain.arrivals import GeneratedArrivals
from evdash.domain.scenario import Scenario
from evdash.domain.study import StudyRuns

DAY_SECONDS, DAY_INTERVALS, DAY_VEHICLES = 0.15, 24, 100
"""Processor time of the bundled day, measured on a quiet machine (`docs/performance.md`)."""
BY_INTERVALS, BY_VEHICLES = 1.1, 0.7
"""How times grow from there, from the same measurements."""
AC_SECONDS = 0.05
OF_POLICY = {"p1": 1.0, "p1-plain": 12.0, "bid-price": 8.0, "oracle": 5.0}
RULES = 0.4
START_SECONDS = 5.0


def seconds_needed(runs: StudyRuns, workers: int) -> float:
    """Seconds until a study's end, roughly, on a machine that does nothing else."""
    by_policy: dict[tuple[str, str], int] = {}
    for run in runs.runs:
        kind = run.policy, run.network
        by_policy[kind] = by_policy.get(kind, 0) + 1
    day = day_seconds(runs.base)
    busy = sum(
        count * (day * OF_POLICY.get(policy, RULES) + (AC_SECONDS if network == "ac" else 0.0))
        for (policy, network), count in by_policy.items()
    )
    return START_SECONDS + busy / workers


def day_seconds(scenario: Scenario) -> float:
    """Processor time of one day under P1, s."""
    arrivals = scenario.arrivals
    if isinstance(arrivals, GeneratedArrivals):
        share = scenario.intervals * scenario.interval_hours / 24
        vehicles = arrivals.vehicles_per_day * share
    else:
        vehicles = float(len(arrivals.vehicles))
    longer = math.pow(scenario.intervals / DAY_INTERVALS, BY_INTERVALS)
    return DAY_SECONDS * longer * math.pow(max(vehicles, 10.0) / DAY_VEHICLES, BY_VEHICLES)
