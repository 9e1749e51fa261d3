"""The same day with other arrivals: one run a seed, and what solving it took."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from evdash.domain.arrivals import GeneratedArrivals
from evdash.domain.plan import Policy
from evdash.domain.scenario import Scenario
from evdash.horizon.day import run_day, start_day
from evdash.metrics.service import totals


@dataclass(frozen=True, slots=True)
class DayTaken:
    """A day run with one seed: who came, and seconds of solving, in all and in the slowest
    interval; `proven` of its `intervals` were solved to the cent."""

    seed: int
    arrived: int
    admitted: int
    profit: float
    intervals: int
    proven: int
    seconds: float
    slowest_seconds: float


def days_taken(
    scenario: Scenario,
    seeds: Iterable[int],
    policy: Policy,
    on_step: Callable[[], None] | None = None,
) -> Iterator[DayTaken]:
    """Run the scenario's day with each seed; a scenario whose arrivals are listed has only one.

    `on_step` is called after every interval, so that a caller can stop within a day.
    """
    for seed in seeds:
        yield _day(with_seed(scenario, seed), seed, policy, on_step)


def with_seed(scenario: Scenario, seed: int) -> Scenario:
    """The scenario with other random arrivals."""
    if not isinstance(scenario.arrivals, GeneratedArrivals):
        return scenario
    return scenario.replacing(arrivals=scenario.arrivals.model_copy(update={"seed": seed}))


def _day(
    scenario: Scenario, seed: int, policy: Policy, on_step: Callable[[], None] | None
) -> DayTaken:
    told = (lambda _: on_step()) if on_step else None
    trace = run_day(start_day(scenario), policy, told)
    reports = [step.plan.report for step in trace.steps]
    sums = totals(trace)
    return DayTaken(
        seed=seed,
        arrived=sums.arrived,
        admitted=sums.admitted,
        profit=sums.profit,
        intervals=len(reports),
        proven=sum(report.status == "optimal" for report in reports),
        seconds=sum(report.seconds for report in reports),
        slowest_seconds=max(report.seconds for report in reports),
    )
