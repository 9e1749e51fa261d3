"""Arrivals drawn at random: Poisson by clock hour, each interval with a stream of its own."""

from datetime import timedelta

import numpy as np
from scipy.special import betainc, betaincinv

from evdash.domain.arrivals import Arrival, ArrivalStatistics, RecordedArrivals
from evdash.domain.scenario import Scenario
from evdash.domain.vehicles import DRAWN

SOC_STEPS = 1000
"""States of charge are drawn to a tenth of a per cent, the same on every machine."""


def arrivals_of(scenario: Scenario) -> tuple[Arrival, ...]:
    """The scenario's arrivals in order of time: as recorded, or drawn with its seed."""
    known = scenario.arrivals
    if isinstance(known, RecordedArrivals):
        return tuple(sorted(known.vehicles, key=lambda arrival: arrival.arrival))
    return draw_arrivals(scenario, known, known.seed)


def draw_arrivals(
    scenario: Scenario, statistics: ArrivalStatistics, seed: int
) -> tuple[Arrival, ...]:
    """Draw a whole day, numbered in order of time.

    The vehicles arriving within one interval come from a stream of that interval, so that
    changing a later hour leaves the earlier ones as they were.
    """
    drawn: list[Arrival] = []
    for interval in range(scenario.arrivals_end):
        stream = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(interval,)))
        drawn += _draw_interval(scenario, statistics, interval, stream)
    return renumbered(drawn)


def renumbered(arrivals: list[Arrival], first: int = 1) -> tuple[Arrival, ...]:
    """The arrivals named PEV-001, PEV-002, … in their order, counting from `first`."""
    return tuple(
        arrival.model_copy(update={"vehicle": f"{DRAWN}{number:03d}"})
        for number, arrival in enumerate(arrivals, first)
    )


def minute_rates(scenario: Scenario, statistics: ArrivalStatistics, interval: int) -> np.ndarray:
    """Mean arrivals in each minute of an interval, shape (interval_minutes,)."""
    share = np.array(statistics.hourly_share) / sum(statistics.hourly_share)
    begin = scenario.time_of(interval)
    minutes = 60 * begin.hour + begin.minute + np.arange(scenario.interval_minutes)
    hours = minutes // 60 % 24
    return np.asarray(statistics.vehicles_per_day * share[hours] / 60)


def _draw_interval(
    scenario: Scenario,
    statistics: ArrivalStatistics,
    interval: int,
    stream: np.random.Generator,
) -> list[Arrival]:
    rates = minute_rates(scenario, statistics, interval)
    count = int(stream.poisson(rates.sum()))
    if count == 0:
        return []
    minutes = np.sort(stream.choice(len(rates), size=count, p=rates / rates.sum()))
    weights = np.array([model.share for model in statistics.fleet])
    models = stream.choice(len(weights), size=count, p=weights / weights.sum())
    options = list(statistics.option_share)
    chances = np.array([statistics.option_share[name] for name in options])
    chosen = stream.choice(len(options), size=count, p=chances / chances.sum())
    soc_in, soc_out = draw_soc(statistics, count, stream)
    begin = scenario.time_of(interval)
    return [
        Arrival(
            vehicle="drawn",
            arrival=begin + timedelta(minutes=int(minutes[n])),
            option=options[chosen[n]],
            battery_kwh=statistics.fleet[models[n]].battery_kwh,
            soc_in=float(soc_in[n]),
            soc_out=float(soc_out[n]),
            max_kw=statistics.fleet[models[n]].max_kw,
        )
        for n in range(count)
    ]


def draw_soc(
    statistics: ArrivalStatistics, count: int, stream: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """States of charge on arrival and wanted, each (count,).

    The arrival's is a beta variate redrawn until below what is wanted; drawing from the
    truncated distribution outright is the same and cannot take for ever.
    """
    soc_out = np.round(stream.uniform(*statistics.soc_out, size=count) * SOC_STEPS)
    below = betainc(*statistics.soc_in_beta, soc_out / SOC_STEPS)
    soc_in = betaincinv(*statistics.soc_in_beta, stream.uniform(size=count) * below)
    steps_in = np.minimum(np.floor(soc_in * SOC_STEPS), soc_out - 1)
    return steps_in / SOC_STEPS, soc_out / SOC_STEPS
