"""Numbers put into the equations are those of the plan, the rows and the checker's voltages."""

import math
from datetime import time

import numpy as np
import pytest

from evdash.checker.feeder import FeederCheck
from evdash.domain.trace import Trace
from evdash.files.bundled import bundled_scenarios
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import start_day, step
from evdash.metrics.equations import (
    lowest_node,
    node_numbers,
    rating_numbers,
    station_numbers,
    vehicle_numbers,
    vehicles_of,
)
from evdash.metrics.key_figures import common_steps, key_figures, until
from evdash.metrics.outlook import outlook
from evdash.metrics.service import totals
from evdash.metrics.statements import (
    admitted_within,
    intermittent,
    price_paid,
    station_share_at_peak,
)
from evdash.scheduling.p1 import p1_policy

EVENING = 21


@pytest.fixture(scope="module", params=bundled_scenarios(), ids=lambda folder: folder.name)
def trace(request: pytest.FixtureRequest) -> Trace:
    day = start_day(read_scenario(request.param))
    for _ in range(EVENING):
        day = step(day, p1_policy())
    return day


def test_every_equation_holds_with_its_numbers(trace: Trace) -> None:
    for taken in trace.steps:
        station = station_numbers(taken)
        assert station.total_kw == pytest.approx(taken.station_kw)
        assert len(station.power_kw) <= station.chargers
        assert station.total_kw <= station.headroom_kw + 1e-6
        worth = station.energy_cost - station.new_revenue
        assert worth == pytest.approx(taken.plan.report.objective, abs=1e-6)
        for request in vehicles_of(taken):
            vehicle = vehicle_numbers(taken, request.vehicle)
            assert vehicle.planned_kwh == pytest.approx(
                vehicle.owed_kwh * vehicle.admitted, abs=1e-6
            )
            used = [t for t, power in enumerate(vehicle.power_kw) if power > 0]
            assert not used or used[-1] < vehicle.intervals_left
            for t in used:
                assert vehicle.low_kw - 1e-6 <= vehicle.power_kw[t] <= request.max_kw + 1e-6


def test_voltages_are_those_of_the_outlook_and_the_lowest_is_found(trace: Trace) -> None:
    ahead, taken = outlook(trace), trace.steps[-1]
    t = taken.interval
    for i, node in enumerate(ahead.nodes):
        numbers = node_numbers(taken, node)
        assert numbers.voltage_pu == pytest.approx(ahead.voltage_pu[t, i], abs=1e-12)
        assert numbers.voltage_sq == pytest.approx(numbers.voltage_pu**2, abs=1e-12)
    assert lowest_node(taken) == ahead.nodes[int(ahead.voltage_pu[t].argmin())]


def test_the_nodes_take_what_the_feeder_takes(trace: Trace) -> None:
    ahead, taken = outlook(trace), trace.steps[-1]
    nodes = [node_numbers(taken, node) for node in ahead.nodes]
    assert sum(node.load_kw for node in nodes) == pytest.approx(ahead.load_kw[taken.interval])
    total = sum(node.injection_kw for node in nodes)
    generation = sum(node.generation_kw for node in nodes)
    assert -total == pytest.approx(ahead.load_kw[taken.interval] + taken.station_kw - generation)


def test_the_rating_agrees_with_the_headroom_of_its_row_and_with_the_checker(trace: Trace) -> None:
    for taken in trace.steps:
        rating, rows = rating_numbers(taken), taken.inputs.rows
        if rating is None:
            assert not any(element.is_rating for element in rows.elements)
            continue
        limit_kw = rows.limit_kw[taken.interval, rows.elements.index(rating.element)]
        room_kw = rating.limit_kw - rating.active_kw
        assert room_kw == pytest.approx(limit_kw - taken.station_kw, abs=1e-6)
        power_kw = np.zeros(trace.scenario.intervals)
        power_kw[taken.interval] = taken.station_kw + room_kw + 5.0
        broken = {b.element for b in FeederCheck(taken.inputs.scenario).breaches(power_kw)}
        assert rating.element in broken


def test_a_run_cut_short_is_the_run_it_was(trace: Trace) -> None:
    scenario = trace.scenario
    day = start_day(scenario)
    for _ in range(5):
        day = step(day, p1_policy())
    cut = until(trace, 5)
    assert totals(cut) == totals(day)
    assert until(trace, 99) is trace
    assert until(trace, 0).now == 0
    assert common_steps([trace, day]) == [5, 5]
    figures = key_figures(cut, outlook(cut), {})
    assert figures.lowest_voltage_pu == pytest.approx(outlook(day).voltage_pu[:5].min())
    assert figures.solve_seconds == sum(s.plan.report.seconds for s in cut.steps)
    fresh = until(trace, 0)
    assert key_figures(fresh, outlook(fresh), {}).lowest_voltage_pu is None


def test_statements_about_a_run_are_counted_from_its_steps(trace: Trace) -> None:

    everyone = admitted_within(trace, [(time(0), time(12)), (time(12), time(0))])
    assert everyone == (
        sum(len(taken.plan.admitted) for taken in trace.steps),
        sum(len(taken.requests) for taken in trace.steps),
    )
    night = admitted_within(trace, [(time(23), time(2))])
    hours = [taken for taken in trace.steps if taken.start.hour in (23, 0, 1)]
    assert night[1] == sum(len(taken.requests) for taken in hours)
    found, sums = intermittent(trace), totals(trace)
    assert found.full == sums.charged
    assert found.over == sums.charged + sums.broken
    paid, mean = price_paid(trace)
    assert paid == pytest.approx(sums.energy_cost / sums.energy_delivered_kwh)
    assert mean == pytest.approx(trace.scenario.price_per_kwh[:EVENING].mean())
    share = station_share_at_peak(trace)
    assert share is None or math.isfinite(share)
    assert price_paid(until(trace, 0))[0] is None
    assert station_share_at_peak(until(trace, 0)) is None
