"""Where each node of a feeder is drawn: by its own coordinates, or else as a tree."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from evdash.domain.scenario import Scenario

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Layout:
    """A place for every node, and the way of every line from end to end.

    `order` names the nodes but the source, branch by branch from the source outward.
    """

    places: Mapping[str, Point]
    ways: tuple[tuple[Point, ...], ...]
    order: tuple[str, ...]
    is_given: bool


def layout_of(scenario: Scenario) -> Layout:
    """Coordinates of `nodes.csv` where every node has its own place, else a tree.

    The tree runs from the source on the left; of the branches at a node the longest goes
    straight on, the others get lines of their own below it.
    """
    tree = _tree(scenario)
    own = {
        node.node: (node.x, node.y)
        for node in scenario.nodes
        if node.x is not None and node.y is not None
    }
    is_given = len(own) == len(scenario.nodes) == len(set(own.values()))
    places: Mapping[str, Point] = own if is_given else tree
    ways = tuple(
        _straight(places, line.from_node, line.to_node)
        if is_given
        else _bent(places, line.from_node, line.to_node)
        for line in scenario.lines
    )
    source = scenario.feeder.source_node
    return Layout(places, ways, tuple(node for node in tree if node != source), is_given)


def middle_of(way: Sequence[Point]) -> Point:
    """The middle of a way's last, its own, stretch."""
    (x0, y0), (x1, y1) = way[-2:]
    return (x0 + x1) / 2, (y0 + y1) / 2


def _straight(places: Mapping[str, Point], one: str, other: str) -> tuple[Point, ...]:
    return places[one], places[other]


def _bent(places: Mapping[str, Point], one: str, other: str) -> tuple[Point, ...]:
    """Down from the node nearer to the source, then along."""
    near, far = sorted((places[one], places[other]))
    return (near, far) if near[1] == far[1] else (near, (near[0], far[1]), far)


def _tree(scenario: Scenario) -> dict[str, Point]:
    """Distance from the source in lines to the right, lines of branches downward."""
    children, order = _children(scenario)
    height: dict[str, int] = {}
    for node in reversed(order):
        height[node] = 1 + max((height[child] for child in children[node]), default=0)
    places: dict[str, Point] = {}
    rows = 0
    waiting: list[tuple[str, float, float | None]] = [(scenario.feeder.source_node, 0.0, 0.0)]
    while waiting:
        node, x, y = waiting.pop()
        if y is None:
            rows += 1
            y = -float(rows)
        places[node] = (x, y)
        longest_last = sorted(children[node], key=lambda child: height[child])
        for child in longest_last[:-1]:
            waiting.append((child, x + 1, None))
        for child in longest_last[-1:]:
            waiting.append((child, x + 1, y))
    return places


def _children(scenario: Scenario) -> tuple[dict[str, list[str]], list[str]]:
    """Who comes next on the way outward, and all nodes with their parents before them."""
    neighbours: dict[str, list[str]] = {node.node: [] for node in scenario.nodes}
    for line in scenario.lines:
        neighbours[line.from_node].append(line.to_node)
        neighbours[line.to_node].append(line.from_node)
    order = [scenario.feeder.source_node]
    seen = set(order)
    children: dict[str, list[str]] = {}
    for node in order:
        children[node] = [other for other in neighbours[node] if other not in seen]
        seen.update(children[node])
        order += children[node]
    return children, order
