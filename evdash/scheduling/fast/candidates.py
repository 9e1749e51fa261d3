"""The choices of contracts that could be best, listed, each with a bound on what it costs.

A candidate says of every request in doubt whether it is admitted. Inequalities in u alone tell
most apart from the best without any LP: rows of the program that hold no other variable, such as
those by deadlines, and prices that LPs already solved put on every other candidate. Candidates
are listed request by request, and a part of one is dropped as soon as no completion can be
possible and cheap. What is left over is short, even where 2ⁿ is not.
"""

from dataclasses import dataclass

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.fast.branch import HAIR_USD
from evdash.scheduling.fast.relaxation import Relaxation
from evdash.scheduling.highs import Indices, LpPoint
from evdash.scheduling.problem import Bools

MOST = 100_000
"""A list may not grow longer than this."""
ROOM = 1e-6
"""Keeps rounding from ruling out a candidate that fills a row to the last bit."""


@dataclass(frozen=True, slots=True)
class Knapsacks:
    """Rows weight·x ≤ room that every possible candidate x keeps, beside the contracts.

    Shapes: weight (rows, requests), at least 0; room (rows,).
    """

    weight: Floats
    room: Floats


def knapsacks_of(relaxation: Relaxation, doubt: Indices) -> Knapsacks:
    """The program's rows over u alone, for the requests in doubt."""
    program, u = relaxation.program, relaxation.columns.u
    others = program.matrix[:, : u[0]].getnnz(axis=1)
    rows = np.flatnonzero((others == 0) & np.isneginf(program.row_lower))
    weight = program.matrix[rows][:, u].toarray()
    room = program.row_upper[rows] - weight @ program.lower[u]
    return Knapsacks(weight[:, doubt], room + ROOM)


@dataclass(slots=True)
class Prices:
    """What LPs already solved say of any candidate x: cost ≥ offset + slope·x, $.

    An LP's duals stay feasible whatever the bounds on u, so that its reduced costs price every
    u: the optimality cuts of Benders' method. Shapes: slope (LPs, requests), offset (LPs,).
    """

    slope: Floats
    offset: Floats

    def learn(self, x: Floats, point: LpPoint, reduced_cost: Floats) -> None:
        """Take in an LP's optimum: its x and their reduced costs, (requests,)."""
        self.slope = np.vstack([self.slope, reduced_cost])
        self.offset = np.append(self.offset, point.objective - float(reduced_cost @ x))

    def latest(self, x: Bools) -> Floats:
        """What the LP learned last says of candidates x (candidates, requests)."""
        return np.asarray(x @ self.slope[-1] + self.offset[-1])


@dataclass(slots=True)
class Candidates:
    """`x` (candidates, requests), `bound` (candidates,): none is cheaper than its, $."""

    x: Bools
    bound: Floats

    def keep(self, which: Bools) -> None:
        """Forget all but these."""
        self.x, self.bound = self.x[which], self.bound[which]

    def lift(self, which: Bools, bound: float) -> None:
        """None of these is cheaper than this, $."""
        self.bound[which] = np.maximum(self.bound[which], bound)

    def first(self, near: Floats) -> int:
        """The one of lowest bound; of equals the nearest to `near` (requests,)."""
        lowest = np.flatnonzero(self.bound <= self.bound.min() + HAIR_USD)
        return int(lowest[np.abs(self.x[lowest] - near).sum(axis=1).argmin()])

    def admitting(self, requests: Bools) -> Bools:
        """Which of them, (candidates,), admit all of these requests (requests,)."""
        return np.asarray(self.x[:, requests].all(axis=1))


def listed(prices: Prices, knapsacks: Knapsacks, below: float) -> Candidates | None:
    """All candidates that keep the rows, priced below `below`, $; None if they are too many."""
    order = np.lexsort([-knapsacks.weight.sum(axis=0), -np.abs(prices.slope).max(axis=0)])
    slope, weight = prices.slope[:, order], knapsacks.weight[:, order]
    # the least that what is still to be chosen can add
    rest = np.cumsum(np.minimum(slope, 0.0)[:, ::-1], axis=1)[:, ::-1]
    rest = np.append(rest, np.zeros((len(slope), 1)), axis=1)
    priced, filled = prices.offset[:, None], np.zeros((len(weight), 1))
    kept: list[Indices] = []
    for n in range(len(order)):
        # first those without request n, then the same with it
        priced = np.concatenate([priced, priced + slope[:, n, None]], axis=1)
        filled = np.concatenate([filled, filled + weight[:, n, None]], axis=1)
        possible = (filled <= knapsacks.room[:, None]).all(axis=0)
        keep = np.flatnonzero(possible & ((priced + rest[:, n + 1, None]).max(axis=0) < below))
        if len(keep) > MOST:
            return None
        priced, filled = priced[:, keep], filled[:, keep]
        kept.append(keep)
    candidates = Candidates(_decoded(kept, order), priced.max(axis=0))
    candidates.keep(candidates.bound < below)
    return candidates


def _decoded(kept: list[Indices], order: Indices) -> Bools:
    """The candidates from what was kept at each request, the last first."""
    lengths = [1, *map(len, kept)]
    x = np.zeros((lengths[-1], len(order)), dtype=bool)
    at = np.arange(lengths[-1])
    for n in range(len(order) - 1, -1, -1):
        at = kept[n][at]
        x[:, order[n]] = at >= lengths[n]
        at = at % max(1, lengths[n])
    return x
