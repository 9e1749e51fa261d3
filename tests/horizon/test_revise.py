"""Editing a day under way: the past stays, promises stay, the rest follows the new inputs."""

from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.random_days import random_scenario
from benchmarks.soundness import contracts_made, executed_power, problems_of_day, without_times
from evdash.domain.plan import Plan
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.errors import ImpossibleCommitments, InputError
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import run_day, start_day, step
from evdash.horizon.networks import limit_check
from evdash.horizon.requests import first_interval
from evdash.horizon.revise import revise
from evdash.metrics.records import executed_station_kw
from evdash.metrics.service import totals
from evdash.scheduling.p1 import p1_policy
from tests.builders import PRESETS, generator, make_scenario, vehicle
from tests.horizon.days import with_headroom

P1 = p1_policy()


def stepped(scenario: Scenario, steps: int) -> Trace:
    trace = start_day(scenario)
    for _ in range(steps):
        trace = step(trace, P1)
    return trace


def edited(trace: Trace, settings=None, price_per_kwh=None) -> Trace:
    return revise(trace, edit_scenario(trace.scenario, settings or {}, price_per_kwh))


def drawn_day(**changes) -> Scenario:
    arrivals = generator(**{"vehicles_per_day": 80.0} | changes)
    return make_scenario(price=[0.1] * 12, arrivals=arrivals)


def two_cars(**fields) -> Scenario:
    """Two contracts of 16 kWh over four intervals, room and chargers for both at once."""
    vehicles = [vehicle(name, need_kwh=16.0, option="C2") for name in ("a", "b")]
    return make_scenario(**{"price": [0.1, 0.1, 0.1, 0.1], "vehicles": vehicles} | fields)


def test_before_the_first_step_the_whole_day_changes():
    day = drawn_day()
    other = edit_scenario(day, {"arrivals.seed": 5, "station.chargers": 1})
    after = revise(start_day(day), other)
    assert after.inputs.requests == start_day(other).inputs.requests
    assert (after.scenario, after.steps) == (other, ())


def test_the_past_stays_and_every_step_keeps_the_inputs_in_force():
    trace = stepped(drawn_day(), 4)
    after = step(edited(trace, {"station.chargers": 5}, [0.2] * 12), P1)
    assert after.steps[:4] == trace.steps
    assert [s.inputs.scenario.station.chargers for s in after.steps] == [3, 3, 3, 3, 5]
    assert [float(s.inputs.scenario.price_per_kwh[0]) for s in after.steps] == [0.1] * 4 + [0.2]
    assert trace.scenario.station.chargers == 3


@pytest.mark.parametrize(
    "settings", [{"arrivals.seed": 99}, {"arrivals.vehicles_per_day": 160.0}, {}]
)
@pytest.mark.parametrize("now", [1, 5, 11])
def test_arrivals_are_redrawn_only_from_the_interval_being_decided(settings, now):
    trace = stepped(drawn_day(), now)
    after = edited(trace, settings)
    assert after.inputs.requests[:now] == trace.inputs.requests[:now]
    fresh = start_day(after.scenario).inputs

    def coming(inputs, since):
        return [
            (a.arrival, a.soc_in, a.battery_kwh)
            for a in inputs.arrivals
            if first_interval(inputs.scenario, a.arrival) >= since
        ]

    assert coming(after.inputs, now) == coming(fresh, now)
    if settings and now < 11:
        assert after.inputs.requests[now:] != trace.inputs.requests[now:]
    else:
        assert settings or after.inputs.requests == trace.inputs.requests
    names = [a.vehicle for a in after.inputs.arrivals]
    assert names == [f"PEV-{n:03d}" for n in range(1, len(names) + 1)]
    asked = sorted(r.vehicle for group in after.inputs.requests for r in group)
    assert asked == sorted(names)


def test_an_edit_that_changes_nothing_changes_nothing():
    trace = stepped(drawn_day(), 5)
    assert without_times(run_day(edited(trace), P1)) == without_times(run_day(trace, P1))


