"""Prompts and guests: what they do, and that what is said of it is so."""

import re
from dataclasses import replace

import pytest

from evdash.domain.arrivals import Arrival
from evdash.domain.events import Event
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.errors import InputError
from evdash.files.bundled import DEFAULT, bundled_scenarios
from evdash.horizon.day import run_day, start_day, step
from evdash.horizon.guests import guest_name, joined
from evdash.metrics.records import vehicle_records
from evdash.metrics.service import totals
from evdash.ui.run import Run, edited, open_run, stepped, visited
from evdash.ui.session import Session, bundled, bundled_names
from evdash.ui.solving import policy
from evdash.ui.whatif import prompts
from tests.app.test_live_page import clicked, opened, session


def begun(steps: int = 0, preset: str = DEFAULT.name) -> Run:
    folder = bundled_names()[preset]
    run = open_run(folder, bundled(folder))
    for _ in range(steps):
        run = stepped(run, policy)
    return run


def pressed(run: Run, key: str) -> Session:
    session = Session(run)
    session.press(key)
    return session


@pytest.mark.parametrize("steps", [0, 10])
def test_the_peak_price_doubles_from_now_on(steps: int) -> None:
    run = begun(steps)
    old = run.trace.scenario.price_per_kwh
    new = pressed(run, "dearer_peak").run.trace.scenario.price_per_kwh
    peak = int(old.argmax())
    assert new[peak] == 2 * old[peak]
    assert ((new == old) | (new == 2 * old)).all()
    assert int((new != old).sum()) == 1


def test_two_chargers_go_unless_a_promise_needs_them() -> None:
    assert pressed(begun(), "fewer_chargers").run.trace.scenario.station.chargers == 10
    few = edited(begun(), "chargers", {"station.chargers": 1})
    assert next(p for p in prompts(few) if p.key == "fewer_chargers").change is None
    busy = edited(begun(), "chargers", {"station.chargers": 4})
    for _ in range(21):
        busy = stepped(busy, policy)
    refused = pressed(busy, "fewer_chargers")
    assert refused.run.answer is not None
    assert refused.prompted is None


def test_everyone_picks_the_first_option_from_now_on() -> None:
    run = begun(12)
    later = pressed(run, "everyone_picks").run.trace.inputs
    coming = [r.option for group in later.requests[12:] for r in group]
    assert set(coming) == {"C1"}
    assert later.requests[:12] == run.trace.inputs.requests[:12]


@pytest.mark.parametrize(("steps", "there"), [(0, True), (10, True), (18, True), (19, False)])
def test_a_charger_fails_at_six_and_not_before(steps: int, there: bool) -> None:
    run = begun(steps)
    prompt = next(prompt for prompt in prompts(run) if prompt.key == "failure")
    assert (prompt.change is not None) == there
    if there:
        trace = run_day(pressed(run, "failure").run.trace, policy)
        assert trace.steps[17].inputs.scenario.station.chargers == 12
        assert trace.steps[18].inputs.scenario.station.chargers == 11


def test_before_and_after_are_both_days_run_to_their_ends() -> None:
    run = begun(14)
    prompted = pressed(run, "everyone_picks").prompted
    assert prompted is not None
    before, after = prompted.effects
    day = totals(run_day(run.trace, policy))
    assert before["Admitted"] == f"{day.admitted} of {day.arrived}"
    assert before["Profit"] == f"${day.profit:,.2f}"
    assert after != before


def changed_by_hand(scenario: Scenario, key: str) -> Scenario:
    """What a prompt makes of a day that has not begun, written down without the prompts."""
    prices = scenario.price_per_kwh.tolist()
    dear = [price >= 0.95 * max(prices) for price in prices]
    station = scenario.station
    fewer = station.model_copy(update={"chargers": station.chargers - 2})
    first = scenario.arrivals.model_copy(update={"option_share": {"C1": 1.0, "C2": 0.0}})
    fails = {"interval": 18, "event": "chargers_fail", "value": 1}
    rows = tuple(
        row.model_copy(update={"price_per_kwh": row.price_per_kwh * (1 + twice)})
        for row, twice in zip(scenario.profile, dear, strict=True)
    )
    made = {
        "dearer_peak": {"profile": rows},
        "fewer_chargers": {"station": fewer},
        "everyone_picks": {"arrivals": first},
        "failure": {"events": (Event.model_validate(fails),)},
    }
    return scenario.replacing(**made[key])


def as_told(trace: Trace) -> dict[str, str]:
    """A day's totals as the table has them, summed up here from vehicles and steps."""
    mine = [r for r in vehicle_records(trace) if r.status != "refused"]
    cost = sum(s.station_kw * s.inputs.scenario.price_per_kwh[s.interval] for s in trace.steps)
    revenue = sum(r.promised_kwh * r.request.price_per_kwh for r in mine if r.status == "charged")
    revenue += sum(r.delivered_kwh * r.request.price_per_kwh for r in mine if r.status == "broken")
    broken = sum(r.delivered_kwh < r.promised_kwh - 0.01 for r in mine)
    return {
        "Admitted": f"{len(mine)} of {len(vehicle_records(trace))}",
        "Broken promises": f"{broken}",
        "Delivered": f"{sum(s.station_kw for s in trace.steps):,.0f} kWh",
        "Highest station load": f"{max(s.station_kw for s in trace.steps):,.0f} kW",
        "Revenue": f"${revenue:,.2f}",
        "Energy cost": f"{'−' if cost < 0 else ''}${abs(cost):,.2f}",
        "Profit": f"${revenue - cost:,.2f}",
    }


