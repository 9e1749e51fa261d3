"""Who decides, on the Live page: chosen, kept, told, explained and handed on truly."""

import json
import threading
from dataclasses import replace
from pathlib import Path

import pytest

from evdash.audit.audit import audit_run
from evdash.domain.plan import is_outside
from evdash.domain.trace import PAPERS
from evdash.errors import InputError
from evdash.explain.refusals import explain_vehicle
from evdash.files.bundled import DEFAULT
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import run_day, start_day
from evdash.policies import registry
from evdash.policies.outside import certified_for
from evdash.policies.race import SLOW
from evdash.policies.registry import RULES, Rule
from evdash.reports.account import account, verdict_on
from evdash.reports.words import decided_words
from evdash.store.parts import Kept, Putting, Taking
from evdash.ui import run as runs
from evdash.ui.cases.lecture import CASES
from evdash.ui.handon.files import RunLabel
from evdash.ui.keeping import run_of
from evdash.ui.live.decision import INTRODUCTION
from evdash.ui.reasons import BY_P1_ALONE, told_revision, told_why, told_worths
from evdash.ui.settings import settings_told
from evdash.ui.solving import decider, whole_day
from evdash.ui.whatif import Prompted, prompts
from tests.app.test_keeping import reopened
from tests.app.test_live_page import clicked, edit, now, opened, session
from tests.builders import make_scenario, vehicle

OURS = [name for name in RULES if name not in (*SLOW, PAPERS)]


def chosen(name, steps=0):
    at = opened()
    at.selectbox(key="decider").set_value(name).run()
    assert not at.exception
    return clicked(at, "step", steps)


def told(at):
    return " ".join(text.value for text in (*at.markdown, *at.caption, *at.error))


def afresh(name, scenario=None):
    """A run that a policy decides from the start."""
    run = runs.open_run(DEFAULT, scenario or read_scenario(DEFAULT))
    return runs.handed_to(run, name)


@pytest.mark.parametrize("name", OURS)
def test_a_day_stepped_here_is_the_day_of_the_command_line(name):
    run = afresh(name)
    while not run.trace.is_over:
        run = runs.decided(run)
        assert run.answer is None
    trace = start_day(read_scenario(DEFAULT), policy=name)
    alone = run_day(trace, RULES[name].make(trace.inputs), decide=RULES[name].decide)
    for mine, other in zip(run.trace.steps, alone.steps, strict=True):
        assert mine.plan.vehicles == other.plan.vehicles
        assert mine.plan.refused == other.plan.refused
        assert (mine.plan.power_kw == other.plan.power_kw).all()


def test_the_page_says_who_decides_and_nothing_where_that_is_p1():
    at = opened(steps=1)
    assert at.selectbox(key="decider").value == PAPERS
    assert "ecided by" not in told(at).replace("to be decided by", "")
    at.selectbox(key="decider").set_value("edf").run()
    assert now(at) == 0  # from its start
    assert "It will be decided by Earliest deadline first" in told(at)
    assert INTRODUCTION not in [text.value for text in at.markdown]
    assert "Charges who has to be back first" in told(at)
    clicked(at, "step", 3)
    assert "admitted**, decided by Earliest deadline first" in told(at)
    assert "restore" not in {one.key for one in at.button}  # a preset does not say who decides
    assert "decided by Earliest deadline first" in settings_told(session(at).run.trace)
    clicked(at, "finish")
    assert "admitted**, decided by Earliest deadline first" in told(at)


def test_undo_brings_back_who_decided_before_with_all_hours():
    at = opened(steps=2)
    at.selectbox(key="decider").set_value("llf").run()
    clicked(at, "step")
    clicked(at, "undo", 2)
    assert (now(at), session(at).run.trace.policy) == (2, PAPERS)
    assert at.selectbox(key="decider").value == PAPERS
    at.selectbox(key="decider").set_value("fcfs").run()
    clicked(at, "step", 2)
    clicked(at, "back")
    assert (now(at), session(at).run.trace.policy) == (1, "fcfs")
    clicked(at, "reset")
    assert (now(at), session(at).run.trace.policy) == (0, "fcfs")


def test_its_link_brings_back_who_decides():
    at = chosen("edf", steps=2)
    again = reopened(session(at).keeper.link)
    assert (now(again), again.selectbox(key="decider").value) == (2, "edf")
    clicked(again, "step")
    assert session(again).run.trace.policy == "edf"


