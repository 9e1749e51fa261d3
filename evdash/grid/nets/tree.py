"""The tree a network is when it is radial, and the place where it is not."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import networkx as nx

from evdash.errors import Fault
from evdash.grid.nets.branches import Branch, Connections, in_parallel
from evdash.grid.nets.records import Bus, Net


@dataclass(frozen=True, slots=True)
class Tree:
    """A radial network: `node_of` gives the bus that stands for each supplied bus.

    `source` is the node supplied at `source_vm_pu`; `branches` lead away from it, in an order in
    which every one begins where another has ended. `unsupplied` names what is left out.
    """

    source: int
    source_vm_pu: float
    node_of: Mapping[int, int]
    branches: tuple[Branch, ...]
    unsupplied: tuple[int, ...]


def radial_tree(
    net: Net, buses: Mapping[int, Bus], joined: Connections, source: str | None
) -> tuple[Tree | None, list[Fault]]:
    """The tree supplied from `source` (a bus by name or index; None where there is only one)."""
    node_of = _fused(buses, joined.fused)
    graph: nx.MultiGraph[Any] = nx.MultiGraph()
    graph.add_nodes_from(node_of.values())
    for branch in joined.branches:
        graph.add_edge(node_of[branch.from_bus], node_of[branch.to_bus], branch=branch)
    chosen, faults = _source(net, buses, node_of, graph, source)
    if chosen is None:
        return None, faults
    root, vm_pu = chosen
    reached = nx.node_connected_component(graph, root)
    faults += _loops(graph.subgraph(reached), root, buses)
    if faults:
        return None, faults
    branches = []
    for start, end in nx.bfs_edges(graph, root):
        along = [_from(data["branch"], node_of, start) for data in graph[start][end].values()]
        branches += list(in_parallel(along))
    unsupplied = tuple(bus for bus, node in node_of.items() if node not in reached)
    supplied = {bus: node for bus, node in node_of.items() if node in reached}
    return Tree(root, vm_pu, supplied, tuple(branches), unsupplied), []


def _fused(buses: Mapping[int, Bus], pairs: Iterable[tuple[int, int]]) -> dict[int, int]:
    """Each bus in service and the one that stands for it: the first of those that are one."""
    graph: nx.Graph[Any] = nx.Graph()
    graph.add_nodes_from(index for index, bus in buses.items() if bus.in_service)
    graph.add_edges_from(pairs)
    return {bus: min(group) for group in nx.connected_components(graph) for bus in group}


def _source(
    net: Net,
    buses: Mapping[int, Bus],
    node_of: Mapping[int, int],
    graph: "nx.MultiGraph[Any]",
    wanted: str | None,
) -> tuple[tuple[int, float] | None, list[Fault]]:
    """The node that supplies the feeder and its voltage."""
    supplies = [grid for grid in net.ext_grid if grid.in_service and grid.bus in node_of]
    if not supplies:
        rule = "should have an external grid in service, where the feeder is supplied"
        return None, [Fault("table ext_grid", "no row in service", rule)]
    named = {grid.told("ext_grid"): grid for grid in supplies}
    names = names_of([buses[bus] for bus in dict.fromkeys(grid.bus for grid in supplies)])
    listed = ", ".join(names.values())
    if wanted is not None:
        called = [buses[bus] for bus in names]
        chosen = {bus.index for bus in buses_called(wanted, called, names)}
        here = [grid for grid in supplies if grid.bus in chosen]
        if len({node_of[grid.bus] for grid in here}) != 1:
            told = f"{wanted!r}, which {len(chosen)} buses are called" if here else repr(wanted)
            rule = f"should be a bus with an external grid: {listed}"
            return None, [Fault("source", told, rule)]
    elif len({node_of[grid.bus] for grid in supplies}) > 1:
        rule = f"a feeder has one source; choose it by bus: {listed}"
        return None, [Fault("table ext_grid", f"{len(supplies)} supplies in service", rule)]
    else:
        here = supplies
    root = node_of[here[0].bus]
    reached = nx.node_connected_component(graph, root)
    beside = [
        told
        for told, grid in named.items()
        if node_of[grid.bus] in reached
        and (node_of[grid.bus] != root or grid.vm_pu != here[0].vm_pu)
    ]
    if beside:
        rule = f"a feeder is supplied at one node, here {label(buses[here[0].bus])}"
        return None, [Fault("table ext_grid", f"{', '.join(beside)} on the same feeder", rule)]
    return (root, here[0].vm_pu), []


def _loops(graph: Any, root: int, buses: Mapping[int, Bus]) -> list[Fault]:
    rule = (
        "a radial feeder has exactly one way from the source to every node: open a switch on it "
        "or take one of its lines out of service"
    )
    simple: nx.Graph[Any] = nx.Graph(graph)
    faults = [
        Fault(
            "a loop",
            " – ".join(label(buses[bus]) for bus in [*loop, loop[0]]),
            rule,
        )
        for loop in nx.cycle_basis(simple, root)
    ]
    for start, end in simple.edges:
        along = [data["branch"] for data in graph[start][end].values()]
        if start == end:
            faults.append(Fault(along[0].told, f"both ends at {label(buses[start])}", rule))
            continue
        ratios = {round(_lowered(branch), 9) for branch in along}
        if len(ratios) > 1:
            told = " and ".join(branch.told for branch in along)
            faults.append(
                Fault(told, "in parallel at different ratios", "should have the same ratio")
            )
    return faults


def _lowered(branch: Branch) -> float:
    """A branch's ratio as if it led from its lower-numbered bus."""
    return branch.ratio if branch.from_bus < branch.to_bus else 1 / branch.ratio


