"""The least amount of a change that admits a vehicle, on a grid, where admission may come and go.

More headroom or chargers help competitors, too, so that P1 may admit a vehicle with 2 kW more,
refuse it with 5 and admit it again with 10. What rules a gap out is that the value of P1 with
the vehicle in cannot be less than with all the gap's more, nor without it more than with the
gap's least.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

from evdash.explain.changes import Change
from evdash.explain.trials import Trials
from evdash.scheduling.problem import OPTIMALITY_USD

MOST_SPLITS = 8
"""How often a gap that could not be ruled out is looked into; a number, not a time."""


@dataclass(frozen=True, slots=True)
class Found:
    """`steps`: an amount that admits while one step less does not; None if there is none.

    `least`: whether it is proven, to P1's cent, that no smaller amount admits (or none at all).
    """

    steps: int | None
    least: bool


@dataclass(slots=True)
class Ladder:
    """Amounts 0, 1, … steps of one change, of which 0 does not admit the vehicle."""

    trials: Trials
    change: Callable[[int], Change]
    found: int | None = None
    gaps: list[tuple[int, int]] = field(default_factory=list)
    splits: int = 0

    def climb(self, start: int, most: int) -> Found:
        """Double from `start` until admitted, then close the gaps below, the uppermost first."""
        refused, tried = 0, min(start, most)
        while not self._admits(tried):
            self.gaps.append((refused, tried))
            refused = tried
            if tried >= most:
                return Found(*self._closed())
            tried = min(2 * tried, most)
        self.found = tried
        self.gaps.append((refused, tried))
        return Found(*self._closed())

    def _closed(self) -> tuple[int | None, bool]:
        least = True
        while self.gaps:
            low, high = self.gaps.pop()
            if high - low < 2 or self._ruled_out(low, high):
                continue
            if high != self.found and self._ruled_out(0, high):
                break
            if high != self.found and self.splits >= MOST_SPLITS:
                least = False
                continue
            self.splits += high != self.found
            self._split(low, high)
        return self.found, least

    def _split(self, low: int, high: int) -> None:
        middle = (low + high) // 2
        self.gaps.append((low, middle))
        if self._admits(middle):
            self.found = middle
        else:
            self.gaps.append((middle, high))

    def _admits(self, steps: int) -> bool:
        return self.trials.admits(self.change(steps))

    def _ruled_out(self, low: int, high: int) -> bool:
        """Whether nothing between two amounts can admit the vehicle, a tie within a cent apart."""
        if high == self.found:
            return False
        without = self.trials.cost(self.change(low))
        return self.trials.bound_with(self.change(high)) >= without - OPTIMALITY_USD