def test_runs_kept_before_there_was_a_choice_are_p1s():
    trace = start_day(read_scenario(DEFAULT))
    taking = Taking({})
    manifest = json.loads(taking.manifest(Kept("a", trace.scenario, trace)))
    del manifest["trace"]["policy"]
    kept = Putting(taking.new.__getitem__).kept(json.dumps(manifest))
    assert kept.trace.policy == PAPERS


def test_one_that_is_not_installed_any_more_is_told_and_imports_nothing():
    trace = start_day(read_scenario(DEFAULT), policy="evdash_gone:policy")
    run = run_of(Kept("", trace.scenario, trace))
    tried = runs.decided(run)
    assert tried.trace is run.trace
    assert "evdash_gone:policy" in tried.answer.faults[0].found
    at = opened()
    session(at).take(run)
    at.run()
    assert at.selectbox(key="decider").value == "evdash_gone:policy"
    clicked(at, "finish")
    assert (now(at), session(at).mode) == (0, "idle")
    assert "one of your own counts where it is installed" in told(at)
    at.selectbox(key="decider").set_value(PAPERS).run()
    clicked(at, "step")
    assert now(at) == 1


def test_one_that_cannot_decide_such_a_day_is_not_handed_it():
    scenario = make_scenario(vehicles=[vehicle("a")])  # nothing tells who else may come
    run = runs.open_run(None, scenario)
    refused = runs.handed_to(run, "bid-price")
    assert refused.trace is run.trace
    assert "arrivals.forecast" in refused.answer.faults[0].place


@pytest.mark.parametrize("name", ["edf", "bid-price", "oracle", "uncoordinated"])
def test_what_if_and_edits_and_events_go_on_with_whoever_decides(name):
    at = chosen(name, steps=15)
    edit(at, "station.chargers", 9)
    assert session(at).run.answer is None
    clicked(at, "step")
    for key in ("prompt_dearer_peak", "prompt_failure"):
        if not at.button(key=key).disabled:
            clicked(at, key)
            assert session(at).prompted.after.trace.policy == name
    clicked(at, "step", 3)
    clicked(at, "finish")
    trace = session(at).run.trace
    assert trace.is_over
    assert trace.policy == name
    assert any(event.event == "chargers_fail" for event in trace.inputs.given.events)


def test_before_and_after_are_of_whoever_decides():
    run = afresh("fcfs")
    change = next(p.change for p in prompts(run) if p.key == "fewer_chargers")
    before, after = Prompted("Fewer", run, change(run)).effects
    alone = whole_day(run.trace)
    assert before["Admitted"] == f"{sum(len(s.plan.admitted) for s in alone.steps)} of 99"
    assert before != after | {"By the end of the day": "Before"}


def test_where_no_limit_is_kept_none_is_said_to_be():
    at = chosen("uncoordinated", steps=20)
    trace = session(at).run.trace
    assert "limits kept" not in settings_told(trace)
    assert "charging exceeds" in told(at)
    assert not {"rewire_to_ac", "again_in_ac"} & {one.key for one in at.button}
    before = session(at).run.trace
    edit(at, "option.C1.price_per_kwh", 0.5)  # breaks nothing that was not broken before
    assert session(at).run.answer is None
    assert session(at).run.trace is not before
    whole = whole_day(trace)
    label = RunLabel(whole.policy, whole.inputs.network, 1, 0.0)
    words = decided_words(account(whole, verdict_on(whole), label))
    assert "keeps no limit" in words[0]
    assert not any("Limits are kept" in line for line in words)


def test_a_refusal_by_a_rule_is_explained_as_what_it_is():
    run = afresh("edf")
    while not run.trace.is_over:
        run = runs.decided(run)
    kinds = {}
    for step in run.trace.steps:
        for refusal in step.plan.refused:
            kinds.setdefault(refusal.reason.kind, refusal.vehicle)
    assert {"rule", "end of horizon"} <= set(kinds)
    for kind, name in kinds.items():
        found = explain_vehicle(run.trace, name)
        assert found.cause.kind == kind
        assert not found.remedy or found.remedy.startswith("By P1: ")
        assert ("P1, asked at that moment" in found.detail) == (kind != "end of horizon")
    assert "would then not serve everyone in time" in told_why(run.trace, kinds["rule"])[0]
    assert told_worths(run.trace) == [BY_P1_ALONE.format("Earliest deadline first")]
    assert told_revision(run.trace)


