"""Something happens in mid-day: who misses what, what is made good, and what nobody foresees."""

import numpy as np
import pytest

from benchmarks.soundness import without_times
from evdash.domain.events import Event
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Happening, Trace
from evdash.errors import InputError, SolverFailure
from evdash.explain.refusals import explain_vehicle
from evdash.horizon import recourse
from evdash.horizon.advance import PROMISES_SHORT, snapshot_of
from evdash.horizon.day import run_day, start_day, step
from evdash.horizon.happen import happen, undone
from evdash.horizon.revise import revise
from evdash.metrics.breaches import linear_breaches
from evdash.metrics.ledger import LedgerEntry, ledger
from evdash.metrics.records import vehicle_records
from evdash.metrics.service import totals
from evdash.scheduling.p1 import p1_policy
from tests.builders import line, make_scenario, node, vehicle
from tests.horizon.days import with_headroom
from tests.horizon.test_revise import with_power

P1 = p1_policy()
SLOW = [{"name": name, "price_per_kwh": 0.3, "average_kw": 4.0} for name in ("C1", "C2")]


def event(kind: str, **cells) -> Event:
    return Event(event=kind, **{"interval": 1} | cells)


def two_cars(**fields) -> Scenario:
    """Two contracts of 12 kWh over three intervals, room and chargers for both at once."""
    vehicles = [vehicle(name, need_kwh=12.0, option="C2") for name in ("a", "b")]
    late = [vehicle("c", hour=1.5, need_kwh=4.0), vehicle("d", hour=2.5, need_kwh=4.0)]
    return make_scenario(**{"price": [0.1] * 5, "vehicles": vehicles + late} | fields)


def begun(each: list[float] = [4, 4, 4], **fields) -> Trace:  # noqa: B006 - never changed
    """One interval executed, both charged alike by plan `each`."""
    plan = [*each, *[0.0] * (5 - len(each))]
    return step(start_day(two_cars(**fields)), lambda s: with_power(P1(s), plan))


def told(trace: Trace, *events: Event) -> tuple[Trace, Happening]:
    after = happen(trace, events)
    return after, after.happenings[-1]


def entries(trace: Trace) -> dict[str, LedgerEntry]:
    return {entry.vehicle: entry for entry in ledger(trace)}


def test_what_breaks_nothing_changes_no_contract():
    trace = begun()
    after, happening = told(trace, event("chargers_fail", value=1))
    assert happening.revisions == ()
    assert after.scenario.station.chargers == 2
    done = run_day(after, P1)
    assert {e.status for e in entries(done).values()} == {"kept"}
    assert totals(done).broken == 0


def test_one_charger_left_serves_one_after_the_other():
    """10 kWh are owed to each in two intervals, and one charger of 10 kW gives just that."""
    trace = begun([2, 5, 5])
    after, happening = told(trace, event("chargers_fail", value=2))
    assert happening.revisions == ()
    assert (after.state.tail_kw > 0).sum(axis=0).max() == 1


def test_the_least_energy_is_missing():
    """With 9 kW besides, each can have 9 of its 10 kWh, and none gets more alone."""
    rated = event("rating", subject="node:a", value=9.0)
    _, happening = told(begun([2, 5, 5]), event("chargers_fail", value=2), rated)
    assert [r.short_kwh for r in happening.revisions] == pytest.approx([1.0, 1.0])


def test_as_few_as_possible_are_short():
    """8 kWh each are owed and 10 kWh fit: one vehicle can have all of it."""
    fields = with_headroom([30.0, 8.0, 8.0, 30.0, 30.0])  # 32 kW of load, rated 40 kVA
    after, happening = told(begun(**fields), event("load_factor", value=35 / 32))
    assert [r.short_kwh for r in happening.revisions] == pytest.approx([6.0], abs=1e-5)
    assert not [b for b in linear_breaches(run_day(after, P1)) if b.by_station]


def test_of_equal_shortfalls_the_one_that_costs_least_is_taken():
    """Either a or c must go without; c pays more."""
    vehicles = [
        vehicle("a", need_kwh=12.0, option="C2"),
        vehicle("c", need_kwh=12.0, option="C1"),
    ]
    options = [
        {"name": "C1", "price_per_kwh": 0.5, "average_kw": 4.0},
        {"name": "C2", "price_per_kwh": 0.3, "average_kw": 4.0},
    ]
    trace = begun([2, 5, 5], vehicles=vehicles, options=options)
    for order in (("a", "c"), ("c", "a")):
        assert {c.vehicle for c in trace.state.contracts} == set(order)
        _, happening = told(trace, event("rating", subject="node:a", value=5.0))
        assert [r.vehicle for r in happening.revisions] == ["a"]
        assert happening.short_kwh == pytest.approx(10.0)
        trace = begun([2, 5, 5], vehicles=vehicles[::-1], options=options)


