"""Decision 5 in both models: power flowing back, which charging relieves, allows no import.

The referee is pandapower, asked here directly, with its own idea of which way a line leads.
"""

import csv
from collections.abc import Iterator
from dataclasses import dataclass

import networkx as nx
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from evdash.audit.audit import audit_run
from evdash.checker.feeder import FeederCheck
from evdash.cli.main import main
from evdash.domain.scenario import Scenario
from evdash.errors import PowerFlowDiverged
from evdash.files.scenario_folder import scenario_files
from evdash.grid.acbreaches import ac_breaches
from evdash.grid.acflow import ac_flow, build_network, solve_network
from evdash.grid.aclimits import AcFeeder, ac_limit_rows
from evdash.grid.lindistflow import base_injections, with_station
from evdash.grid.radial import radial_feeder
from evdash.grid.reduction import limit_rows
from tests.builders import line, make_scenario, node, vehicle

TOLERANCE_KVA = 2e-3
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


@pytest.mark.parametrize("rated", ["node", "line"])
def test_an_export_allows_no_mirrored_import(rated: str) -> None:
    scenario = exporting(rated)
    for rows in (limit_rows(scenario), ac_limit_rows(scenario)):
        assert rows.headroom_kw() == pytest.approx([750 + 300] * 4, rel=1e-4)
    base = ac_flow(scenario, np.zeros(4))
    own = ac_breaches(scenario, base, base)
    assert {breach.element.split(":")[-1] for breach in own} == {"export"}
    assert not any(breach.by_station for breach in own)
    over = ac_breaches(scenario, ac_flow(scenario, np.full(4, 1494.0)), base)
    assert {(breach.by_station, breach.unit) for breach in over} == {(True, "kVA")}
    assert [breach.depth for breach in over] == pytest.approx([444] * 4, abs=1)
    assert [breach.base_depth for breach in over] == [0.0] * 4


@pytest.mark.parametrize("rated", ["node", "line"])
@pytest.mark.parametrize("policy", ["p1", "uncoordinated"])
def test_the_command_line_says_so_from_run_to_audit(
    rated: str, policy: str, tmp_path, capsys
) -> None:
    place = tmp_path / "scenario"
    place.mkdir()
    for name, text in scenario_files(exporting(rated)).items():
        (place / name).write_text(text, encoding="utf-8", newline="")
    out = tmp_path / "run"
    told = ["run", str(place), "--network", "ac", "--policy", policy, "--out", str(out)]
    assert main(told) == (0 if policy == "p1" else 3)
    capsys.readouterr()
    with (out / "intervals.csv").open(encoding="utf-8") as file:
        most_kw = max(float(row["station_kw"]) for row in csv.DictReader(file))
    assert most_kw == pytest.approx(1050 if policy == "p1" else 1800, rel=1e-4)
    found = audit_run(out)
    if policy == "p1":
        assert found.findings == ()
        assert main(["audit", str(out)]) == 0
    else:
        assert any(f"{rated}:" in finding for finding in found.findings)
        assert main(["audit", str(out)]) == 3


def test_reactive_power_alone_beyond_a_rating_is_reported() -> None:
    def breaches(load_kw: float, load_kvar: float, station_kw: float):
        scenario = make_scenario(
            nodes=[node("s"), node("a", load_kw=load_kw, load_kvar=load_kvar, rating_kva=100)],
            lines=[line("s", "a", rating=100, **SHORT)],
            price=[0.1],
            feeder=WIDE,
        )
        linear = FeederCheck(scenario).breaches(np.array([station_kw]))
        base, loaded = (ac_flow(scenario, np.array([kw])) for kw in (0.0, station_kw))
        return linear, ac_breaches(scenario, loaded, base)

    for found in breaches(0.0, 200.0, 0.0):
        assert {b.element for b in found} == {"node:a", "line:s-a"}
        assert [b.depth for b in found] == pytest.approx([100.0] * 2, rel=1e-3)
        assert not any(b.by_station for b in found)
    for found in breaches(0.0, 150.0, 20.0):
        assert [b.depth for b in found] == pytest.approx([np.hypot(20, 150) - 100] * 2, rel=1e-3)
        assert all(b.by_station for b in found)
        assert {b.unit for b in found} == {"kVA"}


