"""One vehicle's day against what the steps carried out, and against sums done by hand."""

import numpy as np
import pytest

from evdash.domain.events import Event
from evdash.domain.trace import Trace
from evdash.horizon.day import run_day, start_day, step
from evdash.horizon.happen import happen
from evdash.metrics.records import executed_power, vehicle_records
from evdash.metrics.service import totals
from evdash.metrics.vehicles import (
    charging_kw,
    plan_history,
    vehicle_day,
)
from evdash.scheduling.p1 import p1_policy
from tests.builders import make_scenario, vehicle


@pytest.fixture(scope="module")
def begun() -> Trace:
    """Two vehicles, one charger: the second hour is dear, so the day is not simply filled up."""
    scenario = make_scenario(
        price=[0.05, 0.3, 0.1, 0.1, 0.1, 0.1],
        station={"chargers": 1, "efficiency": 0.8},
        vehicles=[
            vehicle("one", need_kwh=12.0, option="C2"),
            vehicle("two", hour=1, need_kwh=4.0, option="C2"),
            vehicle("never", hour=1, need_kwh=0.5, option="C1", max_kw=0.3),
        ],
    )
    trace = start_day(scenario)
    for _ in range(2):
        trace = step(trace, p1_policy())
    return trace


def test_battery_gains_what_was_drawn_times_the_efficiency(begun: Trace) -> None:
    day = vehicle_day(begun, "one")
    request = day.request
    drawn_kwh = day.power_kw.sum()  # intervals of one hour, executed and planned
    assert drawn_kwh == pytest.approx(request.need_kwh)
    gained = drawn_kwh * 0.8 / request.battery_kwh
    assert day.soc[-1] - day.soc[0] == pytest.approx(gained)
    assert day.soc[request.deadline_interval] == pytest.approx(request.soc_out)
    assert day.soc[0] == request.soc_in


def test_the_cost_is_of_what_was_drawn_at_the_prices_in_force(begun: Trace) -> None:
    prices = [0.05, 0.3]
    by_hand = {
        name: sum(kw * prices[t] for t, who, kw in executed_power(begun) if who == name)
        for name in ("one", "two")
    }
    assert sum(by_hand.values()) > 0
    for name, cost in by_hand.items():
        assert vehicle_day(begun, name).energy_cost == pytest.approx(cost)
    costs = [vehicle_day(begun, r.vehicle).energy_cost for r in vehicle_records(begun)]
    assert sum(costs) == pytest.approx(totals(begun).energy_cost)


def test_below_the_least_soc_full_power_is_too_late(begun: Trace) -> None:
    day = vehicle_day(begun, "one")
    request, least = day.request, day.least_soc
    per_hour = request.max_kw * 0.8 / request.battery_kwh
    deadline = request.deadline_interval
    assert least[deadline:] == pytest.approx(request.soc_out)
    for t in range(deadline):
        at_deadline = least[t] + per_hour * (deadline - t)
        assert at_deadline >= request.soc_out - 1e-12
        if least[t] > request.soc_in:
            assert at_deadline == pytest.approx(request.soc_out)


def test_no_battery_ever_falls_below_what_its_promise_needs() -> None:
    crowd = [vehicle(f"v{n}", hour=n // 2, need_kwh=3 + n, battery_kwh=40) for n in range(8)]
    trace = run_day(start_day(make_scenario(price=[0.1, 0.4] * 5, vehicles=crowd)), p1_policy())
    for record in vehicle_records(trace):
        day = vehicle_day(trace, record.vehicle)
        if day.is_admitted:
            window = slice(day.request.arrival_interval, day.request.deadline_interval + 1)
            assert (day.soc[window] >= day.least_soc[window] - 1e-6).all()


def test_a_plan_has_a_line_for_each_step_it_was_part_of(begun: Trace) -> None:
    history = plan_history(begun, "one")
    assert history.decided == (0, 1)
    assert np.isnan(history.power_kw[1, 0])
    assert np.isfinite(history.power_kw[0]).all()
    for row, decided in enumerate(history.decided):
        plan = begun.steps[decided].plan
        assert history.power_kw[row, decided:] == pytest.approx(
            plan.power_kw[plan.vehicles.index("one")]
        )
    carried_out = vehicle_day(begun, "one").power_kw[:2]
    assert [history.power_kw[0, 0], history.power_kw[1, 1]] == pytest.approx(carried_out)


def test_who_was_refused_never_had_a_plan(begun: Trace) -> None:
    day = vehicle_day(begun, "never")
    assert not day.is_admitted
    assert day.power_kw.sum() == 0
    assert (day.soc == day.request.soc_in).all()
    assert plan_history(begun, "never").power_kw.shape == (0, 6)


def test_someone_who_did_not_ask_has_no_day(begun: Trace) -> None:
    with pytest.raises(KeyError):
        vehicle_day(begun, "nobody")


def test_charging_now_is_the_last_interval(begun: Trace) -> None:
    last = {who: kw for t, who, kw in executed_power(begun) if t == 1}
    assert charging_kw(begun) == last
    assert charging_kw(start_day(begun.scenario)) == {}


def test_what_was_agreed_since_counts_as_due() -> None:
    """It asks for 3 kWh more, or leaves an hour early: need, battery and due time follow."""
    one = vehicle("a", need_kwh=12.0, option="C2")
    trace = step(start_day(make_scenario(price=[0.1] * 6, vehicles=[one])), p1_policy())
    first = vehicle_day(trace, "a")
    assert first.due_interval == 3
    asked = Event(interval=1, event="asks_more", subject="a", value=3.0)
    more = vehicle_day(happen(trace, (asked,)), "a")
    assert more.due_soc - first.due_soc == pytest.approx(3.0 / more.request.battery_kwh)
    assert more.least_soc[3] == more.soc[3] == pytest.approx(more.due_soc)
    assert more.share_delivered == pytest.approx(more.record.delivered_kwh / 15.0)
    leaves = Event(interval=1, event="leaves_early", subject="a", until_interval=2)
    early = vehicle_day(happen(trace, (leaves,)), "a")
    assert early.due_interval == 2
    assert early.least_soc[2] == pytest.approx(early.due_soc)


def test_the_dues_of_who_was_refused_are_what_it_asked_for(begun: Trace) -> None:
    day = vehicle_day(begun, "never")
    assert day.terms is None
    assert (day.due_interval, day.due_soc) == (day.request.deadline_interval, day.request.soc_out)
