"""Feeders that generate, and pandapower's own answer for every side of every rating."""

from collections.abc import Iterator
from dataclasses import dataclass

import networkx as nx
import numpy as np
from hypothesis import strategies as st

from evdash.domain.scenario import Scenario
from evdash.grid.acflow import build_network, solve_network
from evdash.grid.lindistflow import base_injections, with_station
from evdash.grid.radial import radial_feeder
from tests.builders import line, make_scenario, node, vehicle

WIDE = {"voltage_min_pu": 0.5, "voltage_max_pu": 1.5}
SHORT = {"r": 1e-4, "x": 1e-4}
"""Lines so short that AC and the linear model say nearly the same."""


def exporting(rated: str) -> Scenario:
    """800 kW of generation and 50 kW of load at the station's node; 300 kVA at the node or line."""
    at_node = 300.0 if rated == "node" else None
    return make_scenario(
        nodes=[
            node("s"),
            node("a", load_kw=50, load_kvar=0, generation_kw=800, rating_kva=at_node),
        ],
        lines=[line("s", "a", rating=300.0 if rated == "line" else None, **SHORT)],
        station={"chargers": 100, "max_kw": 20.0},
        vehicles=[vehicle(f"v{n}", 0.0, need_kwh=60.0, max_kw=20.0) for n in range(90)],
        price=[0.1] * 4,
        feeder=WIDE,
    )


@dataclass(frozen=True)
class Side:
    """One side of a rated element in one interval, kVA; nothing where nothing flows there."""

    element: str
    rating_kva: float
    powers: tuple[complex, ...]

    def there(self) -> list[complex]:
        return [power for power in self.powers if power.real >= 0]

    def over(self) -> float:
        return max((abs(s) - self.rating_kva for s in self.there()), default=0.0)

    def own_over(self, base: "Side") -> float:
        """Over by what flows there without the station; at an end where nothing does, by what is
        reactive alone."""
        own = [
            abs(before) if before.real >= 0 else abs(now.imag) if now.real >= 0 else 0.0
            for now, before in zip(self.powers, base.powers, strict=True)
        ]
        return max(0.0, max(own) - self.rating_kva)


class Referee:
    """Pandapower's answer for each interval: every side of every rating."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario, self.feeder = scenario, radial_feeder(scenario)
        self.net = build_network(scenario, self.feeder)
        source = scenario.feeder.source_node
        tree = nx.bfs_tree(nx.Graph([(x.from_node, x.to_node) for x in scenario.lines]), source)
        self.away = [tree.has_edge(x.from_node, x.to_node) for x in scenario.lines]

    def sides(self, interval: int, station_kw: float) -> Iterator[Side]:
        every = np.zeros(self.scenario.intervals)
        every[interval] = station_kw
        at = with_station(
            self.scenario, self.feeder, base_injections(self.scenario, self.feeder), every
        )
        active, reactive = at.active_kw[interval], at.reactive_kvar[interval]
        solve_network(self.net, active, reactive)
        found = self.net.res_line
        for row, x in enumerate(self.scenario.lines):
            into_from = 1000 * complex(found.p_from_mw[row], found.q_from_mvar[row])
            into_to = 1000 * complex(found.p_to_mw[row], found.q_to_mvar[row])
            ends = (into_from, -into_to) if self.away[row] else (into_to, -into_from)
            yield from self._both(f"line:{x.name}", x.rating_kva, ends)
        for i, name in enumerate(self.feeder.nodes):
            rating = next(n.rating_kva for n in self.scenario.nodes if n.node == name)
            yield from self._both(f"node:{name}", rating, (complex(-active[i], -reactive[i]),))

    def _both(self, element: str, rating: float | None, powers: tuple[complex, ...]):
        if rating is not None:
            yield Side(element, rating, powers)
            yield Side(f"{element}:export", rating, tuple(-s for s in powers))

    def worsened(self, interval: int, station_kw: float) -> dict[str, float]:
        """By how much the station worsens sides beyond their rating, kVA."""
        base = {side.element: side for side in self.sides(interval, 0.0)}
        worse = {
            side.element: side.over() - side.own_over(base[side.element])
            for side in self.sides(interval, station_kw)
            if side.there()
        }
        return {element: kva for element, kva in worse.items() if kva > 0}


@st.composite
def generating(draw: st.DrawFn) -> Scenario:
    """A chain with branches, generation at and below the station, ratings near what flows."""
    names = [f"n{i}" for i in range(draw(st.integers(2, 5)))]

    def number(low: float, high: float) -> float:
        return round(draw(st.floats(low, high)), 2)

    nodes = [node("s")] + [
        node(
            name,
            load_kw=number(0, 80),
            load_kvar=number(-60, 60),
            generation_kw=draw(st.sampled_from([0.0, number(0, 400), number(200, 800)])),
            rating_kva=draw(st.sampled_from([None, number(20, 300)])),
        )
        for name in names
    ]
    lines = []
    for i, name in enumerate(names):
        up = "s" if i == 0 else names[draw(st.integers(0, i - 1))]
        ends = (up, name) if draw(st.booleans()) else (name, up)
        rating = draw(st.sampled_from([None, number(20, 300)]))
        lines.append(line(*ends, r=number(0.01, 0.3), x=number(0.01, 0.3), rating=rating))
    return make_scenario(
        nodes=nodes,
        lines=lines,
        station={"node": draw(st.sampled_from(names))},
        price=[0.1] * 3,
        generation=[0.0, 0.6, 1.0],
        feeder=WIDE,
    )
