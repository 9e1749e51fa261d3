"""AC power flow as the referee of the linearised model."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evdash.grid.acflow import AcNetwork, ac_flow
from evdash.grid.lindistflow import base_injections, line_flows, voltage_pu, with_station
from evdash.grid.radial import radial_feeder
from tests.builders import line, make_scenario, node, scenarios


def one_line(load_kw, load_kvar=0.0, **fields):
    nodes = [node("s"), node("a", load_kw=load_kw, load_kvar=load_kvar)]
    return make_scenario(nodes=nodes, lines=[line("s", "a", 0.4, 0.8)], **fields)


def test_voltage_and_losses_of_two_nodes_worked_out_by_hand():
    # v² + (2(rP + xQ) - v0²) v + (r² + x²)(P² + Q²) = 0 in squared voltage v, per unit
    scenario = one_line(900, 400, price=[0.1], feeder={"source_voltage_pu": 1.02})
    per_ohm = 1 / 4.16**2  # base 1 MVA
    r, x, p, q = 0.4 * per_ohm, 0.8 * per_ohm, 0.9 + 0.1, 0.4
    b = 2 * (r * p + x * q) - 1.02**2
    squared = (-b + np.sqrt(b * b - 4 * (r * r + x * x) * (p * p + q * q))) / 2
    result = ac_flow(scenario, np.array([100.0]))
    assert result.voltage_pu[0, 0] == pytest.approx(np.sqrt(squared), abs=1e-7)
    losses = r * (p * p + q * q) / squared
    assert result.losses_kw[0] == pytest.approx(1000 * losses, rel=1e-5)
    sending = 1000 * np.hypot(p + losses, q + losses * x / r)
    assert result.line_kva[0, 0] == pytest.approx(sending, rel=1e-5)  # the larger of both ends


@settings(max_examples=25)
@given(scenario=scenarios(max_vehicles=0), station_kw=st.floats(0, 150))
def test_ac_voltage_is_never_above_the_linearised(scenario, station_kw):
    station = np.full(scenario.intervals, station_kw)
    linear = voltage_pu(scenario, radial_feeder(scenario), station)
    result = ac_flow(scenario, station)
    assert (result.voltage_pu <= linear + 1e-8)[~np.isnan(result.voltage_pu)].all()
    assert not result.diverged


@settings(max_examples=15)
@given(scenario=scenarios(max_vehicles=0), station_kw=st.floats(0, 150))
def test_ac_flow_differs_from_the_lossless_by_losses_only(scenario, station_kw):
    """Flow at the receiving end is what lies downstream; losses are positive."""
    feeder = radial_feeder(scenario)
    station = np.full(scenario.intervals, station_kw)
    result = ac_flow(scenario, station)
    moved = with_station(scenario, feeder, base_injections(scenario, feeder), station)
    flows = line_flows(feeder, moved)
    lossless = np.hypot(flows.active_kw, flows.reactive_kvar)
    leaf = feeder.on_way.sum(axis=0) == 1
    assert (result.line_kva[:, leaf] >= lossless[:, leaf] - 1e-4).all()
    assert (result.losses_kw >= -1e-6).all()


def test_ac_voltage_differs_from_the_linearised_under_load():
    scenario = one_line(900, price=[0.1])
    linear = voltage_pu(scenario, radial_feeder(scenario), np.zeros(1))
    assert ac_flow(scenario, np.zeros(1)).voltage_pu[0, 0] < linear[0, 0] - 1e-4


def test_interval_without_ac_solution_is_nan_and_leaves_the_others_alone():
    scenario = one_line(200, load=[1, 100, 1], price=[0.1] * 3)
    result = ac_flow(scenario, np.zeros(3))
    assert result.diverged == (1,)
    assert np.isnan(result.voltage_pu[1]).all()
    assert np.isnan(result.line_kva[1]).all()
    alone = ac_flow(one_line(200, price=[0.1]), np.zeros(1))
    assert result.voltage_pu[[0, 2], 0] == pytest.approx(np.repeat(alone.voltage_pu[0], 2))


def test_single_intervals_can_be_solved():
    scenario = one_line(200, load=[0.2, 0.6, 1.0], price=[0.1] * 3)
    whole = ac_flow(scenario, np.array([0.0, 10.0, 20.0]))
    later = AcNetwork(scenario).flow(scenario, np.array([1, 2]), np.array([10.0, 20.0]))
    assert later.voltage_pu == pytest.approx(whole.voltage_pu[1:])


def test_order_and_direction_of_tables_do_not_matter():
    nodes = [node("s"), node("a", load_kw=50), node("b", shunt_kvar=30, load_kw=9)]
    lines = [line("s", "a", 0.2, 0.3), line("a", "b", 0.5, 0.1)]
    turned = [line("b", "a", 0.5, 0.1), line("a", "s", 0.2, 0.3)]
    straight = ac_flow(make_scenario(nodes=nodes, lines=lines, price=[0.1]), np.array([8.0]))
    other = ac_flow(make_scenario(nodes=nodes[::-1], lines=turned, price=[0.1]), np.array([8.0]))
    assert other.nodes == ("b", "a")
    assert other.voltage_pu[0, ::-1] == pytest.approx(straight.voltage_pu[0])
    assert other.line_kva[0, ::-1] == pytest.approx(straight.line_kva[0])


def test_every_interval_is_solved_as_if_it_were_alone():
    load = [0.2, 1.0, 100, 0.6, 0.0]
    scenario = one_line(200, load=load, price=[0.1] * 5)
    station_kw = np.array([0.0, 90.0, 0.0, 900.0, 5.0])
    whole = ac_flow(scenario, station_kw)
    for interval in range(5):
        alone = AcNetwork(scenario).flow(scenario, np.array([interval]), station_kw[[interval]])
        for name in ("voltage_pu", "line_kva", "losses_kw"):
            np.testing.assert_array_equal(getattr(whole, name)[[interval]], getattr(alone, name))