@dataclass(frozen=True)
class Side:
    """One side of a rated element in one interval, kVA; nothing where nothing flows there."""

    element: str
    rating_kva: float
    powers: tuple[complex, ...]

    def over(self) -> float:
        return max((abs(s) - self.rating_kva for s in self.powers if s.real >= 0), default=0.0)

    def held_over(self) -> float:
        """Over by what flows there already; reactive power counts on both sides."""
        held = (abs(complex(max(s.real, 0.0), s.imag)) for s in self.powers)
        return max(0.0, max(held) - self.rating_kva)


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
        before = {side.element: side.held_over() for side in self.sides(interval, 0.0)}
        return {
            side.element: side.over() - before[side.element]
            for side in self.sides(interval, station_kw)
            if side.over() > before[side.element]
        }


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


@given(generating(), st.floats(1.0, 900.0))
@settings(max_examples=40)
def test_ac_breaches_and_the_certificate_name_pandapowers_sides(
    scenario: Scenario, station_kw: float
) -> None:
    every = np.full(scenario.intervals, station_kw)
    base, loaded = ac_flow(scenario, 0 * every), ac_flow(scenario, every)
    assume(not loaded.diverged and not base.diverged)
    referee = Referee(scenario)
    found = ac_breaches(scenario, loaded, base)
    certificate = AcFeeder(scenario).breaches(every)
    for t in range(scenario.intervals):
        right = referee.worsened(t, station_kw)
        surely = {name for name, kva in right.items() if kva > TOLERANCE_KVA}
        for judge, tolerance in ((found, 1e-3), (certificate, 1e-4)):
            mine = {b.element for b in judge if b.interval == t and b.by_station}
            rated = {name for name in mine if name.startswith(("line", "node"))}
            assert surely <= rated
            assert all(right.get(name, 0.0) > tolerance / 2 for name in rated)


@given(generating())
@settings(max_examples=40)
def test_ac_headroom_is_what_pandapower_allows_side_by_side(scenario: Scenario) -> None:
    rows = ac_limit_rows(scenario)
    headroom, binding = rows.headroom_kw(), rows.binding()
    referee = Referee(scenario)
    for t in range(scenario.intervals):
        if not binding[t].startswith(("line", "node")):
            continue
        at, beyond = headroom[t], headroom[t] * 1.01 + 1.0
        try:
            assert all(kva < TOLERANCE_KVA for kva in referee.worsened(t, at).values())
            assert binding[t] in referee.worsened(t, beyond)
        except PowerFlowDiverged:
            assume(False)


@given(generating(), st.floats(0.0, 900.0))
@settings(max_examples=60)
def test_the_linear_checker_keeps_sides_apart_as_the_rows_do(
    scenario: Scenario, station_kw: float
) -> None:
    """Breaches against the closed form of (2), summed over what lies below."""
    rows, check = limit_rows(scenario), FeederCheck(scenario)
    every = np.full(scenario.intervals, station_kw)
    found = {(b.interval, b.element): b for b in check.breaches(every)}
    for t in range(scenario.intervals):
        for i, element in enumerate(rows.elements):
            if element.startswith(("line", "node")):
                over_kw = station_kw - max(0.0, rows.limit_kw[t, i])
                mine = found.get((t, element))
                if over_kw > 1.0:
                    assert mine is not None
                    assert mine.by_station
                elif over_kw < -1e-3:
                    assert mine is None or not mine.by_station
    for breach in found.values():
        if ":export" in breach.element:
            assert not breach.by_station
