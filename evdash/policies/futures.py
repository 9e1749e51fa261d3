"""Who might come: days drawn from the forecast, thinned to what the day has shown so far.

Only statistics are known here, the generator's keys or `[arrivals.forecast]`; never who comes.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import xlogy
from scipy.stats import chi2

from evdash.domain.arrivals import ArrivalStatistics
from evdash.domain.plan import Snapshot
from evdash.domain.scenario import Scenario
from evdash.domain.vehicles import Request
from evdash.horizon.arrivals import draw_arrivals, minute_rates
from evdash.horizon.requests import requests_by_interval

STREAM = 0xF07E
"""Keeps the streams of futures apart from the stream of the day itself."""
MOST = 2.0
"""Days are drawn with so many times the forecast's vehicles: as far as it can be corrected up."""
TRUST_VEHICLES = 16.0
"""The forecast's own weight against what is seen: a rate known to a quarter, 1/0.25²."""

AHEAD_HOURS = 8.0
"""Who comes later than that hardly bears on what is decided now."""
TESTED_VEHICLES = 8.0
DOUBT = 0.05
TINY = 1e-12

Marked = tuple[float, Request]
"""A vehicle that might come, and the thinning at which it does."""


@dataclass(frozen=True, slots=True)
class Futures:
    """Sampled days of possible requests by interval, and the arrivals expected, (intervals,)."""

    days: tuple[tuple[tuple[Marked, ...], ...], ...]
    expected: np.ndarray

    def coming(self, snapshot: Snapshot) -> list[tuple[Request, ...]]:
        """Of each sampled day those that come in the hours after the snapshot's interval.

        As many as the day so far lets expect, and the fewer the less it bears the forecast out:
        where it denies it, nobody is expected, and nothing is decided other than by P1.
        """
        share = self.correction(snapshot) * self.trust(snapshot) / MOST
        soon = round(AHEAD_HOURS / snapshot.interval_hours)
        ahead = slice(snapshot.now + 1, snapshot.now + 1 + soon)
        return [
            tuple(r for group in day[ahead] for mark, r in group if mark < share)
            for day in self.days
        ]

    def trust(self, snapshot: Snapshot) -> float:
        """How far the hours of the arrivals so far bear the forecast out, from 0 to 1.

        A likelihood-ratio test of Poisson counts: by how much they, put together until
        TESTED_VEHICLES are expected, differ from the forecast's course at the day's own level.
        Full trust while such counts are no rarer than DOUBT, less in proportion below.
        """
        seen = np.array([*snapshot.asked, len(snapshot.requests)], dtype=float)
        forecast = self.expected[: snapshot.now + 1]
        begins = _begins_of_groups(forecast[-len(seen) :], TESTED_VEHICLES)
        if len(begins) < 2:
            return 1.0
        counts, means = (np.add.reduceat(x, begins) for x in (seen, forecast[-len(seen) :]))
        means = means * counts.sum() / means.sum()
        deviance = 2 * float(
            (xlogy(counts, counts / np.maximum(means, TINY)) - counts + means).sum()
        )
        return min(1.0, float(chi2.sf(deviance, len(begins) - 1)) / DOUBT)

    def correction(self, snapshot: Snapshot) -> float:
        """How many times the forecast's vehicles are to be expected, after what came so far.

        The mean of a gamma prior around 1 of weight TRUST_VEHICLES after as many Poisson
        arrivals: where nobody comes it falls towards 0, and the policy towards P1.
        """
        seen = sum(snapshot.asked) + len(snapshot.requests)
        forecast = float(self.expected[: snapshot.now + 1].sum())
        return min(MOST, (TRUST_VEHICLES + seen) / (TRUST_VEHICLES + forecast))


def _begins_of_groups(expected: np.ndarray, least: float) -> np.ndarray:
    """Where groups of intervals begin that expect at least so many; the last takes the rest."""
    begins, within = [0], 0.0
    for interval, mean in enumerate(expected[:-1].tolist()):
        within += mean
        if within >= least and float(expected[interval + 1 :].sum()) >= least:
            begins.append(interval + 1)
            within = 0.0
    return np.array(begins)


def sample_futures(
    scenario: Scenario, statistics: ArrivalStatistics, samples: int, seed: int
) -> Futures:
    """Days drawn once and kept: the same futures are asked at every interval."""
    busier = statistics.model_copy(update={"vehicles_per_day": MOST * statistics.vehicles_per_day})
    days = []
    for sample in range(samples):
        own = np.random.SeedSequence((STREAM, seed), spawn_key=(sample,))
        arrivals = draw_arrivals(scenario, busier, int(own.generate_state(1)[0]))
        marks = np.random.default_rng(own).uniform(size=len(arrivals))
        days.append(_marked(requests_by_interval(scenario, arrivals), marks))
    return Futures(tuple(days), _expected(scenario, statistics))


def _marked(
    groups: Sequence[Sequence[Request]], marks: np.ndarray
) -> tuple[tuple[Marked, ...], ...]:
    mark = iter(marks.tolist())
    return tuple(
        tuple(
            (at, replace(request, vehicle=f"expected {request.vehicle}"))
            for at, request in [(next(mark), request) for request in group]
            if not request.refusal
        )
        for group in groups
    )


def _expected(scenario: Scenario, statistics: ArrivalStatistics) -> np.ndarray:
    """Requests to be expected in each interval, (intervals,): arrivals of the one before."""
    arriving = [
        float(minute_rates(scenario, statistics, interval).sum())
        for interval in range(scenario.arrivals_end)
    ]
    expected = np.zeros(scenario.intervals + 1)
    expected[1 : len(arriving) + 1] = arriving
    return expected[: scenario.intervals]
