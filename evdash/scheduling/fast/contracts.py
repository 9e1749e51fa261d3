"""The search over contracts: of all candidates listed, the lowest bound first, scheduled exactly.

The LP with u fixed to a candidate either is infeasible, and with it every candidate that admits
still more; or its duals price all other candidates as well. So the few LPs solved lift the bounds
of the whole list, until the lowest is a candidate whose LP is solved: what that costs, the search
for its schedule decides. This is Benders' method, its master a list.
"""

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.fast.branch import HAIR_USD, by_guessing
from evdash.scheduling.fast.candidates import Candidates, Prices, knapsacks_of, listed
from evdash.scheduling.fast.schedules import completed
from evdash.scheduling.fast.search import CUT_ROUNDS, Search, is_whole
from evdash.scheduling.highs import LpPoint
from evdash.scheduling.problem import Bools

GUESSES_USD = (0.1, 0.4, 1.6, 6.4, np.inf)
"""How far above the LP the best candidate is looked for, one after the other."""
LPS, LEAVES = 200, 12


def search_contracts(search: Search, root: LpPoint) -> None:
    """Schedule candidates until the best point is proven or the limits are met; lifts the bound."""
    contracts = ContractSearch(search, root)
    if is_whole(contracts.near):
        alone = Candidates(contracts.near[None] > 0.5, np.array([root.objective]))
        contracts.settle(alone, 0)
        if search.proven:
            return
    bound = by_guessing(root.objective, GUESSES_USD, lambda: search.cost, contracts.cheapest)
    search.bound = max(search.bound, bound)


class ContractSearch:
    """What is known of candidates, each (in doubt,): which of the requests in doubt are admitted.

    `near` (in doubt,) is u of the first LP, for choosing between equals. `prices` and `impossible`,
    candidates without any schedule, bear on every list; `settled` is what those already
    scheduled cost at least, $. A list, `Candidates`, is shortened as its bounds rise.
    """

    def __init__(self, search: Search, root: LpPoint) -> None:
        at, program = search.relaxation.columns, search.relaxation.program
        self.search = search
        self.lowest_u, highest_u = program.lower[at.u], program.upper[at.u]
        self.requests = np.flatnonzero(self.lowest_u < highest_u)
        self.near = root.values[at.u[self.requests]]
        self.knapsacks = knapsacks_of(search.relaxation, self.requests)
        self.prices = Prices(np.empty((0, len(self.requests))), np.empty(0))
        self.impossible: list[Bools] = []
        self.settled: dict[bytes, float] = {}
        self.lps = 0
        self._price(root)

    @property
    def is_spent(self) -> bool:
        """Whether the limits are met."""
        return self.lps >= LPS or len(self.settled) >= LEAVES or self.search.effort.is_spent

    def cheapest(self, below: float) -> float:
        """List what may cost less than `below`, $, and settle the lowest until no other can be.

        What no candidate costs less than, $; −inf where they are too many to be listed.
        """
        candidates = listed(self.prices, self.knapsacks, below)
        if candidates is None:
            return -np.inf
        self._apply_what_is_known(candidates)
        while True:
            candidates.keep(candidates.bound < min(below, self.search.cost))
            if not len(candidates.bound):
                return min(below, self.search.cost)
            n = candidates.first(self.near)
            lowest = float(candidates.bound[n])
            self.search.bound = max(self.search.bound, lowest)
            # a request worth less than the cent of proof is still given a schedule
            proven = self.search.proven and len(self.settled) > 0
            if proven or self.is_spent or candidates.x[n].tobytes() in self.settled:
                return lowest
            self.settle(candidates, n)

    def settle(self, candidates: Candidates, n: int) -> None:
        """Lift all bounds by the LP of a candidate; if it is the lowest even so, schedule it."""
        u = self._u_of(candidates.x[n])
        point = self._point_of_lowest(candidates, n, u)
        if point is not None:
            candidates.bound[n] = max(candidates.bound[n], completed(self.search, u, point))
            self.settled[candidates.x[n].tobytes()] = float(candidates.bound[n])

    def _apply_what_is_known(self, candidates: Candidates) -> None:
        for x in self.impossible:
            candidates.keep(~candidates.admitting(x))
        for key, bound in self.settled.items():
            candidates.lift((candidates.x == np.frombuffer(key, dtype=bool)).all(axis=1), bound)

    def _point_of_lowest(self, candidates: Candidates, n: int, u: Floats) -> LpPoint | None:
        """The LP of a candidate; None if it turns out not to be the lowest.

        Cuts are looked for only once it is the lowest without them: others need no exact price.
        """
        point = None
        for cut_rounds in (0, CUT_ROUNDS):
            point = self._learn(candidates, u, u, cut_rounds)
            if point is None:
                if self.search.session.infeasible:
                    self.impossible.append(candidates.x[n])
                    candidates.lift(candidates.admitting(candidates.x[n]), np.inf)
                # what is best while admitting nobody else says what stands in the way
                self._learn(candidates, self.lowest_u, u, 0)
                return None
            if candidates.bound[n] > candidates.bound.min() + HAIR_USD:
                return None
        return point

    def _learn(
        self, candidates: Candidates, lower: Floats, upper: Floats, cut_rounds: int
    ) -> LpPoint | None:
        """The LP over lower ≤ u ≤ upper, (vehicles,); its duals lift all bounds."""
        self.lps += 1
        point = self.search.relaxed(lower, upper, cut_rounds)
        if point is not None:
            self._price(point)
            candidates.bound = np.maximum(candidates.bound, self.prices.latest(candidates.x))
        return point

    def _price(self, point: LpPoint) -> None:
        """Price all candidates by an LP's duals."""
        u = self.search.relaxation.columns.u[self.requests]
        self.prices.learn(point.values[u], point, point.reduced_cost[u])

    def _u_of(self, x: Bools) -> Floats:
        """u of a candidate, (vehicles,)."""
        u = self.lowest_u.copy()
        u[self.requests] = x
        return u
