"""How hard solvers may try in one step: their work decides, the clock is the last safety.

Work is the same on every machine, and so is an answer that a limit of work cuts short.
"""

import time
from math import inf
from typing import Self


class Effort:
    """Work and seconds that may be spent, and whether a search was cut short within them.

    Work is counted in linear programs solved times columns of the model, as one takes the
    longer the larger the model. Parts of an effort draw on the whole.
    """

    def __init__(
        self, work: float = inf, seconds: float = inf, *, whole: "Effort | None" = None
    ) -> None:
        self._work, self._ends, self._whole = work, time.perf_counter() + seconds, whole
        self.cut_short = False
        """Whether a search ended before it had proven its answer."""
        self.by_clock = False
        """Whether the clock ended one: a faster machine may have answered otherwise."""

    @property
    def work(self) -> float:
        """What may still be spent, never below 0."""
        mine = max(0.0, self._work)
        return mine if self._whole is None else min(mine, self._whole.work)

    @property
    def seconds(self) -> float:
        """What is left on the clock, never below 0."""
        mine = max(0.0, self._ends - time.perf_counter())
        return mine if self._whole is None else min(mine, self._whole.seconds)

    @property
    def is_spent(self) -> bool:
        """Whether nothing more can be asked."""
        return self.work <= 0 or self.seconds <= 0

    def part(self, share: float) -> Self:
        """A share of what is left."""
        return type(self)(share * self.work, share * self.seconds, whole=self)

    def spend(self, work: float) -> None:
        """Take note of work done."""
        self._work -= work
        if self._whole is not None:
            self._whole.spend(work)

    def cut(self, *, by_clock: bool) -> None:
        """Take note of a search that ended too soon."""
        self.cut_short = True
        self.by_clock = self.by_clock or by_clock
        if self._whole is not None:
            self._whole.cut(by_clock=by_clock)
