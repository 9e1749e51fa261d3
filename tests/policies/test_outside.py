"""Policies from outside: found only where they may be, asked with care, certified like ours."""

import sys

import numpy as np
import pytest

from evdash.checker.plans import plan_problems
from evdash.domain.plan import Plan, Refusal, is_outside
from evdash.errors import InputError
from evdash.horizon.advance import contracts_under, snapshot_of
from evdash.horizon.day import run_day, start_day
from evdash.horizon.networks import limit_check
from evdash.metrics.service import totals
from evdash.policies import outside, registry
from evdash.policies.outside import Outside, certified_for
from evdash.policies.registry import RULES, all_given, described, given, installed, known
from evdash.scheduling.p1 import p1_policy
from tests.builders import line, make_scenario, vehicle

MINE = "mine:policy"


def make_day(rating_kva=12.0):
    """Room for one at a time; the first has a contract for two hours, the third cannot be served by
    anybody."""
    return start_day(
        make_scenario(
            station={"chargers": 1, "max_kw": 10.0},
            price=(0.3, 0.1, 0.2, 0.1),
            lines=(line("s", "a", rating=rating_kva),),
            vehicles=[
                vehicle("first", hour=0, need_kwh=15.0),
                vehicle("second", hour=2, need_kwh=8.0),
                vehicle("third", hour=3, need_kwh=40.0),
            ],
        )
    )


@pytest.fixture(scope="module")
def day():
    return make_day()


def ran(day, function):
    return run_day(day, Outside(function), decide=certified_for(MINE))


def at_once(snapshot):
    """Whoever fits beside the contracts from now on, at full power."""
    answer, busy = {}, (snapshot.tail_kw > 0).any(axis=0)
    for request in snapshot.requests:
        power = np.zeros(snapshot.n_slots)
        missing = request.need_kwh
        for slot in np.flatnonzero(~busy[: request.deadline_interval - snapshot.now]):
            power[slot] = min(missing, request.max_kw)
            missing -= power[slot]
        if missing == 0 and not request.refusal:
            answer[request.vehicle], busy = power, busy | (power > 0)
    return answer


def test_a_mapping_of_powers_is_a_whole_plan(day):
    trace = ran(day, at_once)
    assert [step.plan.admitted for step in trace.steps] == [("first",), (), ("second",), ()]
    assert [step.plan.report.status for step in trace.steps] == ["feasible"] * 4
    assert all(step.plan.report.objective is None for step in trace.steps)
    assert [step.station_kw for step in trace.steps] == [10.0, 5.0, 8.0, 0.0]
    assert totals(trace).broken == 0
    for step in trace.steps:
        contracts = contracts_under(step.plan, step.before.contracts, step.requests)
        assert plan_problems(limit_check(step.inputs), contracts, step.plan) == []


def test_who_is_left_out_is_refused_for_what_is_true(day):
    plans = [step.plan for step in ran(day, lambda _: {}).steps]
    first, second, third = (plans[t].refused[0].reason for t in (0, 2, 3))
    assert first.kind == second.kind == "policy"
    assert "one from outside" in str(first)
    assert third.kind == "end of horizon"
    (refused,) = ran(make_day(rating_kva=2.0), lambda _: {}).steps[0].plan.refused
    assert refused.reason.kind == "feeder"


def test_a_whole_plan_may_say_why(day):
    def policy(snapshot):
        names = tuple(contract.vehicle for contract in snapshot.contracts)
        refused = tuple(Refusal(r.vehicle, "closed on\nSundays") for r in snapshot.requests)
        return Plan(snapshot.now, names, snapshot.tail_kw, refused=refused)

    (refused,) = ran(day, policy).steps[0].plan.refused
    assert str(refused.reason).endswith(r"leaves it out: closed on\nSundays")


def test_our_own_policy_given_as_one_from_outside_decides_the_same(day):
    ours, theirs = run_day(day, p1_policy()), ran(day, p1_policy())
    for mine, other in zip(ours.steps, theirs.steps, strict=True):
        assert mine.plan.vehicles == other.plan.vehicles
        assert np.array_equal(mine.plan.power_kw, other.plan.power_kw)


def raises(_):
    raise ValueError("no idea\x1b[31m")


def leaves(_):
    sys.exit(3)


def row(power_kw):
    """An answer that gives whoever asks this power first, and nothing afterwards."""

    def policy(snapshot):
        rest = [0.0] * (snapshot.n_slots - len(power_kw))
        return {request.vehicle: [*power_kw, *rest] for request in snapshot.requests}

    return policy