def test_prices_and_options_leave_contracts_their_terms():
    trace = stepped(drawn_day(), 4)
    assert trace.state.contracts
    settings = {"option.C1.price_per_kwh": 0.9, "option.C2.average_kw": 9.0}
    after = edited(trace, settings, [0.5] * 12)
    assert after.state == trace.state
    assert contracts_made(run_day(after, P1)).items() >= contracts_made(trace).items()
    coming = [r for group in after.inputs.requests[4:] for r in group]
    assert {r.price_per_kwh for r in coming} == {0.9, 0.3}


def test_an_option_can_be_taken_away_from_who_is_still_to_come():
    trace = stepped(drawn_day(), 6)
    raw = trace.scenario.model_dump()
    raw["option"] = [option for option in raw["option"] if option["name"] == "C1"]
    raw["arrivals"]["option_share"] = {"C1": 1.0}
    after = run_day(revise(trace, Scenario.model_validate(raw)), P1)
    assert "C2" in {c.request.option for c in trace.state.contracts}
    assert after.inputs.requests[:6] == trace.inputs.requests[:6]
    assert {r.option for group in after.inputs.requests[6:] for r in group} == {"C1"}
    assert problems_of_day(after, same_inputs=False) == []


def test_chargers_lowered_under_the_tail_move_the_schedule_and_keep_the_promise():
    trace = step(start_day(two_cars()), lambda s: with_power(P1(s), [7, 3, 3, 3]))
    assert trace.state.tail_kw.tolist() == [[3, 3, 3], [3, 3, 3]]
    after = edited(trace, {"station.chargers": 1, "station.max_kw": 19.0})
    assert (after.state.tail_kw > 0).sum(axis=0).max() == 1
    assert after.state.contracts == trace.state.contracts
    done = run_day(after, P1)
    assert problems_of_day(done, same_inputs=False) == []
    assert {name: row.sum() for name, row in executed_power(done).items()} == pytest.approx(
        {"a": 16.0, "b": 16.0}
    )


def with_power(plan: Plan, each: list[float]) -> Plan:
    """The plan with every vehicle charged alike."""
    return replace(plan, power_kw=np.array([each] * len(plan.vehicles), dtype=float))


def test_chargers_lowered_too_far_are_answered_with_what_it_would_cost():
    """After 4 kWh each, 12 are owed; two intervals of one charger at 10 kW give 20 of 24."""
    trace = step(start_day(two_cars(price=[0.1] * 3)), lambda s: with_power(P1(s), [4, 6, 6]))
    before = without_times(trace), trace.state, trace.inputs
    with pytest.raises(ImpossibleCommitments) as caught:
        edited(trace, {"station.chargers": 1})
    missing = {s.vehicle: s.missing_kwh for s in caught.value.shortfalls}
    assert sum(missing.values()) == pytest.approx(4.0, abs=1e-6)
    assert set(missing) <= {"a", "b"}
    assert all(name in str(caught.value) for name in missing)
    assert before == (without_times(trace), trace.state, trace.inputs)
    assert problems_of_day(run_day(trace, P1)) == []


def test_every_charger_taken_away_costs_all_that_is_owed():
    trace = stepped(two_cars(), 1)
    owed = {c.vehicle: c.owed_kwh for c in trace.state.contracts}
    with pytest.raises(ImpossibleCommitments) as caught:
        edited(trace, {"station.chargers": 0})
    assert {s.vehicle: s.missing_kwh for s in caught.value.shortfalls} == pytest.approx(owed)


def test_headroom_taken_away_is_answered_too_and_given_back_is_used():
    room = with_headroom([20.0] * 4)
    trace = stepped(two_cars(**room), 1)
    with pytest.raises(ImpossibleCommitments):
        edited(trace, {"feeder.load_scale": 1.9})
    wider = run_day(edited(trace, {"feeder.load_scale": 0.5, "station.chargers": 9}), P1)
    assert problems_of_day(wider, same_inputs=False) == []


def test_more_chargers_let_more_in_from_then_on():
    day = drawn_day(vehicles_per_day=200.0)
    few = run_day(stepped(day, 4), P1)
    more = run_day(edited(stepped(day, 4), {"station.chargers": 12}), P1)
    assert problems_of_day(more, same_inputs=False) == []
    assert len(contracts_made(more)) > len(contracts_made(few))


