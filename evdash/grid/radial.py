"""Topology of a radial feeder: one way, and only one, from the source to every node."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evdash.domain.elements import Element
from evdash.domain.limits import Floats
from evdash.domain.scenario import Line, Node, Scenario

KW_PER_MW = 1000.0


@dataclass(frozen=True, slots=True)
class RadialFeeder:
    """A radial feeder as arrays. Nodes are all but the source, in the order of `nodes.csv`.

    `on_way[i, l]` is true where line l lies on the way from the source to node i, and
    `starts_at_source[l]` where its from_node is the end nearer to the source. Shapes: on_way
    (nodes, lines); the others (lines,), line_rating_kva with inf for none.
    """

    nodes: tuple[str, ...]
    lines: tuple[Element, ...]
    on_way: NDArray[np.bool_]
    starts_at_source: NDArray[np.bool_]
    r_pu: Floats
    x_pu: Floats
    line_rating_kva: Floats

    def node_index(self, node: str) -> int:
        return self.nodes.index(node)

    def nearest_rated_line(self, node: str) -> int | None:
        """The rated line nearest to a node on its way to the source; None if there is none.

        Of the lines on one way, the nearer to the node the fewer nodes lie beyond it.
        """
        rated = np.flatnonzero(
            self.on_way[self.node_index(node)] & np.isfinite(self.line_rating_kva)
        )
        if not len(rated):
            return None
        return int(rated[int(self.on_way[:, rated].sum(axis=0).argmin())])


def topology_problems(
    nodes: Sequence[Node], lines: Sequence[Line], source: str
) -> Iterator[tuple[int | None, str, str]]:
    """What keeps a network from being radial: (row of `lines` or None, found, allowed)."""
    rule = "a radial feeder has exactly one way from the source to every node"
    edges: dict[frozenset[str], int] = {}
    for row, line in enumerate(lines):
        ends = frozenset((line.from_node, line.to_node))
        if len(ends) == 1:
            yield row, f"a line from {line.from_node} to itself", rule
        elif ends in edges:
            yield row, f"a second line between {line.from_node} and {line.to_node}", rule
        else:
            edges[ends] = row
    reached = {source, *(child for _, child in _outward(edges, source))}
    if len(reached) == len(nodes) == len(edges) + 1:
        return
    import networkx as nx  # only a feeder that is not radial needs it

    graph: nx.Graph[Any] = nx.Graph()
    graph.add_nodes_from(node.node for node in nodes)
    graph.add_edges_from((min(ends), max(ends)) for ends in edges)
    for loop in nx.cycle_basis(graph, source):
        row = max(edges[frozenset(ends)] for ends in zip(loop, loop[1:] + loop[:1], strict=True))
        yield row, f"a loop {' – '.join([*loop, loop[0]])}", rule
    unreached = [node.node for node in nodes if node.node not in reached]
    if unreached:
        yield None, f"nodes without a way to the source {source}: {', '.join(unreached)}", rule


def _outward(edges: Iterable[frozenset[str]], source: str) -> Iterator[tuple[str, str]]:
    """Every node that can be reached after the one it is reached from, the nearest first."""
    neighbours: dict[str, list[str]] = defaultdict(list)
    for start, end in edges:
        neighbours[start].append(end)
        neighbours[end].append(start)
    reached, seen = [source], {source}
    for node in reached:
        for beyond in neighbours[node]:
            if beyond not in seen:
                seen.add(beyond)
                reached.append(beyond)
                yield node, beyond


def radial_feeder(scenario: Scenario) -> RadialFeeder:
    """The topology and per-unit impedances of a valid scenario's feeder."""
    source = scenario.feeder.source_node
    names = tuple(node.node for node in scenario.nodes if node.node != source)
    index = {name: i for i, name in enumerate(names)}
    edges = {
        frozenset((line.from_node, line.to_node)): row for row, line in enumerate(scenario.lines)
    }
    on_way = np.zeros((len(names), len(scenario.lines)), dtype=bool)
    starts_at_source = np.zeros(len(scenario.lines), dtype=bool)
    for parent, child in _outward(edges, source):
        row = edges[frozenset((parent, child))]
        starts_at_source[row] = scenario.lines[row].from_node == parent
        if parent != source:
            on_way[index[child]] = on_way[index[parent]]
        on_way[index[child], row] = True
    base_ohm = scenario.feeder.base_kv**2 / scenario.feeder.base_mva
    return RadialFeeder(
        nodes=names,
        lines=tuple(line.element for line in scenario.lines),
        on_way=on_way,
        starts_at_source=starts_at_source,
        r_pu=np.array([line.r_ohm for line in scenario.lines]) / base_ohm,
        x_pu=np.array([line.x_ohm for line in scenario.lines]) / base_ohm,
        line_rating_kva=np.array(
            [np.inf if line.rating_kva is None else line.rating_kva for line in scenario.lines]
        ),
    )