def drops_contracts(snapshot):
    return {contract.vehicle: np.zeros(snapshot.n_slots) for contract in snapshot.contracts} or (
        at_once(snapshot)
    )


WRONG = {
    "raises": (raises, r"mine:policy: it raised ValueError: no idea\x1b[31m"),
    "leaves": (leaves, "it raised SystemExit: 3"),
    "no mapping": (lambda _: [1.0], "it answered list; should be a mapping"),
    "nothing": (lambda _: None, "it answered NoneType"),
    "no name": (lambda _: {3: [1.0]}, "the key 3"),
    "a stranger": (lambda s: {"x": [0.0] * s.n_slots}, "'x', who neither asks now nor has"),
    "too short": (lambda s: {"first": [1.0]}, "has shape (1,), and 4 slots are left"),
    "a text": (lambda s: {"first": ["much"] * s.n_slots}, "are no numbers"),
    "not finite": (row([np.nan]), "first: power is not a number of at least 0 kW"),
    "endless": (row([np.inf]), "first: power is not a number of at least 0 kW"),
    "negative": (row([10.0, 10.0, -5.0]), "first: power is not a number of at least 0 kW"),
    "too little": (row([10.0]), "10.000000 kWh planned, 15.000000 kWh owed"),
    "too strong": (row([15.0]), "15.000000 kW in interval 0, at most 10 kW"),
    "a row too few": (
        lambda s: Plan(s.now, ("first",), np.zeros((0, s.n_slots))),
        "1 vehicles and 0 rows",
    ),
    "twice": (
        lambda s: Plan(s.now, ("first", "first"), np.zeros((2, s.n_slots))),
        "names a vehicle twice",
    ),
    "no plan": (lambda s: Plan(s.now, ("first",), [[0.0]]), "it raised AttributeError"),
    "worthless prices": (
        lambda s: Plan(s.now, (), np.zeros((0, 1)), capacity_price_per_kwh=np.array([np.nan])),
        "prices of capacity are not 4 numbers",
    ),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_what_is_wrong_is_told_and_the_last_plan_kept(day, wrong):
    function, told = WRONG[wrong]
    plan = ran(day, function).steps[0].plan
    assert (plan.report.status, plan.admitted) == ("fallback", ())
    assert plan.report.note.startswith(f"{MINE}: ")
    assert told in plan.report.note
    assert plan.report.note in str(plan.refused[0].reason)


def test_a_promise_made_is_kept_whatever_comes_later(day):
    trace = ran(day, drops_contracts)
    assert [step.plan.report.status for step in trace.steps][1] == "fallback"
    assert "first: 0.000000 kWh planned, 5.000000 kWh owed" in trace.steps[1].plan.report.note
    assert (totals(trace).admitted, totals(trace).broken) == (2, 0)


def test_limits_and_the_door_hold_for_it_too(day):
    plan = ran(make_day(rating_kva=9.0), row([10.0, 5.0])).steps[0].plan
    assert "line:s-a exceeded by" in plan.report.note
    plan = ran(day, lambda s: row([10.0])(s) if s.now == 3 else {}).steps[3].plan
    assert "it admits third, whom nobody can serve: there is too little time" in plan.report.note


def test_what_it_sees_is_a_copy(day):
    snapshot = snapshot_of(day.inputs, day.state)
    before = [snapshot.price_per_kwh.copy(), snapshot.rows.limit_kw.copy()]

    def grabbing(seen):
        seen.price_per_kwh[:] = -1.0
        seen.rows.limit_kw[:] = 1e9
        return {}

    assert Outside(grabbing)(snapshot).admitted == ()
    assert np.array_equal(before[0], snapshot.price_per_kwh)
    assert np.array_equal(before[1], snapshot.rows.limit_kw)


def test_what_it_answered_can_be_changed_no_more(day):
    kept = np.array([10.0, 5.0, 0.0, 0.0])
    plan = Outside(lambda _: {"first": kept})(snapshot_of(day.inputs, day.state))
    kept[:] = 99.0
    assert plan.power_kw.tolist() == [[10.0, 5.0, 0.0, 0.0]]
    with pytest.raises(ValueError, match="read-only"):
        plan.power_kw[0, 0] = 1.0


def test_one_that_never_comes_back_is_asked_once(day, monkeypatch):
    def endless(ask, effort):
        asked.append(ask)
        effort.leave_behind()
        raise outside.SolverFailure("the solver did not come back and was left behind after 1 s")

    asked = []
    monkeypatch.setattr(outside, "answered", endless)
    notes = [step.plan.report.note for step in ran(day, at_once).steps]
    assert len(asked) == 1
    assert notes[0] == f"{MINE}: it did not come back and was left behind after 1 s"
    assert set(notes[1:]) == {f"{MINE}: {outside.LEFT_BEHIND}"}


@pytest.fixture
def package(tmp_path, monkeypatch):
    """An installed package that offers a policy, one under a name of ours, one with a name that is
    none, and one that is not there."""
    (tmp_path / "evdash_mine.py").write_text(
        "def policy(snapshot):\n    return {}\n", encoding="utf-8"
    )
    info = tmp_path / "evdash_mine-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Name: evdash-mine\nVersion: 1.0\n", encoding="utf-8")
    points = ["nobody = evdash_mine:policy", "p1 = evdash_mine:other", "gone = evdash_gone:policy"]
    points += ["**bold** = evdash_mine:bold", "whole = evdash_mine"]
    text = "\n".join(["[evdash.policies]", *points, ""])
    (info / "entry_points.txt").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    installed.cache_clear()
    yield "evdash_mine"
    installed.cache_clear()
    sys.modules.pop("evdash_mine", None)