def _from(branch: Branch, node_of: Mapping[int, int], start: int) -> Branch:
    """The branch between nodes, leading away from `start`."""
    first, last = node_of[branch.from_bus], node_of[branch.to_bus]
    if first == start:
        return Branch(
            branch.told, first, last, branch.impedance_ohm, branch.ratio, branch.rating_kva
        )
    seen_from_first = branch.impedance_ohm / branch.ratio**2
    return Branch(branch.told, last, first, seen_from_first, 1 / branch.ratio, branch.rating_kva)


def label(bus: Bus) -> str:
    """A bus as a person finds it: its name, or its index where it has none."""
    return bus.name or f"bus {bus.index}"


def buses_called(wanted: str, buses: Sequence[Bus], names: Mapping[int, str]) -> list[Bus]:
    """The buses a person may mean: by index, else by the name they have here, else by the file's.

    More than one where the file calls several the same.
    """
    text = wanted.strip()
    for called in (
        lambda bus: {str(bus.index)},
        lambda bus: {names.get(bus.index)},
        lambda bus: {label(bus).strip(), f"bus {bus.index}"},
    ):
        if found := [bus for bus in buses if text in called(bus)]:
            return found
    return []


def names_of(buses: Sequence[Bus]) -> dict[int, str]:
    """A name for every bus that a scenario allows, by index.

    Its own where it is text beginning with a letter or digit, of at most 60 characters and no
    other bus's; else `bus 12`, or `Name (12)` where it is another's too.
    """
    longest = 60
    taken = Counter((bus.name or "").strip() for bus in buses)
    given: dict[int, str] = {}
    for bus in buses:
        name = (bus.name or "").strip()
        fit = name and (name[0].isalnum() or name[0] == "_") and name.isprintable()
        if not fit:
            name = f"bus {bus.index}"
        elif taken[name] > 1:
            name = f"{name} ({bus.index})"
        if len(name) > longest:
            name = f"bus {bus.index}"
        given[bus.index] = name
    repeated = {name for name, count in Counter(given.values()).items() if count > 1}
    return {i: f"bus {i} of the file" if name in repeated else name for i, name in given.items()}
