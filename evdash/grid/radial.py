"""Topology of a radial feeder: one way, and only one, from the source to every node."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import networkx as nx
import numpy as np
from numpy.typing import NDArray

from evdash.domain.limits import Floats
from evdash.domain.scenario import Line, Node, Scenario

KW_PER_MW = 1000.0


@dataclass(frozen=True, slots=True)
class RadialFeeder:
    """A radial feeder as arrays. Nodes are all but the source, in the order of `nodes.csv`.

    `on_way[i, l]` is true where line l lies on the way from the source to node i. Shapes:
    on_way (nodes, lines), r_pu and x_pu (lines,), rating_kva (lines,) with inf for none.
    """

    nodes: tuple[str, ...]
    lines: tuple[str, ...]
    on_way: NDArray[np.bool_]
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
    graph: nx.Graph[Any] = nx.Graph()
    graph.add_nodes_from(node.node for node in nodes)
    for row, line in enumerate(lines):
        if line.from_node == line.to_node:
            yield row, f"a line from {line.from_node} to itself", rule
        elif graph.has_edge(line.from_node, line.to_node):
            yield row, f"a second line between {line.from_node} and {line.to_node}", rule
        else:
            graph.add_edge(line.from_node, line.to_node, row=row)
    for loop in nx.cycle_basis(graph, source):
        row = max(graph.edges[a, b]["row"] for a, b in zip(loop, loop[1:] + loop[:1], strict=True))
        yield row, f"a loop {' – '.join([*loop, loop[0]])}", rule
    unreached = set(graph) - nx.node_connected_component(graph, source)
    if unreached:
        named = ", ".join(node.node for node in nodes if node.node in unreached)
        yield None, f"nodes without a way to the source {source}: {named}", rule


def radial_feeder(scenario: Scenario) -> RadialFeeder:
    """The topology and per-unit impedances of a valid scenario's feeder."""
    source = scenario.feeder.source_node
    names = tuple(node.node for node in scenario.nodes if node.node != source)
    index = {name: i for i, name in enumerate(names)}
    graph: nx.Graph[Any] = nx.Graph()
    for row, line in enumerate(scenario.lines):
        graph.add_edge(line.from_node, line.to_node, row=row)
    on_way = np.zeros((len(names), len(scenario.lines)), dtype=bool)
    for parent, child in nx.bfs_edges(graph, source):
        if parent != source:
            on_way[index[child]] = on_way[index[parent]]
        on_way[index[child], graph.edges[parent, child]["row"]] = True
    base_ohm = scenario.feeder.base_kv**2 / scenario.feeder.base_mva
    return RadialFeeder(
        nodes=names,
        lines=tuple(line.name for line in scenario.lines),
        on_way=on_way,
        r_pu=np.array([line.r_ohm for line in scenario.lines]) / base_ohm,
        x_pu=np.array([line.x_ohm for line in scenario.lines]) / base_ohm,
        line_rating_kva=np.array(
            [np.inf if line.rating_kva is None else line.rating_kva for line in scenario.lines]
        ),
    )
