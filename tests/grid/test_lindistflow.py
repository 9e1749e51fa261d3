"""(1), (3) and line flows, against numbers worked out by hand and against AC power flow."""

import math

import numpy as np
import pytest
from hypothesis import given, settings

from evdash.grid.acflow import build_network, solve_network
from evdash.grid.lindistflow import (
    Injections,
    base_injections,
    line_flows,
    sensitivity,
    voltage_pu,
    voltage_sq_pu,
    with_station,
)
from evdash.grid.radial import radial_feeder
from tests.builders import line, make_scenario, node, scenarios, trees


def base_of(scenario):
    return base_injections(scenario, radial_feeder(scenario))


def test_voltage_of_two_nodes_worked_out_by_hand():
    # 4 kV and 2 MVA: base impedance 8 ohm, so r = 0.05 pu and x = 0.1 pu.
    # Load 200 kW and 100 kvar, station 60 kW: p = -0.13 pu, q = -0.05 pu.
    # v = 1.02² + 2·0.05·(-0.13) + 2·0.1·(-0.05) = 1.0404 - 0.013 - 0.01 = 1.0174
    scenario = make_scenario(
        nodes=[node("s"), node("a", load_kw=200, load_kvar=100)],
        lines=[line("s", "a", 0.4, 0.8)],
        feeder={"base_kv": 4.0, "base_mva": 2.0, "source_voltage_pu": 1.02},
        price=[0.1],
    )
    voltage = voltage_pu(scenario, radial_feeder(scenario), np.array([60.0]))
    assert voltage[0, 0] == pytest.approx(math.sqrt(1.0174), abs=1e-12)


def test_voltages_share_the_drop_of_the_way_they_share():
    # s - a - b and a - c; only b draws. a and c see the drop of s-a, b that of a-b as well.
    scenario = make_scenario(
        nodes=[node("c"), node("b", load_kw=100, load_kvar=0), node("s"), node("a")],
        lines=[line("b", "a", 0.3, 0.0), line("s", "a", 0.2, 0.5), line("c", "a", 0.7, 0.1)],
        feeder={"base_kv": 10.0, "base_mva": 1.0},
        price=[0.1],
    )
    feeder = radial_feeder(scenario)
    assert feeder.nodes == ("c", "b", "a")
    v = voltage_sq_pu(scenario, feeder, base_injections(scenario, feeder))[0]
    per_ohm = 2 * 100 / (10.0**2 * 1000)
    expected = [1 - 0.2 * per_ohm, 1 - 0.5 * per_ohm, 1 - 0.2 * per_ohm]
    assert v == pytest.approx(expected, abs=1e-14)


@settings(max_examples=15)
@given(tree=trees(max_nodes=7))
def test_sensitivities_are_those_of_ac_power_flow_at_no_load(tree):
    scenario = make_scenario(**tree, price=[0.1], feeder={"source_voltage_pu": 1.03})
    feeder = radial_feeder(scenario)
    net = build_network(scenario, feeder)
    step_kw, nothing = 5.0, np.zeros(len(feeder.nodes))

    def squared(active_kw, reactive_kvar):
        solve_network(net, active_kw, reactive_kvar)
        return net.res_bus.vm_pu.to_numpy()[1:] ** 2

    step_pu = step_kw / 1000 / scenario.feeder.base_mva
    nodes = range(len(feeder.nodes))
    R = np.array([sensitivity(feeder, feeder.r_pu, node) for node in nodes])
    X = np.array([sensitivity(feeder, feeder.x_pu, node) for node in nodes])
    for j in range(len(feeder.nodes)):
        push = nothing.copy()
        push[j] = step_kw
        by_active = (squared(push, nothing) - squared(-push, nothing)) / (2 * step_pu)
        by_reactive = (squared(nothing, push) - squared(nothing, -push)) / (2 * step_pu)
        assert by_active == pytest.approx(R[:, j], rel=1e-4, abs=1e-6)
        assert by_reactive == pytest.approx(X[:, j], rel=1e-4, abs=1e-6)


def test_load_follows_profile_and_scale_and_power_factor():
    scenario = make_scenario(
        nodes=[node("s"), node("a", load_kw=120)],
        feeder={"power_factor": 0.6, "load_scale": 1.5},
        load=[1.0, 0.5],
        price=[0.1, 0.1],
    )
    base = base_of(scenario)
    assert base.active_kw[:, 0] == pytest.approx([-180, -90])
    assert base.reactive_kvar[:, 0] == pytest.approx([-240, -120])  # tan φ = 0.8/0.6


@pytest.mark.parametrize(
    ("given_kvar", "expected"), [(None, -75), (0.0, 0), (-10.0, 10), (40, -40)]
)
def test_load_kvar_given_stands_and_blank_comes_from_the_power_factor(given_kvar, expected):
    nodes = [node("s"), node("a", load_kw=100, load_kvar=given_kvar)]
    scenario = make_scenario(nodes=nodes, feeder={"power_factor": 0.8}, price=[0.1])
    assert base_of(scenario).reactive_kvar[0, 0] == pytest.approx(expected)


def test_shunt_is_constant_and_generation_follows_its_own_profile():
    scenario = make_scenario(
        nodes=[node("s"), node("a", load_kw=10, load_kvar=4, shunt_kvar=50, generation_kw=80)],
        feeder={"load_scale": 2.0},
        load=[1.0, 0.0],
        generation=[0.25, 1.0],
        price=[0.1, 0.1],
    )
    base = base_of(scenario)
    assert base.active_kw[:, 0] == pytest.approx([80 * 0.25 - 20, 80])
    assert base.reactive_kvar[:, 0] == pytest.approx([50 - 8, 50])


def test_station_draws_at_its_own_node_and_no_reactive_power():
    scenario = make_scenario(
        nodes=[node("s"), node("a", load_kw=10), node("b", load_kw=20)],
        lines=[line("s", "a"), line("a", "b")],
        station={"node": "b"},
        price=[0.1, 0.1],
    )
    feeder, base = radial_feeder(scenario), base_of(scenario)
    moved = with_station(scenario, feeder, base, np.array([5.0, 7.0]))
    assert moved.active_kw - base.active_kw == pytest.approx(np.array([[0, -5], [0, -7]]))
    assert moved.reactive_kvar == pytest.approx(base.reactive_kvar)


def test_line_flow_is_what_lies_downstream():
    scenario = make_scenario(
        nodes=[node("s"), node("a"), node("b"), node("c")],
        lines=[line("b", "a"), line("s", "a"), line("a", "c")],
        price=[0.1],
    )
    feeder = radial_feeder(scenario)
    flows = line_flows(
        feeder, Injections(np.array([[-10.0, -20.0, 50.0]]), np.array([[-1.0, -2.0, 5.0]]))
    )
    assert flows.active_kw[0] == pytest.approx([20, -20, -50])
    assert flows.reactive_kvar[0] == pytest.approx([2, -2, -5])


@given(scenario=scenarios())
def test_power_is_conserved_at_the_source(scenario):
    feeder, base = radial_feeder(scenario), base_of(scenario)
    flows = line_flows(feeder, base)
    source = scenario.feeder.source_node
    at_source = [source in (row.from_node, row.to_node) for row in scenario.lines]
    assert flows.active_kw[:, at_source].sum(axis=1) == pytest.approx(-base.active_kw.sum(axis=1))
