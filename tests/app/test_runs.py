"""A run is immutable: each change gives a new one, and one that cannot be made changes nothing."""

from dataclasses import replace

import pytest

from evdash.domain.events import Event
from evdash.domain.plan import Plan, Snapshot
from evdash.errors import Fault
from evdash.files.bundled import DEFAULT, bundled_scenarios
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import run_day
from evdash.metrics.outlook import outlook
from evdash.metrics.service import totals
from evdash.ui.run import (
    Run,
    edited,
    foreseen,
    open_run,
    restarted,
    restored,
    stepped,
    stepped_back,
)
from evdash.ui.session import Session
from evdash.ui.settings import all_controls, curve_for, edit_log, prices_from_now
from evdash.ui.solving import Turns, policy, shared
from evdash.ui.whatif import Prompted, prompts


@pytest.fixture
def run() -> Run:
    return open_run(DEFAULT, read_scenario(DEFAULT))


def after(run: Run, steps: int) -> Run:
    for _ in range(steps):
        run = stepped(run, policy)
    return run


def test_a_step_leaves_the_run_it_came_from_as_it_was(run: Run) -> None:
    later = stepped(run, policy)
    assert (run.trace.now, later.trace.now) == (0, 1)
    assert later.trace.steps[0].inputs is run.trace.inputs


def test_a_day_that_is_over_does_not_step(run: Run) -> None:
    over = after(run, 24)
    assert over.trace.is_over
    assert stepped(over, policy) is over


def test_back_and_step_give_the_same_step_again(run: Run) -> None:
    there = after(run, 18)
    again = stepped(stepped_back(there), policy)
    assert again.trace.now == there.trace.now
    assert (again.trace.state.tail_kw == there.trace.state.tail_kw).all()
    assert stepped_back(run) is run


def test_back_undoes_edits_made_since(run: Run) -> None:
    there = edited(after(run, 10), "chargers", {"station.chargers": 9})
    assert there.trace.scenario.station.chargers == 9
    assert stepped_back(there).trace.scenario.station.chargers == 12


def test_an_edit_before_the_first_step_changes_the_day(run: Run) -> None:
    fewer = edited(run, "arrivals", {"arrivals.vehicles_per_day": 20.0})
    assert len(fewer.trace.inputs.arrivals) < len(run.trace.inputs.arrivals)


def test_an_edit_in_mid_day_leaves_the_past(run: Run) -> None:
    there = after(run, 15)
    other = edited(there, "seed", {"arrivals.seed": 7})
    assert other.trace.steps == there.trace.steps
    known = len([r for step in there.trace.steps for r in step.requests])
    assert other.trace.inputs.arrivals[:known] == there.trace.inputs.arrivals[:known]
    assert other.trace.inputs.arrivals[known:] != there.trace.inputs.arrivals[known:]


def test_an_impossible_edit_is_answered_and_not_applied(run: Run) -> None:
    there = after(run, 18)
    refused = edited(there, "no chargers", {"station.chargers": 0})
    assert refused.trace is there.trace
    assert refused.answer is not None
    assert refused.answer.shortfalls
    assert all(shortfall.missing_kwh > 0 for shortfall in refused.answer.shortfalls)
    assert stepped(refused, policy).answer is None


def test_a_wrong_edit_is_answered_with_every_fault(run: Run) -> None:
    wrong = edited(run, "C1", {"option.C1.average_kw": -1.0, "station.chargers": -3})
    assert wrong.trace is run.trace
    assert wrong.answer is not None
    assert len(wrong.answer.faults) == 2


def test_reset_keeps_settings_and_restore_returns_them(run: Run) -> None:
    there = edited(after(run, 5), "chargers", {"station.chargers": 9})
    fresh = restarted(there)
    assert (fresh.trace.now, fresh.trace.scenario.station.chargers) == (0, 9)
    assert restored(fresh).trace.scenario.station.chargers == 12


def test_settings_are_restored_for_the_next_run_of_a_day_that_is_over(run: Run) -> None:
    there = edited(after(run, 12), "chargers", {"station.chargers": 9})
    over = after(there, 24)
    assert over.trace.is_over
    back = restored(over)
    assert back.answer is None
    assert back.trace.steps is over.trace.steps
    assert restarted(back).trace.scenario.station.chargers == 12


