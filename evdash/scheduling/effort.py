"""How hard solvers may try: their work decides, never a clock.

Work is the same on every machine, busy or not, and so is an answer that a limit of work cuts
short.
"""

from math import inf
from typing import Any, Self

AT_ROOT = 10
"""How much longer a linear program of the root takes than one of a node, about."""
ITERATIONS = 20
"""Simplex iterations that take as long as a linear program of a node, about."""


class Effort:
    """Work that may be spent, and whether a search was cut short within it.

    Work is counted in linear programs solved times columns of the model, as one takes the
    longer the larger the model: 0.3 to 5 s of a processor for a million. Parts of an effort draw
    on the whole.
    """

    def __init__(self, work: float = inf, *, whole: "Effort | None" = None) -> None:
        self._work, self._whole = work, whole
        self.cut_short = False
        """Whether a search ended before it had proven its answer."""
        self.left_behind = False
        """Whether a solver did not come back, so that nothing more is asked."""

    @property
    def work(self) -> float:
        """What may still be spent, never below 0."""
        mine = 0.0 if self.left_behind else max(0.0, self._work)
        return mine if self._whole is None else min(mine, self._whole.work)

    @property
    def is_spent(self) -> bool:
        """Whether nothing more can be asked."""
        return self.work <= 0

    def part(self, share: float) -> Self:
        """A share of what is left."""
        return type(self)(share * self.work, whole=self)

    def spend(self, work: float) -> None:
        """Take note of work done."""
        self._work -= work
        if self._whole is not None:
            self._whole.spend(work)

    def cut(self) -> None:
        """Take note of a search that ended too soon."""
        self.cut_short = True
        if self._whole is not None:
            self._whole.cut()

    def leave_behind(self) -> None:
        """Take note of a solver that did not come back: whatever asked it may ask no other."""
        self.cut_short = self.left_behind = True
        if self._whole is not None:
            self._whole.leave_behind()


class Meter:
    """Ends one branch and bound of HiGHS as its effort is spent.

    HiGHS calls it back (its callback "MIP interrupt") whenever it checks its own limits, about
    once for every linear program it solves; that is counted, as it is the same on every machine.
    Its own limits do not serve: one on nodes leaves out the root, one on iterations holds for
    each linear program alone.
    """

    def __init__(self, effort: Effort, columns: int) -> None:
        self._effort, self._columns = effort, max(1, columns)
        self._most, self._programs = effort.work / self._columns, 0

    def __call__(self, _kind: Any, _text: str, told: Any, answer: Any, _data: Any) -> None:
        self._programs += AT_ROOT if told.mip_node_count == 0 else 1
        answer.user_interrupt = self._programs > self._most

    def settle(self) -> None:
        """Spend what was counted."""
        self._effort.spend(self._columns * self._programs)
