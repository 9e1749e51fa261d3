"""Decision 5: each side of each limit by itself; the feeder's own faults bind nobody else."""

import numpy as np
import pytest

from evdash.checker.feeder import FeederCheck
from evdash.grid.reduction import limit_rows
from evdash.horizon.day import run_day, start_day
from evdash.scheduling.p1 import p1_policy
from tests.builders import line, make_scenario, node, vehicle

PLENTY_KW = 1e4


def fork(a=None, b=None, c=None, *, lines=None, station="b", **fields):
    """s - a - b with the station, and s - c apart from it."""
    return make_scenario(
        nodes=[node("s"), node("a", **(a or {})), node("b", **(b or {})), node("c", **(c or {}))],
        lines=lines or [line("s", "a"), line("a", "b"), line("s", "c")],
        station={"node": station},
        price=[0.1],
        **fields,
    )


def headroom(scenario):
    rows = limit_rows(scenario)
    return rows.headroom_kw()[0], str(rows.binding()[0])


def breaches(scenario, station_kw=0.0):
    found = FeederCheck(scenario).breaches(np.array([station_kw]))
    return {str(breach.element): breach.by_station for breach in found}


def test_under_voltage_beside_the_way_is_reported_and_blocks_nothing():
    broken = fork(c={"load_kw": 9000, "load_kvar": 0, "shunt_kvar": -9000})
    room, binding = headroom(broken)
    assert (room, binding) == headroom(fork())
    assert breaches(broken, 5.0) == {"voltage_min:c": False}


def test_under_voltage_on_the_way_blocks_charging_and_is_the_feeders_own_until_it_charges():
    broken = fork(b={"shunt_kvar": -20_000})
    assert headroom(broken) == (0.0, "voltage_min:b")
    assert breaches(broken) == {"voltage_min:b": False, "voltage_min:a": False}
    assert breaches(broken, 5.0) == {"voltage_min:b": True, "voltage_min:a": True}


def test_under_voltage_beyond_a_shared_line_blocks_charging_too():
    lines = [line("s", "a"), line("a", "b"), line("a", "c")]
    broken = fork(c={"shunt_kvar": -20_000}, lines=lines)
    assert headroom(broken) == (0.0, "voltage_min:c")
    assert breaches(broken, 5.0)["voltage_min:c"]


def test_over_voltage_is_reported_and_never_enforced():
    broken = fork(b={"generation_kw": 20_000})
    room, _ = headroom(broken)
    assert room > PLENTY_KW
    assert breaches(broken) == {"voltage_max:a": False, "voltage_max:b": False}
    assert breaches(broken, 100.0) == {"voltage_max:a": False, "voltage_max:b": False}


def test_import_over_a_line_rating_on_the_way_blocks_charging():
    lines = [line("s", "a", rating=50), line("a", "b"), line("s", "c")]
    broken = fork(a={"load_kw": 60, "load_kvar": 0}, lines=lines)
    assert headroom(broken) == (0.0, "line:s-a")
    assert breaches(broken) == {"line:s-a": False}
    assert breaches(broken, 1.0) == {"line:s-a": True}


def test_import_over_a_rating_elsewhere_is_reported_and_blocks_nothing():
    lines = [line("s", "a"), line("a", "b"), line("s", "c", rating=50)]
    load = {"load_kw": 60, "load_kvar": 0, "rating_kva": 55}
    assert headroom(fork(c=load, lines=lines)) == headroom(fork())
    assert breaches(fork(c=load, lines=lines), 9.0) == {"line:s-c": False, "node:c": False}


def test_export_over_a_rating_is_relieved_by_charging_and_never_enforced():
    lines = [line("s", "a", rating=50), line("a", "b", rating=50), line("s", "c")]
    exporting = fork(b={"generation_kw": 80, "rating_kva": 50}, lines=lines)
    own = {"line:s-a:export": False, "line:a-b:export": False, "node:b:export": False}
    assert breaches(exporting) == own
    assert breaches(exporting, 10.0) == own
    room, binding = headroom(exporting)
    assert room == pytest.approx(80 + 50)  # from 80 kW out to 50 kW in
    assert binding in ("line:s-a", "line:a-b", "node:b")
    assert breaches(exporting, 130.0) == {}
    assert breaches(exporting, 130.1) == dict.fromkeys(("line:s-a", "line:a-b", "node:b"), True)


def test_reactive_power_beyond_a_rating_leaves_room_only_for_what_lowers_the_flow():
    lines = [line("s", "a", rating=50), line("a", "b"), line("s", "c")]
    assert headroom(fork(a={"shunt_kvar": -60}, lines=lines)) == (0.0, "line:s-a")
    relieved = fork(a={"shunt_kvar": -60, "generation_kw": 20}, lines=lines)
    assert headroom(relieved) == (pytest.approx(20.0), "line:s-a")


def test_most_broken_of_several_is_named_binding():
    lines = [line("s", "a", rating=50), line("a", "b", rating=30), line("s", "c")]
    broken = fork(b={"load_kw": 60, "load_kvar": 0}, lines=lines)
    assert headroom(broken) == (0.0, "line:a-b")


def test_a_day_on_a_feeder_broken_at_noon_charges_before_and_after():
    scenario = make_scenario(
        nodes=[node("s"), node("a", load_kw=100, load_kvar=0)],
        lines=[line("s", "a", rating=60)],
        load=[0.5, 1.0, 0.5],
        price=[0.1, 0.01, 0.1],
        vehicles=[vehicle("early", 0, 8), vehicle("late", 2, 8), vehicle("noon", 1, 8)],
    )
    trace = run_day(start_day(scenario), p1_policy())
    powers = [round(step.station_kw, 6) for step in trace.steps]
    refused = [refusal.vehicle for step in trace.steps for refusal in step.plan.refused]
    assert powers == [8.0, 0.0, 8.0]
    assert refused == ["noon"]
