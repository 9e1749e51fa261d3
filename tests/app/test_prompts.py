"""Prompts, guests and prepared cases: what they do, and that what the cases say is so."""

from dataclasses import replace

import pytest

from evdash.domain.scenario import Arrival
from evdash.errors import InputError
from evdash.files.bundled import DEFAULT
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import run_day, start_day, step
from evdash.horizon.guests import guest_name, joined
from evdash.metrics.outlook import outlook
from evdash.metrics.totals import totals
from evdash.ui.cases import CASES
from evdash.ui.run import Run, edited, open_run, stepped, visited
from evdash.ui.session import Session, bundled, bundled_names
from evdash.ui.solving import policy
from evdash.ui.whatif import prompts
from tests.app.test_live_page import clicked, now, opened, session


def begun(steps: int = 0, preset: str = DEFAULT.name) -> Run:
    folder = bundled_names()[preset]
    run = open_run(folder, bundled(folder))
    for _ in range(steps):
        run = stepped(run, policy)
    return run


def pressed(run: Run, key: str) -> Session:
    session = Session(run)
    session.press(next(prompt for prompt in prompts(run) if prompt.key == key))
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


def test_each_case_opens_its_day_and_can_be_closed() -> None:
    for number, case in enumerate(CASES):
        at = opened(steps=1)
        clicked(at, "cases")
        clicked(at, f"case_{number}")
        at.run()
        assert now(at) == 0
        assert session(at).run.folder is not None
        assert session(at).run.folder.name == case.preset
        assert any(case.question in text.value for text in at.markdown)
        clicked(at, "close_case")
        assert not any(case.question in text.value for text in at.markdown)


def test_what_the_cases_say_is_so() -> None:
    summer = run_day(start_day(read_scenario(bundled_names()["summer-weekday"])), policy)
    evening = summer.steps[18]
    assert round(outlook(summer).headroom_kw[18]) == 61
    assert evening.station_kw == pytest.approx(61, abs=2)
    assert int(evening.plan.charging[0]) < 12
    assert evening.plan.refused
    spike = run_day(start_day(read_scenario(bundled_names()["price-spike"])), policy)
    prices = spike.scenario.price_per_kwh[13:21]
    assert 1 < prices.min() < prices.max() < 1.565
    assert spike.scenario.price_per_kwh[[12, 21]].max() < 0.2
    assert sum(step.station_kw for step in spike.steps[13:20]) < 1
    assert totals(summer).admitted == pytest.approx(2 * totals(spike).admitted, abs=2)
    scenario = read_scenario(bundled_names()["voltage-limited"])
    linear, ac = (run_day(start_day(scenario, n), policy) for n in ("lindistflow", "ac"))
    assert outlook(linear).binding[18] == "voltage_min:652"
    assert outlook(ac).headroom_kw[16:20].max() < 0.01
    assert totals(ac).admitted < 0.7 * totals(linear).admitted


def test_a_vehicle_is_asked_for_in_the_page() -> None:
    at = clicked(opened(steps=1), "add_pev")
    assert any(button.label == "Ask for a charge" for button in at.button)
