"""The figures by which days are compared, worked out by hand."""

import numpy as np
import pytest

from evdash.domain.breach import Breach
from evdash.domain.elements import Element
from evdash.grid.acflow import AcNetwork, ac_flow
from evdash.horizon.day import run_day, start_day, step
from evdash.metrics.ac_day import ac_base, ac_day, longest
from evdash.metrics.declared import figures_of
from evdash.metrics.service import Service, service
from evdash.policies.registry import RULES
from evdash.scheduling.p1 import p1_policy
from tests.builders import line, make_scenario, node, vehicle

ONE_LINE = {"lines": (line("s", "a", rating=20.0),)}


def day(scenario, name="p1"):
    trace = start_day(scenario)
    return run_day(trace, RULES[name].make(trace.inputs), decide=RULES[name].decide)


@pytest.fixture(scope="module")
def quiet():
    """10 kWh at once, 10 kWh in the third hour; a third vehicle wants what nobody can give."""
    return make_scenario(
        price=(0.1, 0.2, 0.1, 0.2),
        station={"chargers": 1, "max_kw": 10.0},
        vehicles=[
            vehicle("a", hour=0, need_kwh=10.0, option="C1"),
            vehicle("b", hour=2, need_kwh=10.0, option="C2"),
            vehicle("c", hour=3, need_kwh=30.0, option="C2"),
        ],
    )


def test_a_day_by_hand(quiet):
    found = service(day(quiet))
    assert (found.arrived, found.admitted, found.broken) == (3, 2, 0)
    assert found.acceptance == pytest.approx(2 / 3)
    assert found.acceptance_by_option == {"C1": 1.0, "C2": 0.5}
    assert (found.demands_met, found.contracts_kept) == (pytest.approx(2 / 3), 1.0)
    assert found.energy_met == pytest.approx(20 / 50)
    assert found.refused_kwh_by_reason == pytest.approx(
        {next(iter(found.refused_kwh_by_reason)): 30}
    )
    assert found.revenue == pytest.approx(10 * 0.4 + 10 * 0.3)
    assert found.energy_cost == pytest.approx(2.0)
    assert found.profit == pytest.approx(5.0)
    # a: promised after two hours, full after one; b: after two of the horizon's, full after one
    assert found.on_time_margin_h == pytest.approx(1.0)
    assert (found.peak_station_kw, found.load_factor) == (10.0, pytest.approx(0.5))
    assert found.headroom_use == pytest.approx(20 / 40)
    assert (found.starts_per_session, found.churn_kwh) == (1.0, 0.0)
    assert found.proven_gap <= 0.01
    assert found.solve_median_s <= found.solve_p95_s <= found.solve_worst_s


def test_against_perfect_information(quiet):
    found = service(day(quiet), most_profit=10.0)
    assert found.profit_of_best == pytest.approx(0.5)
    assert found.short_of_best == pytest.approx(5.0)
    assert service(day(quiet)).profit_of_best is None


def test_a_day_that_has_not_begun_measures_nothing(quiet):
    found = service(start_day(quiet))
    assert found.acceptance is None
    assert found.solve_worst_s is None
    assert (found.profit, found.churn_kwh) == (0.0, 0.0)


def test_starts_and_churn():
    """Charging skips the dear hour; who comes at 02:00 pays for moving it to the last one."""
    scenario = make_scenario(
        price=(0.1, 0.9, 0.2, 0.9),
        station={"chargers": 1, "max_kw": 10.0},
        options=(
            {"name": "C1", "price_per_kwh": 1.2, "average_kw": 10.0},
            {"name": "C2", "price_per_kwh": 1.0, "average_kw": 5.0},
        ),
        vehicles=[
            vehicle("long", hour=0, need_kwh=20.0, option="C2"),
            vehicle("short", hour=1.5, need_kwh=10.0, option="C1"),
        ],
    )
    found = service(day(scenario))
    assert found.admitted == 2
    assert found.starts_per_session == pytest.approx(1.5)  # at 00:00 and 03:00; at 02:00
    assert found.churn_kwh == pytest.approx(10.0)


def test_what_charging_does_to_the_feeder_in_ac():
    """Everyone at once: 30 kW through a line of 20 kVA for two hours, then nobody."""
    scenario = make_scenario(
        **ONE_LINE,
        nodes=[node("s"), node("a", load_kw=4.0)],
        feeder={"voltage_min_pu": 0.9999},
        vehicles=[vehicle(f"{n}", need_kwh=20.0, option="C2", battery_kwh=60.0) for n in range(3)],
    )
    trace = day(scenario, "uncoordinated")
    found = service(trace, ac_day(trace))
    flow = ac_flow(scenario, np.array([30.0, 30.0, 0.0, 0.0]))
    assert found.ac_overload_intervals == 2
    assert found.ac_overload_longest_h == 2.0
    assert found.ac_overload_kva == pytest.approx(flow.line_kva[:, 0].max() - 20.0, abs=1e-6)
    assert found.ac_voltage_node_intervals == 2  # without the station the voltage holds
    assert found.ac_voltage_depth_pu == pytest.approx(0.9999 - flow.voltage_pu.min(), abs=1e-9)
    assert found.ac_losses_kwh == pytest.approx(flow.losses_kw.sum(), abs=1e-6)
    assert found.headroom_use > 1.0
    network = AcNetwork(scenario)
    again = ac_day(trace, network, ac_base(trace, network))
    assert again.breaches == ac_day(trace).breaches


def test_a_day_under_way_is_judged_up_to_now():
    scenario = make_scenario(**ONE_LINE, vehicles=[vehicle("a", need_kwh=10.0)])
    trace = step(start_day(scenario), p1_policy())
    found = service(trace, ac_day(trace))
    assert (found.ac_voltage_node_intervals, found.ac_unsolved) == (0, 0)
    assert found.ac_voltage_error_pu < 1e-3


def test_longest_is_at_one_element_and_without_a_break():
    def beyond(element, intervals):
        return [Breach(t, Element("voltage_min", element), 1.0, 0.0, "pu", 0.0) for t in intervals]

    assert longest([]) == 0
    assert longest([*beyond("x", [1, 2, 4, 5, 6]), *beyond("y", [3, 7])]) == 3


def test_every_figure_says_what_it_is_and_how_it_is_told():
    figures = {figure.name: figure for figure in figures_of(Service)}
    assert all(figure.label and figure.meaning.endswith(".") for figure in figures.values())
    assert len({figure.label for figure in figures.values()}) == len(figures)
    assert figures["profit"].head == "Profit, $"
    assert figures["profit"].told(-1234.5) == "−1,234.50"
    assert figures["profit"].told(-0.001) == "0.00"
    assert figures["acceptance"].told(0.4567) == "45.7"
    assert figures["proven_gap"].told(None) == "–"
