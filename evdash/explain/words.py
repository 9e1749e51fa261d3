"""Times, elements and amounts as a sentence names them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime
from itertools import groupby

from evdash.domain.scenario import Scenario
from evdash.domain.words import counted as counted  # noqa: PLC0414 - ours, too
from evdash.explain.trials import Trials

CENTS = 100
SHOWN = 4


@dataclass(frozen=True, slots=True)
class Clock:
    """A scenario's intervals as times of the day on which `now` begins."""

    scenario: Scenario
    now: int

    def at(self, interval: int) -> str:
        """When an interval begins: `18:00`, on another day `02:00 on 16 Jul`."""
        moment = self.scenario.time_of(interval)
        return self._on_day(moment)

    def end(self, interval: int) -> str:
        """When an interval ends; the midnight that ends the day is 24:00."""
        moment = self.scenario.time_of(interval + 1)
        midnight = moment.hour == moment.minute == 0
        one_day = (moment.date() - self.scenario.time_of(self.now).date()).days == 1
        return "24:00" if midnight and one_day else self._on_day(moment)

    def span(self, first: int, last: int) -> str:
        """`from 18:00 to 20:00`, for intervals `first` to `last`."""
        begin, end = self.at(first), self.end(last)
        day = begin[5:]
        if day and end.endswith(day):
            begin = begin.removesuffix(day)
        return f"from {begin} to {end}"

    def spans(self, intervals: Iterable[int]) -> str:
        """Intervals as one or more spans: `from 18:00 to 20:00 and from 21:00 to 22:00`."""
        told = [self.span(*run) for run in runs(intervals)]
        return listed(told if len(told) <= SHOWN else [*told[:SHOWN], "other hours"])

    def lasting(self, intervals: int) -> str:
        """A number of intervals as time: `2 h`, `45 min`, `1 h 30 min`."""
        hours, minutes = divmod(intervals * self.scenario.interval_minutes, 60)
        told = [f"{hours} h"] * (hours > 0) + [f"{minutes} min"] * (minutes > 0)
        return " ".join(told) or "0 min"

    def _on_day(self, moment: datetime) -> str:
        today = moment.date() == self.scenario.time_of(self.now).date()
        return f"{moment:%H:%M}" if today else f"{moment:%H:%M} on {moment.day} {moment:%b}"


def clock_of(trials: Trials) -> Clock:
    """The clock of the day on which a vehicle asked."""
    scenario = trials.inputs.scenario
    return Clock(scenario, min(trials.snapshot.now, scenario.intervals - 1))


def runs(intervals: Iterable[int]) -> list[tuple[int, int]]:
    """Neighbouring intervals together: (first, last) of each run."""
    groups = groupby(enumerate(sorted(intervals)), key=lambda pair: pair[1] - pair[0])
    return [(run[0][1], run[-1][1]) for run in (list(group) for _, group in groups)]


def listed(items: Sequence[str], joint: str = "and") -> str:
    """`a`, `a and b`, `a, b and c`."""
    if len(items) < 2:
        return "".join(items)
    return f"{', '.join(items[:-1])} {joint} {items[-1]}"


def cents(usd: float) -> str:
    """`12.3 ¢`, with as many digits as matter."""
    return f"{usd * CENTS:.4g} ¢"