def test_the_log_tells_choices_of_drivers_and_what_is_foreseen(run: Run) -> None:
    there = edited(run, "C1", {"arrivals.option_share.C1": 1.0, "arrivals.option_share.C2": 0.0})
    row = {"interval": 18, "event": "chargers_fail", "value": 1}
    there = foreseen(there, "a charger fails", Event.model_validate(row))
    log = edit_log(there.trace, there.opened, outlook(there.trace))
    assert [told.replace("\\", "") for told in log] == [
        "**from 00:00:** drivers who choose C1, % 40 → 100; drivers who choose C2, % 60 → 0",
        "**at 18:00:** 1 of the chargers stops working",
    ]


def test_a_prompt_after_the_day_is_told_for_its_next_run(run: Run) -> None:
    over = after(run, 24)
    fewer = next(prompt for prompt in prompts(over) if prompt.key == "fewer_chargers")
    assert fewer.change is not None
    before, changed = Prompted(fewer.label, over, fewer.change(over)).effects
    fresh = restarted(edited(run, "chargers", {"station.chargers": 10}))
    there = totals(run_day(fresh.trace, policy))
    assert changed["Admitted"] == f"{there.admitted} of {there.arrived}"
    assert before["Profit"] != changed["Profit"]


def test_the_log_says_what_is_in_force_since_when(run: Run) -> None:
    there = edited(after(run, 14), "chargers", {"station.chargers": 9})
    there = after(there, 2)
    prices = prices_from_now(there.trace, tuple([0.5] * 24))
    there = edited(there, "prices", {}, prices)
    log = edit_log(there.trace, there.opened, outlook(there.trace))
    assert log == [
        "**from 14:00:** Chargers 12 → 9",
        "**from 16:00:** energy price of 8 intervals",
    ]
    assert edit_log(run.trace, run.opened, outlook(run.trace)) == []


def test_curves_of_other_presets_fit_by_the_clock() -> None:
    scenarios = {folder.name: read_scenario(folder) for folder in bundled_scenarios()}
    longer = scenarios["past-midnight"]
    curve = curve_for(longer, scenarios["price-spike"])
    spike = scenarios["price-spike"].price_per_kwh.tolist()
    assert list(curve) == spike + spike[:6]


@pytest.mark.parametrize("folder", bundled_scenarios(), ids=lambda folder: folder.name)
def test_help_and_bounds_are_the_declarations(folder) -> None:
    controls = {c.key: c for c in all_controls(read_scenario(folder))}
    assert len(controls) == 7
    for control in controls.values():
        assert control.help.strip(". ")
        assert control.read(f"{control.value}") == control.value
        assert isinstance(control.read("-1"), Fault)
    assert "How many vehicles can charge" in controls["station.chargers"].help
    assert controls["station.chargers"].read("100000") == 100_000
    assert isinstance(controls["station.chargers"].read("100001"), Fault)


def test_a_snapshot_seen_before_is_not_solved_again(run: Run) -> None:
    solved = []

    def counting(snapshot: Snapshot) -> Plan:
        solved.append(snapshot.now)
        return policy(snapshot)

    once = shared(counting, Turns(2), most_plans=3)
    there = run
    for _ in range(3):
        there = stepped(there, once)
    for _ in range(3):
        there = stepped_back(there)
    for _ in range(3):
        there = stepped(there, once)
    assert solved == [0, 1, 2]
    after_others = stepped(there, once)  # the oldest plan makes room
    assert len(solved) == 4
    assert after_others.trace.now == 4


def test_a_session_draws_anew_only_for_another_trace(run: Run) -> None:
    session = Session(run)
    drawn: list[int] = []

    def draw() -> int:
        drawn.append(1)
        return len(drawn)

    assert [session.once("a", draw), session.once("a", draw)] == [1, 1]
    session.run = replace(session.run, answer=None)
    assert session.once("a", draw) == 1
    assert session.once("a", draw, detail="kW") == 2
    session.step()
    assert session.once("a", draw, detail="kW") == 3


def test_totals_are_those_of_the_same_day_run_at_once(run: Run) -> None:
    sums = totals(after(run, 24).trace)
    assert (sums.admitted, sums.arrived, sums.broken) == (51, 99, 0)