@pytest.mark.parametrize("key", ["dearer_peak", "fewer_chargers", "everyone_picks", "failure"])
@pytest.mark.parametrize("preset", [folder.name for folder in bundled_scenarios()])
def test_every_prompt_tells_both_days_as_they_are(preset: str, key: str) -> None:
    run = begun(0, preset)
    there = pressed(run, key)
    assert there.prompted is not None
    before, after = there.prompted.effects
    by_hand = run_day(start_day(changed_by_hand(run.trace.scenario, key)), policy)
    assert before == {"By the end of the day": "Before"} | as_told(run_day(run.trace, policy))
    assert after == {"By the end of the day": "After"} | as_told(by_hand)


@pytest.mark.parametrize("steps", [0, 16, 24])
@pytest.mark.parametrize("preset", [folder.name for folder in bundled_scenarios()])
def test_the_hours_named_as_dearest_are_those_whose_price_doubles(preset: str, steps: int) -> None:
    run = begun(steps, preset)
    prompt = next(prompt for prompt in prompts(run) if prompt.key == "dearer_peak")
    old, new = (
        there.trace.scenario.price_per_kwh for there in (run, pressed(run, "dearer_peak").run)
    )
    dear = [t for t in range(len(old)) if new[t] != old[t]]
    first = 0 if run.trace.is_over else steps
    assert f"{old[first:].max():.3g} \\$/kWh" in prompt.help
    for begin, end in re.findall(r"from (\d\d:\d\d).*? to (\d\d:\d\d)", prompt.help):
        hours = range(int(begin[:2]), int(end[:2]))
        assert {t % 24 for t in dear} & set(hours) == set(hours)
        dear = [t for t in dear if t % 24 not in hours]
    assert dear == []


def test_what_a_prompt_did_is_told_as_what_it_was_once_the_run_goes_on() -> None:
    there = pressed(begun(10), "fewer_chargers")
    assert there.prompted is not None
    assert "Undo takes it back" in there.prompted.told(there.run)
    there.step()
    later = there.prompted.told(there.run)
    assert "pressed at 10:00" in later
    assert "nothing else is changed" in later
    assert "Undo" not in later
    over = pressed(begun(24), "everyone_picks")
    assert over.prompted is not None
    assert "day is run again" in over.prompted.told(over.run)
    over.reset()
    assert "pressed at end" not in over.prompted.told(over.run)
    assert "once the day was over" in over.prompted.told(over.run)


def test_a_prompt_is_pressed_told_and_undone_in_the_page() -> None:
    at = opened(steps=2)
    before = session(at).run.trace
    clicked(at, "prompt_fewer_chargers")
    assert session(at).run.trace.scenario.station.chargers == 10
    assert any("By the end of the day" in text.value for text in at.markdown)
    clicked(at, "undo")
    assert session(at).run.trace is before
    assert not any("By the end of the day" in text.value for text in at.markdown)


def guest(trace, **fields) -> Arrival:
    told = {"option": "C1", "battery_kwh": 40.0, "soc_in": 0.5, "soc_out": 0.8, "max_kw": 11.0}
    when = trace.scenario.time_of(min(trace.now, trace.scenario.intervals - 1))
    return Arrival(**{"vehicle": guest_name(trace), "arrival": when} | told | fields)


def test_a_guest_is_decided_with_the_others_and_survives_an_edit() -> None:
    trace = begun(10).trace
    there = joined(joined(trace, guest(trace)), guest(joined(trace, guest(trace))))
    names = [request.vehicle for request in there.inputs.requests[10]]
    assert names[-2:] == ["Guest-1", "Guest-2"]
    run = edited(replace(begun(10), trace=there), "seed", {"arrivals.seed": 7})
    decided = step(run.trace, policy).steps[-1]
    assert {"Guest-1", "Guest-2"} <= {*decided.plan.admitted}
    assert len(decided.requests) == len({request.vehicle for request in decided.requests})
    over = run_day(run.trace, policy)
    answered = [request.vehicle for taken in over.steps for request in taken.requests]
    assert len(answered) == len(set(answered))
    assert totals(over).broken == 0


def test_a_guest_that_cannot_be_is_refused_in_words() -> None:
    run = begun(3)
    there = visited(run, guest(run.trace, option="C9", soc_in=0.9))
    assert there.trace is run.trace
    assert there.answer is not None
    assert {fault.place for fault in there.answer.faults} == {"option", "soc_out"}
    over = run_day(run.trace, policy)
    with pytest.raises(InputError, match="day"):
        joined(over, guest(over))


def test_a_vehicle_is_asked_for_in_the_page() -> None:
    at = clicked(opened(steps=1), "add_pev")
    assert any(button.label == "Ask for a charge" for button in at.button)
