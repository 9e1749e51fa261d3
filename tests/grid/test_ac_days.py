"""Whole days under AC on feeders nobody tuned to, each kind of limit binding in turn.

Pandapower judges what was executed, and what two percent more headroom would have done.
"""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.ac_headroom import random_tree
from benchmarks.random_days import random_scenario
from evdash.domain.breach import Breach
from evdash.domain.scenario import Line, Scenario
from evdash.domain.trace import Trace
from evdash.files.overrides import edit_scenario
from evdash.grid.acbreaches import ac_breaches
from evdash.grid.acflow import AcNetwork, AcResult
from evdash.horizon.day import run_day, start_day
from evdash.metrics.records import executed_station_kw
from evdash.metrics.service import totals
from evdash.scheduling.p1 import p1_policy
from tests.builders import names

KINDS = {"voltage": "voltage_min", "line": "line", "transformer": "line", "connection": "node"}
"""Kinds of limits and what their elements are called."""
NODES = 30
ROOM_KW = 30.0
"""What the limit is to leave at the day's peak: less than the station's chargers could take."""
MOST_PU, MOST_SHARE = 1e-4, 1e-3
REACHED = 1 - 1e-3


def bare_tree(seed: int, kind: str) -> Scenario:
    """A random tree without any limit that binds; one of its rows may be a transformer."""
    wide = {"feeder.voltage_min_pu": 0.5, "feeder.voltage_max_pu": 1.1}
    day = edit_scenario(random_tree(seed, NODES), wide)
    between = len(way_to_station(day)) // 2
    if kind != "transformer":
        return with_lines(day, *(rated(line, None) for line in day.lines))
    transformer = way_to_station(day)[between]
    coil = transformer.model_copy(update={"r_ohm": 0.004, "x_ohm": 0.08})
    others = (rated(line, None) for line in day.lines if line.name != transformer.name)
    return with_lines(day, *others, rated(coil, None))


def limited_tree(bare: Scenario, network: AcNetwork, seed: int, kind: str) -> Scenario:
    """The tree with one limit of a kind, as far away as 30 kW of charging at the day's peak."""
    peak = np.array([bare.load_pu.argmax()])
    without, flow = (network.flow(bare, peak, np.array([kw])) for kw in (0.0, ROOM_KW))
    if kind == "voltage":
        moved = without.voltage_pu[0] - flow.voltage_pu[0] > 1e-7
        lowest_pu = float(flow.voltage_pu[0, moved].min())
        return edit_scenario(bare, {"feeder.voltage_min_pu": lowest_pu})
    if kind == "connection":
        own_kva = abs(flow.node_power[0, flow.nodes.index(bare.station.node)])
        return with_connection(bare, own_kva)
    way = way_to_station(bare)
    line = way[len(way) // 2] if kind == "transformer" else way[seed % len(way)]
    carried_kva = float(flow.line_kva[0, flow.lines.index(line.element)])
    return with_lines(bare, *(rated(x, carried_kva) if x == line else x for x in bare.lines))


def rated(line: Line, kva: float | None) -> Line:
    return line.model_copy(update={"rating_kva": kva})


def with_lines(scenario: Scenario, *lines: Line) -> Scenario:
    places = {line.name: place for place, line in enumerate(scenario.lines)}
    return scenario.replacing(lines=tuple(sorted(lines, key=lambda line: places[line.name])))


def with_connection(scenario: Scenario, kva: float) -> Scenario:
    station = scenario.station.node
    return scenario.replacing(
        nodes=tuple(
            node.model_copy(update={"rating_kva": kva}) if node.node == station else node
            for node in scenario.nodes
        )
    )


def way_to_station(scenario: Scenario) -> list[Line]:
    """Lines from the station up to the source."""
    into = {line.to_node: line for line in scenario.lines}
    way = [into[scenario.station.node]]
    while way[-1].from_node in into:
        way.append(into[way[-1].from_node])
    return way


class Judge:
    """Pandapower on one feeder, solved once without the station."""

    def __init__(self, scenario: Scenario, network: AcNetwork) -> None:
        self.scenario, self.network = scenario, network
        self.base = self.flow(np.arange(scenario.intervals), np.zeros(scenario.intervals))

    def flow(self, intervals: np.ndarray, station_kw: np.ndarray) -> AcResult:
        return self.network.flow(self.scenario, intervals, station_kw)

    def breaches(self, intervals: np.ndarray, station_kw: np.ndarray) -> list[Breach]:
        """Every limit exceeded in these intervals because of the station."""
        base = replace(
            self.base,
            voltage_pu=self.base.voltage_pu[intervals],
            line_power=self.base.line_power[intervals],
            node_power=self.base.node_power[intervals],
            losses_kw=self.base.losses_kw[intervals],
        )
        found = ac_breaches(self.scenario, self.flow(intervals, station_kw), base)
        return [replace(b, interval=int(intervals[b.interval])) for b in found if b.by_station]

    def too_far(self, station_kw: np.ndarray) -> list[Breach]:
        """Limits worsened by more than 1e-4 pu or 0.1 %, or for which AC has no solution."""
        ratings = {f"line:{line.name}": line.rating_kva for line in self.scenario.lines}
        ratings |= {f"node:{node.node}": node.rating_kva for node in self.scenario.nodes}
        return [
            breach
            for breach in self.breaches(np.arange(len(station_kw)), station_kw)
            if breach.depth - breach.base_depth
            > (
                MOST_PU
                if breach.unit == "pu"
                else MOST_SHARE * ratings.get(str(breach.element), 0.0)
            )
        ]


def day_of(scenario: Scenario) -> Trace:
    trace = run_day(start_day(scenario, "ac"), p1_policy())
    assert totals(trace).broken == 0
    return trace


def assert_limits_hold_and_bind(seed: int, kind: str) -> None:
    bare = bare_tree(seed, kind)
    network = AcNetwork(bare)
    scenario = limited_tree(bare, network, seed, kind)
    trace, judge = day_of(scenario), Judge(scenario, network)
    station_kw, rows = executed_station_kw(trace), trace.inputs.rows
    assert judge.too_far(station_kw) == []
    headroom_kw, binding = rows.headroom_kw(), names(rows.binding())
    reached = np.flatnonzero((station_kw >= REACHED * headroom_kw) & (headroom_kw > 1))
    assert len(reached)
    assert {binding[t].partition(":")[0] for t in reached} == {KINDS[kind]}
    beyond = judge.breaches(reached, 1.02 * headroom_kw[reached])
    assert {(b.interval, str(b.element)) for b in beyond} >= {(int(t), binding[t]) for t in reached}


def assert_nothing_broken(seed: int) -> None:
    trace = day_of(random_scenario(seed))
    judge = Judge(trace.scenario, AcNetwork(trace.scenario))
    assert judge.too_far(executed_station_kw(trace)) == []


@pytest.mark.parametrize(
    ("seed", "kind"), [(seed, kind) for seed, kind in enumerate(KINDS)], ids=str
)
def test_limits_bind_in_turn_and_hold_all_day(seed, kind):
    assert_limits_hold_and_bind(seed, kind)


@pytest.mark.parametrize("seed", [3, 5])
def test_random_days_break_nothing_in_pandapower(seed):
    assert_nothing_broken(seed)


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(100, 120))
def test_limits_bind_in_turn_on_many_trees(seed, kind):
    assert_limits_hold_and_bind(seed, kind)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(100, 150))
def test_fifty_random_days_break_nothing_in_pandapower(seed):
    assert_nothing_broken(seed)