def test_nobody_new_while_a_promise_is_short_and_again_once_it_is_over():
    after, happening = told(begun(), event("chargers", value=0))
    assert happening.short_kwh == pytest.approx(16.0)
    assert after.state.contracts == ()
    assert {c.vehicle for c in after.state.waiting} == {"a", "b"}
    at_two = step(after, P1)
    back, made_good = told(at_two, event("chargers_return", value=1, interval=2))
    # in the one interval left for them one charger gives one of them the 8 kWh it is owed
    assert sum(r.short_kwh for r in made_good.revisions) == pytest.approx(-8.0)
    done = run_day(back, P1)
    by_name = {r.vehicle: r for r in vehicle_records(done)}
    assert by_name["c"].reason == PROMISES_SHORT
    assert by_name["d"].status == "charged", "the short ones' time is over"
    assert sum(e.short_kwh for e in entries(done).values()) == pytest.approx(8.0)
    assert "nobody new is admitted" in explain_vehicle(done, "c").detail
    assert {e.since_interval for e in entries(done).values() if e.status == "short"} == {1}


def test_what_is_made_good_in_time_is_kept():
    trace = begun([2, 5, 5])
    short, _ = told(trace, event("chargers", value=0))
    back, _ = told(short, event("chargers", value=3))
    done = run_day(back, P1)
    assert {(e.status, e.short_kwh) for e in entries(done).values()} == {("kept", 0.0)}
    assert all(len(e.changes) == 2 for e in entries(done).values() if e.vehicle in "ab")
    assert totals(done).broken == 0


def test_a_driver_who_leaves_early_gets_what_can_be_had_and_costs_nobody():
    trace = begun([2, 5, 5], station={"max_kw": 7.0}, options=SLOW)
    after, happening = told(trace, event("leaves_early", subject="a", until_interval=2))
    done = run_day(after, P1)
    mine, other = entries(done)["a"], entries(done)["b"]
    assert happening.short_kwh == 0
    assert (mine.status, mine.released_kwh) == ("released", pytest.approx(3.0))
    assert (mine.revised_by_interval, mine.since_interval, mine.cause) == (2, 1, "a leaves early")
    assert (other.status, other.changes) == ("kept", ())
    assert totals(done).broken == 0
    assert totals(done).released == 1
    record = next(r for r in vehicle_records(done) if r.vehicle == "a")
    assert record.revenue == pytest.approx(0.3 * 9.0)


def test_leaving_early_with_time_enough_changes_the_time_only():
    after, happening = told(begun(), event("leaves_early", subject="a", until_interval=2))
    assert [r.promised_kwh for r in happening.revisions] == [0]
    done = run_day(after, P1)
    assert (entries(done)["a"].status, entries(done)["a"].revised_by_interval) == ("kept", 2)


def test_who_does_not_come_is_charged_no_more_and_no_promise_is_broken():
    after, _ = told(begun(), event("no_show", subject="a"))
    assert [c.vehicle for c in after.state.contracts] == ["b"]
    done = run_day(after, P1)
    assert (entries(done)["a"].status, entries(done)["a"].delivered_kwh) == ("released", 4.0)
    assert totals(done).broken == 0


def test_who_is_late_waits_and_p1_plans_around_it():
    after, happening = told(begun(), event("late", subject="a", from_interval=2))
    assert [r.promised_kwh for r in happening.revisions] == [0]
    assert after.state.tail_kw[0, 0] == 0
    done = run_day(after, P1)
    assert [s.plan.report.status for s in done.steps] == ["optimal"] * 5
    row = [s.plan.power_kw[s.plan.vehicles.index("a"), 0] for s in done.steps[:3]]
    assert row == pytest.approx([4.0, 0.0, 8.0])


def test_who_is_back_at_once_has_changed_nothing_and_may_not_be_blamed():
    late = event("late", subject="a", from_interval=1)
    _, happening = told(begun(), late, event("chargers", value=0))
    assert [r.short_kwh for r in happening.revisions] == pytest.approx([8.0, 8.0])


def test_more_is_granted_as_far_as_promises_leave_room():
    trace = begun([4, 4, 4], **with_headroom([30.0, 9.0, 9.0, 0.0, 0.0]))
    after, happening = told(trace, event("asks_more", subject="a", value=5.0))
    assert [r.promised_kwh for r in happening.revisions] == pytest.approx([2.0])
    assert "a gets 2.00 of 5 kWh more" in happening.note
    done = run_day(after, P1)
    entry = entries(done)["a"]
    assert (entry.status, entry.promised_kwh) == ("kept", 12.0)
    assert entry.revised_kwh == pytest.approx(14.0)
    assert entries(done)["b"].changes == ()


