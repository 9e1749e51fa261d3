"""The search over contracts: of all choices listed, the lowest bound first, scheduled exactly.

The LP with u fixed to a choice either is infeasible, and with it every choice that admits still
more; or its duals price all other choices as well. So the few LPs solved lift the bounds of the
whole list, until the lowest is a choice whose LP is solved: recourse decides what that choice
costs. This is Benders' method, its master a list.
"""

from dataclasses import dataclass, field

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.fast.branch import HAIR_USD, by_guessing
from evdash.scheduling.fast.choices import Choices, Knapsacks, Prices, knapsacks_of, listed
from evdash.scheduling.fast.recourse import completed
from evdash.scheduling.fast.search import CUT_ROUNDS, Search, is_whole
from evdash.scheduling.highs import Indices, LpPoint
from evdash.scheduling.problem import Bools

GUESSES_USD = (0.1, 0.4, 1.6, 6.4, np.inf)
"""How far above the LP the best choice is looked for, one after the other."""
LPS, LEAVES = 200, 12


@dataclass(slots=True)
class Doubt:
    """The requests in doubt and what is known of choices among them.

    `requests` (in doubt,): which they are; `firm` (vehicles,): u of the others. `near`: u of the
    first LP, for choosing between equals. `impossible`: choices whose LP is infeasible.
    `settled`: what choices already scheduled cost at least, $.
    """

    search: Search
    requests: Indices
    firm: Floats
    near: Floats
    knapsacks: Knapsacks
    prices: Prices
    impossible: list[Bools] = field(default_factory=list)
    settled: dict[bytes, float] = field(default_factory=dict)
    solved: int = 0

    @property
    def spent(self) -> bool:
        """Whether the limits are met."""
        return self.solved >= LPS or len(self.settled) >= LEAVES or self.search.effort.is_spent

    def with_choice(self, x: Bools) -> Floats:
        """u for a choice (in doubt,): shape (vehicles,)."""
        u = self.firm.copy()
        u[self.requests] = x
        return u

    def learn(self, point: LpPoint) -> None:
        """Price all choices by an LP's duals."""
        u = self.search.relaxation.columns.u[self.requests]
        self.prices.learn(point.values[u], point, point.reduced_cost[u])


def search_contracts(search: Search, root: LpPoint) -> None:
    """Schedule choices until the best point is proven or the limits are met; lifts the bound."""
    at, program = search.relaxation.columns, search.relaxation.program
    requests = np.flatnonzero(program.lower[at.u] < program.upper[at.u])
    doubt = Doubt(
        search,
        requests,
        firm=program.lower[at.u].copy(),
        near=root.values[at.u[requests]],
        knapsacks=knapsacks_of(search.relaxation, requests),
        prices=Prices(np.empty((0, len(requests))), np.empty(0)),
    )
    doubt.learn(root)
    if is_whole(doubt.near):
        settle(doubt, Choices(doubt.near[None] > 0.5, np.array([root.objective])), 0)
        if search.proven:
            return

    def attempt(below: float) -> float:
        choices = listed(doubt.prices, doubt.knapsacks, below)
        return -np.inf if choices is None else lowest_settled(doubt, choices, below)

    bound = by_guessing(root.objective, GUESSES_USD, lambda: search.cost, attempt)
    search.bound = max(search.bound, bound)


def lowest_settled(doubt: Doubt, choices: Choices, below: float) -> float:
    """Work through a list until its lowest choice is settled; none in it costs less than this, $.

    Choices that are not cheaper than `below` and the best point do not count.
    """
    search = doubt.search
    for x in doubt.impossible:
        choices.keep(~admits_all(choices.x, x))
    for key, bound in doubt.settled.items():
        same = (choices.x == np.frombuffer(key, dtype=bool)).all(axis=1)
        choices.bound[same] = np.maximum(choices.bound[same], bound)
    while True:
        choices.keep(choices.bound < min(below, search.cost))
        if not len(choices.bound):
            return min(below, search.cost)
        n = first_of(choices, doubt.near)
        lowest = float(choices.bound[n])
        search.bound = max(search.bound, lowest)
        # a request worth less than the cent of proof is still given a schedule
        proven = search.proven and len(doubt.settled) > 0
        if proven or doubt.spent or choices.x[n].tobytes() in doubt.settled:
            return lowest
        settle(doubt, choices, n)


def first_of(choices: Choices, near: Floats) -> int:
    """The choice of lowest bound; of equals the one nearest to the LP's u."""
    lowest = np.flatnonzero(choices.bound <= choices.bound.min() + HAIR_USD)
    return int(lowest[np.abs(choices.x[lowest] - near).sum(axis=1).argmin()])


def admits_all(x: Bools, requests: Bools) -> Bools:
    """Which choices (choices, in doubt) admit all of these requests (in doubt,)."""
    return np.asarray(x[:, requests].all(axis=1))


def settle(doubt: Doubt, choices: Choices, n: int) -> None:
    """Lift all bounds by the LP of a choice; if it is the lowest even so, schedule it."""
    point = priced(doubt, choices, n)
    if point is not None:
        u = doubt.with_choice(choices.x[n])
        choices.bound[n] = max(choices.bound[n], completed(doubt.search, u, point))
        doubt.settled[choices.x[n].tobytes()] = float(choices.bound[n])


def priced(doubt: Doubt, choices: Choices, n: int) -> LpPoint | None:
    """The LP of a choice; None if it turns out not to be the lowest.

    Cuts are looked for only once it is the lowest without them: others need no exact price.
    """
    u, point = doubt.with_choice(choices.x[n]), None
    for cut_rounds in (0, CUT_ROUNDS):
        point = relaxed_within(doubt, u, u, cut_rounds)
        if point is None:
            if doubt.search.session.infeasible:
                doubt.impossible.append(choices.x[n])
                choices.bound[admits_all(choices.x, choices.x[n])] = np.inf
            # what is best while admitting nobody else says what stands in the way
            learn(doubt, choices, relaxed_within(doubt, doubt.firm, u, 0))
            return None
        learn(doubt, choices, point)
        if choices.bound[n] > choices.bound.min() + HAIR_USD:
            return None
    return point


def learn(doubt: Doubt, choices: Choices, point: LpPoint | None) -> None:
    """Lift all bounds by an LP's duals."""
    if point is not None:
        doubt.learn(point)
        choices.bound = np.maximum(choices.bound, doubt.prices.latest(choices.x))


def relaxed_within(doubt: Doubt, lower: Floats, upper: Floats, cut_rounds: int) -> LpPoint | None:
    """The LP over lower ≤ u ≤ upper, (vehicles,)."""
    search = doubt.search
    search.session.bound(search.relaxation.columns.u, lower, upper)
    doubt.solved += 1
    return search.relaxed(cut_rounds)
