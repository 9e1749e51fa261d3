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

MOST_SPLITS = 8
MOST_NEWCOMERS_SPLIT = 24
MANY_NEWCOMERS = 20
"""How often a gap that could not be ruled out is looked into: eight times, fewer where more than
three newcomers compete and each look takes longer, and where many do gaps are left open at once.
Numbers, not times, so that the answer is the same on every machine."""


@dataclass(frozen=True, slots=True)
class Found:
    """`steps`: an amount that admits while one step less does not; None if there is none.

    `least`: whether it is proven, to P1's cent, that no smaller amount admits (or none at all).
    """

    steps: int | None
    least: bool


@dataclass(slots=True)
class Ladder:
    """Amounts 0, 1, … steps of one change, of which 0 does not admit the vehicle.

    `single`: whether there can be but one threshold, as where P1 without the vehicle does not
    change with the amount. `unfit`: an amount known not to make room for it at all.
    """

    trials: Trials
    change: Callable[[int], Change]
    single: bool = False
    unfit: int = 0
    found: int | None = None
    gaps: list[tuple[int, int]] = field(default_factory=list)
    splits: int = 0

    def climb(self, start: int, most: int) -> Found:
        """From where the vehicle fits, by doubled strides from `start` until it is admitted.

        Then the gaps below are closed, the uppermost first.
        """
        # one threshold is soon found without asking where the vehicle begins to fit
        floor = 0 if self.single else self._most_not_fitting(most)
        if floor == most:
            return Found(None, least=True)
        refused, stride = floor, start
        tried = floor + 1 if floor else min(start, most)
        while not self._admits(tried):
            self.gaps.append((refused, tried))
            refused = tried
            if tried == most:
                return self._closed()
            tried, stride = min(tried + stride, most), 2 * stride
        self.found = tried
        self.gaps.append((refused, tried))
        return self._closed()

    def _most_not_fitting(self, most: int) -> int:
        """The largest amount with which the vehicle does not even fit beside the contracts."""
        if not self._cannot_fit(0):
            return 0
        below, above = min(self.unfit, most), most + 1
        if below < most and not self._cannot_fit(below + 1):
            return below
        while above - below > 1:
            middle = (below + above) // 2
            below, above = (middle, above) if self._cannot_fit(middle) else (below, middle)
        return below

    def _closed(self) -> Found:
        least = True
        while self.gaps:
            low, high = self.gaps.pop()
            if high - low < 2:
                continue
            if high != self.found:
                if self.single:
                    break
                if self._newcomers > MANY_NEWCOMERS:
                    least = False
                    break
                if self._ruled_out(0, high):
                    break  # and with it all gaps below
                if self._ruled_out(low, high):
                    continue
                if self.splits >= min(MOST_SPLITS, MOST_NEWCOMERS_SPLIT // self._newcomers):
                    least = False
                    continue
                self.splits += 1
            self._split(low, high)
        return Found(self.found, least)

    @property
    def _newcomers(self) -> int:
        return 1 + len(self.trials.others)

    def _split(self, low: int, high: int) -> None:
        middle = (low + high) // 2
        self.gaps.append((low, middle))
        if self._admits(middle):
            self.found = middle
        else:
            self.gaps.append((middle, high))

    def _admits(self, steps: int) -> bool:
        if self.single and self._cannot_fit(0) and self._cannot_fit(steps):
            return False  # a small problem proves what the whole one would
        return self.trials.admits(self.change(steps))

    def _cannot_fit(self, steps: int) -> bool:
        return self.trials.cannot_fit(self.change(steps))

    def _ruled_out(self, low: int, high: int) -> bool:
        """Whether nothing between two amounts can admit the vehicle, a tie within a cent apart."""
        return self.trials.none_between(self.change(low), self.change(high))
