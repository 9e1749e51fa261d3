"""The search over contracts: lowest bound first, every choice of contracts scheduled exactly.

A node is a set of choices u, given by bounds on u; its LP has D continuous and finds vehicle
cuts of its own. Where the LP's u is whole, recourse decides what these very contracts cost, and
the node's other choices are split from it: so contracts that cannot be completed at the LP's
price are one leaf among few, and nothing has to branch over u and D at once. An LP is solved
when its node comes to be the lowest, warm from the last basis.
"""

import heapq
from dataclasses import dataclass, field, replace

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.fast.branch import HAIR_USD
from evdash.scheduling.fast.recourse import schedule_for
from evdash.scheduling.fast.search import Search, is_whole
from evdash.scheduling.highs import LpPoint

CUT_ROUNDS = 4
NODES, WORK = 300, 150_000
"""At most so many LPs, and so many LPs times pairs of vehicle and slot; then HiGHS takes over."""
LEAVES = 12


@dataclass(order=True, slots=True)
class Node:
    """Choices of contracts, lower ≤ u ≤ upper (vehicles,), none cheaper than `bound` in $.

    Of equal bounds the newest comes first. `point`: the LP's optimum once it is solved.
    """

    bound: float
    order: int
    lower: Floats = field(compare=False)
    upper: Floats = field(compare=False)
    point: LpPoint | None = field(default=None, compare=False)


@dataclass(slots=True)
class Duals:
    """What LPs already solved say of any other choice: cost(u) ≥ offset + slope·u, $.

    An LP's duals stay feasible whatever the bounds on u, so that its reduced costs price every
    u: the optimality cuts of Benders' method, looked up instead of solved.
    """

    slopes: Floats
    offsets: Floats
    count: int = 0

    def learn(self, u: Floats, reduced_cost: Floats, objective: float) -> None:
        """Take in an LP's optimum: u and its reduced costs, (vehicles,)."""
        self.slopes[self.count] = reduced_cost
        self.offsets[self.count] = objective - float(reduced_cost @ u)
        self.count += 1

    def bound(self, lower: Floats, upper: Floats) -> float:
        """No choice within lower ≤ u ≤ upper is cheaper, $."""
        slopes, offsets = self.slopes[: self.count], self.offsets[: self.count]
        least = offsets + np.maximum(slopes, 0) @ lower + np.minimum(slopes, 0) @ upper
        return float(least.max(initial=-np.inf))


@dataclass(slots=True)
class Tree:
    """The open nodes. `leaves_bound`: no choice of contracts already scheduled is cheaper, $."""

    search: Search
    duals: Duals
    opened: list[Node] = field(default_factory=list)
    leaves_bound: float = np.inf
    made: int = 0
    solved: int = 0
    leaves: int = 0

    @property
    def bound(self) -> float:
        """The least any choice of contracts costs, $."""
        lowest = self.opened[0].bound if self.opened else np.inf
        return min(lowest, self.leaves_bound, self.search.cost)

    @property
    def spent(self) -> bool:
        """Whether the limits are met, or a leaf's own cost stayed open and holds the bound."""
        return (
            self.solved >= NODES
            or self.solved * self.search.relaxation.columns.n_pairs >= WORK
            or self.leaves >= LEAVES
            or self.bound >= self.leaves_bound
            or self.search.out_of_time
        )

    def add(self, bound: float, lower: Floats, upper: Floats) -> None:
        """Open a node, unless nothing in it is cheaper than the best point."""
        self.put(Node(max(bound, self.duals.bound(lower, upper)), -self.made, lower, upper))

    def put(self, node: Node) -> None:
        """Keep a node for later, unless nothing in it is cheaper than the best point."""
        if node.bound < self.search.cost:
            self.made += 1
            heapq.heappush(self.opened, node)


def search_contracts(search: Search, root: LpPoint) -> None:
    """Branch over u until the best point is proven or the limits are met; lifts the bound."""
    at, program = search.relaxation.columns, search.relaxation.program
    lower, upper = program.lower[at.u], program.upper[at.u]
    tree = Tree(search, Duals(np.empty((NODES + 1, len(at.u))), np.empty(NODES + 1)))
    tree.duals.learn(root.values[at.u], root.reduced_cost[at.u], root.objective)
    tree.put(Node(root.objective, 0, lower, upper, root))
    # a request worth less than the cent of proof is still given a schedule
    while tree.opened and not tree.spent and not (search.proven and tree.leaves):
        node = heapq.heappop(tree.opened)
        if node.point is None:
            solve(tree, node)
        elif is_whole(node.point.values[at.u]):
            schedule(tree, node, node.point)
        else:
            split(tree, node, node.point)
        search.bound = max(search.bound, tree.bound)


def solve(tree: Tree, node: Node) -> None:
    """Solve a node's LP, and put the node back where it belongs by it."""
    search, at = tree.search, tree.search.relaxation.columns
    known = tree.duals.bound(node.lower, node.upper)
    if known > node.bound + HAIR_USD:
        tree.put(replace(node, bound=known))
        return
    search.session.bound(at.u, node.lower, node.upper)
    point = search.relaxed(CUT_ROUNDS)
    tree.solved += 1
    if point is not None:
        tree.duals.learn(point.values[at.u], point.reduced_cost[at.u], point.objective)
        tree.put(replace(node, bound=max(node.bound, point.objective), point=point))
    elif not search.session.infeasible:  # stopped, not disproven
        heapq.heappush(tree.opened, node)


def split(tree: Tree, node: Node, point: LpPoint) -> None:
    """Two nodes: the request most in doubt admitted, or refused."""
    u = point.values[tree.search.relaxation.columns.u]
    lower, upper = ruled_out(tree.search, node, point)
    n = int(np.abs(u - np.round(u)).argmax())
    for value in (1 - np.round(u[n]), np.round(u[n])):
        tree.add(node.bound, *with_choice(lower, upper, n, value))


def schedule(tree: Tree, node: Node, point: LpPoint) -> None:
    """Settle what the contracts of a whole point cost. Every other choice in the node becomes
    part of a node of its own, by the first request it decides otherwise."""
    search, at = tree.search, tree.search.relaxation.columns
    u, reduced = np.round(point.values[at.u]), point.reduced_cost[at.u]
    tree.leaves += 1
    tree.leaves_bound = min(tree.leaves_bound, schedule_for(search, u))
    lower, upper = ruled_out(search, node, point)
    dearer = np.maximum(0.0, np.where(u > 0.5, -reduced, reduced))
    free = np.flatnonzero(lower < upper)
    for n in free[np.argsort(-dearer[free], kind="stable")]:
        bound = max(node.bound, point.objective + dearer[n])
        tree.add(bound, *with_choice(lower, upper, n, 1 - u[n]))
        lower, upper = with_choice(lower, upper, n, u[n])


def with_choice(lower: Floats, upper: Floats, n: int, value: float) -> tuple[Floats, Floats]:
    """Bounds on u with request `n` decided."""
    lower, upper = lower.copy(), upper.copy()
    lower[n] = upper[n] = value
    return lower, upper


def ruled_out(search: Search, node: Node, point: LpPoint) -> tuple[Floats, Floats]:
    """The node's bounds on u, less what reduced costs make dearer than the best point."""
    reduced = point.reduced_cost[search.relaxation.columns.u]
    allowed = search.cost - point.objective
    free = node.lower < node.upper
    lower = np.where(free & (-reduced > allowed), 1.0, node.lower)
    return lower, np.where(free & (reduced > allowed), 0.0, node.upper)