def test_a_day_handed_on_names_who_decided_it(tmp_path):
    run = afresh("llf")
    trace = whole_day(run.trace)
    assert trace.policy == "llf"
    label = RunLabel(trace.policy, trace.inputs.network, 1, 0.0)
    for name, text in account(trace, verdict_on(trace), label).files.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="")
    assert json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))["policy"] == "llf"
    assert audit_run(tmp_path).findings == ()


def test_a_case_opens_its_day_for_p1_and_says_where_another_decides():
    at = opened()
    clicked(at, "cases")
    clicked(at, "case_0")
    assert session(at).run.trace.policy == PAPERS
    assert CASES[0].question in told(at)
    at.selectbox(key="decider").set_value("edf").run()
    assert "Another policy decides; this is asked of the paper's P1" in told(at)


@pytest.fixture
def refuses_all(monkeypatch):
    """An installed policy that admits nobody, and fails at 2 o'clock."""

    def function(snapshot):
        if snapshot.now == 2:
            raise ValueError("<b>lost</b>")
        return {}

    own = registry.own(function)
    decide = certified_for("evdash_all:none")
    named = Rule("evdash_all:none", "nobody", own.told, own.make, decide)
    monkeypatch.setattr(registry, "installed", lambda: {named.name: named})
    return named.name


def test_an_installed_policy_drives_the_page_and_its_faults_are_told(refuses_all):
    assert is_outside(refuses_all)
    at = opened()
    assert "nobody" in at.selectbox(key="decider").options
    at.selectbox(key="decider").set_value(refuses_all).run()
    clicked(at, "step", 3)
    assert "decided by nobody" in told(at)
    assert "Kept the previous plan" in told(at)
    assert "it raised ValueError" in told(at)
    assert "<b>lost" not in told(at)
    clicked(at, "finish")
    assert not any(step.plan.admitted for step in session(at).run.trace.steps)


def test_the_model_page_says_whose_numbers_stand_in_p1():
    at = chosen("edf", steps=18)
    at.switch_page("pages/model.py").run()
    assert "This day is decided by Earliest deadline first and not by P1" in told(at)


def test_what_an_event_does_where_no_limit_is_kept_is_said():
    for name, said in (("uncoordinated", True), ("fcfs", False)):
        at = chosen(name, steps=2)
        at.session_state["events"] = True
        at.run()
        assert ("keeps no limit" in told(at)) == said


def test_other_pages_show_a_day_that_another_policy_decided():
    at = chosen("edf", steps=18)
    for page in sorted(Path(__file__).parents[2].joinpath("pages").glob("*.py")):
        at.switch_page(f"pages/{page.name}").run()
        assert not at.exception, page


def test_a_policy_is_made_once_for_a_day(monkeypatch):
    made = []
    rule = RULES["edf"]
    counted = Rule("edf", rule.title, rule.told, lambda i: made.append(i) or rule.make(i))
    monkeypatch.setattr("evdash.ui.solving.known", lambda _: counted)
    run = afresh("edf")
    for _ in range(3):
        run = runs.decided(run)
    assert len(made) == 1
    edited = runs.edited(run, "price", {"option.C1.price_per_kwh": 0.5})
    runs.decided(edited)
    assert [inputs is run.trace.inputs for inputs in made] == [True, False]


def test_asked_of_nobody_it_says_who_there_is():
    trace = start_day(read_scenario(DEFAULT), policy="nobody")
    with pytest.raises(InputError, match="should be one of p1"):
        decider(trace)


def test_nobody_waits_while_a_policy_of_somebody_elses_is_made(monkeypatch):
    """An oracle is made by solving its whole day."""
    making, go_on, oracle = threading.Event(), threading.Event(), RULES["oracle"]

    def slow(inputs):
        making.set()
        assert go_on.wait(600)
        return oracle.make(inputs)

    monkeypatch.setitem(RULES, "oracle", replace(oracle, make=slow))
    day = make_scenario(vehicles=[vehicle("a")])
    thread = threading.Thread(target=decider, args=(start_day(day, policy="oracle"),))
    thread.start()
    assert making.wait(60)
    try:
        other = start_day(make_scenario(vehicles=[vehicle("b")]), policy="fcfs")
        found: list[object] = []
        beside = threading.Thread(target=lambda: found.append(decider(other)), daemon=True)
        beside.start()
        beside.join(60)
        assert found
    finally:
        go_on.set()
        thread.join()
    again = start_day(day, policy="oracle")
    assert decider(again)[0] is decider(again)[0]