def test_installed_packages_offer_policies_that_are_not_imported_before_their_use(package, day):
    titles = {name: rule.title for name, rule in installed().items()}
    assert titles == {
        "evdash_mine:policy": "nobody",
        "evdash_mine:other": "evdash_mine:other",
        "evdash_gone:policy": "gone",
        "evdash_mine:bold": "evdash_mine:bold",
    }
    assert known("p1") is RULES["p1"]
    assert known("nobody") is known("evdash_mine:policy") is given("nobody")
    assert package not in sys.modules
    policy = known("nobody").make(day.inputs)
    assert package in sys.modules
    trace = run_day(day, policy, decide=known("nobody").decide)
    assert totals(trace).admitted == 0
    with pytest.raises(InputError, match="evdash_gone:policy, which cannot be imported"):
        known("gone").make(day.inputs)


def test_a_name_from_elsewhere_than_the_command_line_imports_nothing(tmp_path, monkeypatch, day):
    (tmp_path / "evdash_trap.py").write_text("raise SystemExit('sprung')\n", encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(InputError, match=r"evdash_trap:policy.*named on the command line"):
        known("evdash_trap:policy")
    rule = described("evdash_trap:policy")
    assert (rule.title, rule.keeps_limits) == ("evdash_trap:policy", True)
    with pytest.raises(InputError):
        rule.make(day.inputs)
    assert "evdash_trap" not in sys.modules
    with pytest.raises(InputError, match="SystemExit: sprung"):
        given("evdash_trap:policy")


@pytest.mark.parametrize(
    "name", ["", "p2", "os", ":", "os:", ":x", "a b:c", "os:path:join", "../x:y", "os.:x", "1a:b"]
)
def test_what_is_no_name_is_told_with_those_there_are(name):
    assert not is_outside(name)
    with pytest.raises(InputError, match="should be one of p1, p1-plain, bid-price"):
        given(name)


def test_all_that_is_wrong_is_told_at_once():
    with pytest.raises(InputError) as wrong:
        all_given(["p1", "p2", "os:nothing", "os:sep", "evdash_nowhere.at:all"], "--policies")
    assert [fault.found.split(" (")[0] for fault in wrong.value.faults] == [
        "'p2'",
        "os:nothing, which cannot be imported",
        "os:sep, which is of type str",
        "evdash_nowhere.at:all, which cannot be imported",
    ]
    assert list(all_given(["edf", "p1", "edf"], "--policies")) == ["edf", "p1"]


def test_one_of_ones_own_is_found_where_one_is(tmp_path, monkeypatch, day):
    (tmp_path / "evdash_here.py").write_text(
        "class Rules:\n    @staticmethod\n    def none(snapshot):\n        return {}\n",
        encoding="utf-8",
    )
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [place for place in sys.path if place])
    rule = given("evdash_here:Rules.none")
    assert rule.name == "evdash_here:Rules.none"
    assert run_day(day, rule.make(day.inputs), decide=rule.decide).is_over
    assert registry.choices().keys() == RULES.keys()
