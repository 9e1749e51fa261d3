"""Times, elements and amounts as a sentence names them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime
from itertools import groupby

from evdash.domain.scenario import Scenario
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


def counted(number: int, one: str) -> str:
    """`1 charger`, `3 chargers`."""
    return f"{number} {one if number == 1 else one + 's'}"


def money(usd: float) -> str:
    """`$1.20`, `-$0.35`; less than a cent is told as such."""
    if 0 < abs(usd) < 0.005:
        return "less than a cent"
    return f"{'-' if usd < 0 else ''}${abs(usd):,.2f}"


def cents(usd: float) -> str:
    """`12.3 ¢`, with as many digits as matter."""
    return f"{usd * CENTS:.4g} ¢"


def element_words(element: str, scenario: Scenario) -> str:
    """A binding element as a person names it: `line or transformer 633-634 (500 kVA)`."""
    kind, _, name = element.partition(":")
    limits = scenario.feeder
    if kind == "voltage_min":
        return f"the lowest voltage allowed at node {name} ({limits.voltage_min_pu:g} pu)"
    if kind == "voltage_max":
        return f"the highest voltage allowed at node {name} ({limits.voltage_max_pu:g} pu)"
    if kind == "power_flow":
        return f"the power flow, which has no solution with more power at node {name},"
    if kind == "node":
        rating = next((n.rating_kva for n in scenario.nodes if n.node == name), None)
        return f"the rating of node {name} ({rating or 0:g} kVA)"
    rating = next((line.rating_kva for line in scenario.lines if line.name == name), None)
    return f"line or transformer {name} ({rating or 0:g} kVA)" if kind == "line" else element