def test_one_edit_after_another():
    trace = stepped(drawn_day(), 2)
    for settings in ({"arrivals.seed": 3}, {"station.chargers": 6}, {"arrivals.seed": 4}):
        trace = step(edited(trace, settings), P1)
    assert [s.inputs.scenario.station.chargers for s in trace.steps] == [3, 3, 3, 6, 6]
    seeds = [s.inputs.scenario.arrivals.seed for s in trace.steps]
    assert seeds == [1, 1, 3, 3, 4]
    done = run_day(trace, P1)
    assert problems_of_day(done, same_inputs=False) == []
    assert len({a.vehicle for a in done.inputs.arrivals}) == len(done.inputs.arrivals)
    assert [len(s.requests) for s in done.steps] == [len(g) for g in done.inputs.requests[:-1]]


def test_before_the_last_interval_an_edit_still_counts():
    trace = stepped(drawn_day(vehicles_per_day=300.0), 11)
    done = run_day(edited(trace, {"arrivals.seed": 8, "station.chargers": 9}), P1)
    assert done.steps[:11] == trace.steps
    assert done.steps[11].inputs.scenario.station.chargers == 9
    assert done.steps[11].requests != trace.inputs.requests[11]
    assert problems_of_day(done, same_inputs=False) == []


def test_after_the_last_interval_nothing_is_left_to_change():
    trace = run_day(start_day(drawn_day(vehicles_per_day=300.0)), P1)
    after = edited(trace, {"arrivals.seed": 8, "station.chargers": 0})
    assert (after.steps, after.state) == (trace.steps, trace.state)
    assert after.inputs.requests == trace.inputs.requests
    assert after.inputs.requests[12], "who came too late stays, too"
    assert after.scenario.station.chargers == 0


@pytest.mark.parametrize("key", ["start", "interval_minutes", "intervals"])
def test_the_clock_of_a_day_under_way_stays(key):
    trace = stepped(drawn_day(), 2)
    others = {"start": "2024-05-06T01:00", "interval_minutes": 30, "intervals": 11}
    raw = trace.scenario.model_dump() | {key: others[key]}
    with pytest.raises(InputError, match=key):
        revise(trace, Scenario.model_validate(raw))


def test_a_name_that_has_come_cannot_come_again():
    trace = stepped(two_cars(), 1)
    later = trace.scenario.arrivals.vehicles[0].model_copy(
        update={"arrival": trace.scenario.time_of(2)}
    )
    arrivals = trace.scenario.arrivals.model_copy(update={"vehicles": (later,)})
    with pytest.raises(InputError, match="'a'; has come already"):
        revise(trace, trace.scenario.replacing(arrivals=arrivals))


@pytest.mark.parametrize("seed", [2, 15, 17, 22])
def test_random_days_keep_every_promise_through_edits_at_every_turn(seed):
    trace = start_day(random_scenario(seed))
    while not trace.is_over:
        chargers = max(1, trace.scenario.station.chargers + (-1) ** trace.now * (trace.now % 3))
        settings = {"arrivals.seed": trace.now, "station.chargers": chargers}
        prices = [-price for price in trace.scenario.price_per_kwh.tolist()]
        with suppress(ImpossibleCommitments):  # then not applied: the day goes on as it was
            trace = edited(trace, settings, prices)
        trace = step(trace, P1)
    assert contracts_made(trace)
    assert problems_of_day(trace, same_inputs=False) == []


def test_the_network_model_can_change_in_mid_day():
    scenario = read_scenario(PRESETS / "summer-weekday")
    trace = stepped(scenario, 16)
    changed = revise(trace, scenario, "ac")
    assert changed.steps == trace.steps
    assert changed.inputs.network == "ac"
    assert (changed.inputs.rows.headroom_kw() < trace.inputs.rows.headroom_kw()).all()
    check = limit_check(changed.inputs)
    ended = run_day(changed, P1)
    assert totals(ended).broken == 0
    breaches = check.breaches(executed_station_kw(ended))
    assert not [b for b in breaches if b.by_station and b.interval >= 16]
    assert revise(changed, scenario).inputs.network == "ac"
    back = revise(changed, scenario, "lindistflow")
    assert np.array_equal(back.inputs.rows.limit_kw, trace.inputs.rows.limit_kw)
