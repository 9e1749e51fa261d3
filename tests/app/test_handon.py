"""The check behind handing on: in the background, counted, cancelled, refused in words."""

import threading

from evdash.horizon.day import run_day, start_day
from evdash.reports.account import flows_needed
from evdash.scheduling.p1 import p1_policy
from evdash.ui.handon.checking import WORKER, Checking
from tests.builders import make_scenario, vehicle

PATIENCE_SECONDS = 120


def over(check: Checking) -> Checking:
    WORKER.submit(lambda: None).result(PATIENCE_SECONDS)  # it comes after
    assert check.is_over
    return check


def day():
    return run_day(start_day(make_scenario(vehicles=[vehicle("V1")])), p1_policy())


def test_a_day_is_checked_and_every_power_flow_counted():
    trace = day()
    check = over(Checking(trace))
    assert check.failure == ""
    assert check.done == check.total == flows_needed(trace) == 8
    assert check.verdict.flow.voltage_pu.shape == (4, 1)


def test_while_anothers_day_is_checked_one_waits_and_can_give_up():
    going_on = threading.Event()
    WORKER.submit(going_on.wait, PATIENCE_SECONDS)
    check = Checking(day())
    try:
        assert check.is_waiting
        check.cancel()
        assert not check.is_waiting
    finally:
        going_on.set()
    assert over(check).verdict is None


def test_a_check_under_way_stops_between_two_power_flows(monkeypatch):
    trace, begun, going_on = day(), threading.Event(), threading.Event()
    count = Checking._count

    def slowly(check: Checking) -> None:
        count(check)
        begun.set()
        going_on.wait(PATIENCE_SECONDS)

    monkeypatch.setattr(Checking, "_count", slowly)
    check = Checking(trace)
    assert begun.wait(PATIENCE_SECONDS)
    check.cancel()
    going_on.set()
    assert over(check).verdict is None
    assert check.failure == "Cancelled."
    assert check.done == 1


def test_a_day_under_way_is_refused_in_words():
    check = over(Checking(start_day(make_scenario())))
    assert check.verdict is None
    assert "run it to its end" in check.failure
