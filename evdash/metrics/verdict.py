"""What the network models say of a day: which limits are exceeded, by how much, by whose doing.

Whatever is told of limits is told from here: the head of the page and its pictures, the race, the
report and the command line. A `ModelVerdict` is data; `metrics.verdict_words` has the sentences.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

from evdash.domain.breach import Breach
from evdash.domain.elements import Element
from evdash.domain.trace import Network
from evdash.metrics.ac import AcPoint

Cause = Literal["station", "both", "feeder"]
LINEARISED: Network = "lindistflow"
FULL_AC: Network = "ac"


@dataclass(frozen=True, slots=True)
class Violation:
    """One limit exceeded in some intervals for one cause; the worst of them is told.

    `cause`: "station", the limit holds without charging; "feeder", charging changes nothing or
    relieves it; "both", exceeded anyway and worsened by charging. Depths in `unit`.
    """

    element: Element
    unit: str
    cause: Cause
    intervals: tuple[int, ...]
    worst: int
    depth: float
    base_depth: float

    @property
    def by_charging(self) -> bool:
        """Whether charging causes or worsens it."""
        return self.cause != "feeder"


@dataclass(frozen=True, slots=True)
class ModelVerdict:
    """What one network model says of the limits in the intervals it `judged`, a count.

    `waiting` counts those it has yet to judge, `failures` has a reason for each of which it could
    say nothing: of neither a limit is called kept.
    """

    network: Network
    violations: tuple[Violation, ...]
    judged: int
    waiting: int = 0
    failures: tuple[str, ...] = ()

    @property
    def by_charging(self) -> tuple[Violation, ...]:
        """What charging causes or worsens."""
        return tuple(found for found in self.violations if found.by_charging)

    @property
    def by_feeder(self) -> tuple[Violation, ...]:
        """What the feeder does by itself."""
        return tuple(found for found in self.violations if not found.by_charging)

    @property
    def holds(self) -> bool:
        """Whether every limit is known to hold in every interval asked of."""
        known = self.judged and not self.waiting and not self.failures
        return bool(known) and not self.violations

    @property
    def intervals_by_charging(self) -> frozenset[int]:
        """Intervals in which charging exceeds a limit."""
        return frozenset(t for found in self.by_charging for t in found.intervals)


def verdict_of(network: Network, breaches: Iterable[Breach], judged: int) -> ModelVerdict:
    """The verdict of a model that judged every one of so many intervals."""
    return ModelVerdict(network, violations(breaches), judged)


def ac_verdict(found: Mapping[int, AcPoint], executed: int) -> ModelVerdict:
    """The verdict of AC power flow on so many intervals, of which it has `found` some."""
    breaches = [breach for t in sorted(found) for breach in found[t].breaches]
    failures = tuple(point.failure for _, point in sorted(found.items()) if not point.checked)
    judged, waiting = len(found) - len(failures), executed - len(found)
    return ModelVerdict(FULL_AC, violations(breaches), judged, waiting, failures)


def violations(breaches: Iterable[Breach]) -> tuple[Violation, ...]:
    """Breaches of one model put together by element and cause, the station's own first."""
    groups: dict[tuple[Element, Cause], list[Breach]] = {}
    for breach in breaches:
        groups.setdefault((breach.element, cause_of(breach)), []).append(breach)
    found = []
    for (element, cause), group in groups.items():
        worst = max(group, key=lambda breach: breach.depth)
        intervals = tuple(sorted({breach.interval for breach in group}))
        found.append(
            Violation(
                element=element,
                unit=worst.unit,
                cause=cause,
                intervals=intervals,
                worst=worst.interval,
                depth=worst.depth,
                base_depth=worst.base_depth,
            )
        )
    order = {"station": 0, "both": 1, "feeder": 2}
    return tuple(sorted(found, key=lambda v: (order[v.cause], -len(v.intervals), str(v.element))))


def cause_of(breach: Breach) -> Cause:
    """Whose doing it is that a limit is exceeded."""
    if not breach.by_station:
        return "feeder"
    return "both" if breach.base_depth > breach.tolerance else "station"