def test_more_than_the_battery_holds_is_not_granted():
    _, happening = told(begun(), event("asks_more", subject="a", value=50.0))
    # a battery of 24 kWh came a quarter full: 6 beyond the 12 promised
    assert [r.promised_kwh for r in happening.revisions] == pytest.approx([6.0])


@pytest.mark.parametrize("subject", ["c", "nobody"])
def test_an_event_of_a_vehicle_without_an_open_contract_changes_nothing(subject):
    trace = begun()
    after, happening = told(trace, event("no_show", subject=subject))
    assert happening.revisions == ()
    assert f"{subject} has no contract that is open" in happening.note
    assert after.state.contracts == trace.state.contracts


def test_an_event_of_the_scenario_is_the_same_as_one_told_on_the_way():
    failing = event("chargers_fail", value=2)
    planned = run_day(start_day(two_cars(events=[failing.model_dump()])), P1)
    live = run_day(happen(step(start_day(two_cars()), P1), [failing]), P1)
    assert without_times(planned) == without_times(live)
    assert planned.happenings[0].revisions == live.happenings[0].revisions
    assert live.inputs.given.events == (failing,)


def test_nobody_knows_of_an_event_before_its_interval():
    rated = event("rating", subject="node:a", value=1.0, interval=2)
    more = event("load_factor", value=3.0, interval=2)
    with_events = run_day(start_day(two_cars(events=[rated.model_dump(), more.model_dump()])), P1)
    without = run_day(start_day(two_cars()), P1)
    assert without_times(with_events)[:2] == without_times(without)[:2]
    snapshot = snapshot_of(with_events.steps[1].inputs, with_events.steps[1].before)
    plain = snapshot_of(without.steps[1].inputs, without.steps[1].before)
    assert np.array_equal(snapshot.rows.limit_kw, plain.rows.limit_kw)


def test_seeing_what_would_happen_changes_nothing():
    trace = begun()
    before = without_times(trace), trace.state, trace.inputs
    happen(trace, [event("chargers", value=0)])
    assert before == (without_times(trace), trace.state, trace.inputs)


def test_events_of_another_time_are_refused():
    with pytest.raises(InputError, match="should be 1"):
        happen(begun(), [event("chargers", value=0, interval=2)])
    over = run_day(begun(), P1)
    with pytest.raises(InputError):
        happen(over, [event("chargers", value=0, interval=5)])


def test_back_and_on_again_has_the_event_still_and_further_back_undoes_it():
    after = step(happen(begun(), [event("chargers", value=0)]), P1)
    back = undone(after)
    assert back.now == 1
    assert len(back.happenings) == 1
    assert without_times(step(back, P1)) == without_times(after)
    assert undone(back).happenings == ()
    assert undone(back).inputs.given.events == ()


def test_an_edit_after_an_event_keeps_the_event():
    after = happen(begun(), [event("chargers_fail", value=1)])
    option = after.scenario.option[0].model_copy(update={"price_per_kwh": 0.9})
    given = after.inputs.given.replacing(option=(option, *after.scenario.option[1:]))
    edited = revise(after, given)
    assert edited.scenario.station.chargers == 2
    assert edited.inputs.given.station.chargers == 3


@pytest.mark.parametrize("failure", [SolverFailure("no time"), RuntimeError("crash")])
def test_where_the_optimiser_fails_who_came_last_is_switched_off_first(monkeypatch, failure):
    def failing(problem, seconds):
        raise failure

    monkeypatch.setattr(recourse, "least_shortfall", failing)
    trace = begun([2, 5, 5])
    after, happening = told(trace, event("chargers", value=1))
    assert recourse.SHED in happening.note
    assert not happening.proven
    assert after.state.contracts[0].vehicle == "a"
    done = run_day(after, P1)
    assert entries(done)["a"].status == "kept"
    assert [b for b in linear_breaches(done) if b.by_station] == []
    assert {s.plan.report.status for s in done.steps} == {"optimal"}


def test_a_line_can_lose_rating_and_everything_stays_within_it():
    fields = {
        "nodes": (node("s"), node("a", load_kw=10.0)),
        "lines": (line("s", "a", 0.1, 0.1, 100.0),),
    }
    trace = begun([2, 5, 5], **fields)
    after, happening = told(trace, event("rating", subject="line:s-a", value=17.0))
    assert happening.short_kwh > 0
    done = run_day(after, P1)
    assert done.scenario.lines[0].rating_kva == 17.0
    assert [b for b in linear_breaches(done) if b.by_station] == []
    assert max(s.station_kw for s in done.steps[1:]) > 1
