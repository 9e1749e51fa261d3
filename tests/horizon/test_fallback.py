"""Whatever a policy answers, a step breaks no promise: the certified tail takes its place."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.soundness import contract_problems, problems_of_step, without_times
from evdash.domain.plan import Plan, Refusal, Snapshot
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.errors import PowerFlowDiverged, SolverFailure
from evdash.horizon.day import run_day, start_day, step
from evdash.scheduling.p1 import p1_policy
from tests.builders import make_scenario, vehicle
from tests.horizon.days import with_headroom

P1 = p1_policy()
FAILING = 1
"""The interval in which the policy goes wrong; `a` and `b` are under contract, `c` asks."""


def day() -> Scenario:
    return make_scenario(
        **with_headroom([9.0, 12.0, 12.0, 12.0, 20.0, 20.0]),
        price=[0.1, 0.1, 0.2, 0.1, 0.1, 0.1],
        vehicles=[
            vehicle("a", need_kwh=14.0, option="C2"),
            vehicle("b", need_kwh=11.0, option="C2"),
            vehicle("c", hour=0.5, need_kwh=10.0, option="C2"),
            vehicle("d", hour=1.5, need_kwh=8.0, option="C2"),
        ],
    )


def wrong_only_then(answer: Callable[[Snapshot], Plan]) -> Callable[[Snapshot], Plan]:
    return lambda snapshot: answer(snapshot) if snapshot.now == FAILING else P1(snapshot)


def raising(error: Exception) -> Callable[[Snapshot], Plan]:
    def policy(snapshot: Snapshot) -> Plan:
        raise error

    return policy


def changing(change: Callable[[Plan], Plan]) -> Callable[[Snapshot], Plan]:
    return lambda snapshot: change(P1(snapshot))


def power(change: Callable[[np.ndarray], np.ndarray]) -> Callable[[Snapshot], Plan]:
    return changing(lambda plan: replace(plan, power_kw=change(plan.power_kw.copy())))


def put(value: float) -> Callable[[np.ndarray], np.ndarray]:
    def change(array: np.ndarray) -> np.ndarray:
        array[0, 0] = value
        return array

    return change


def without_row(plan: Plan, row: int) -> Plan:
    vehicles = tuple(v for n, v in enumerate(plan.vehicles) if n != row)
    return replace(plan, vehicles=vehicles, power_kw=np.delete(plan.power_kw, row, axis=0))


def with_stranger(plan: Plan) -> Plan:
    return replace(
        plan,
        vehicles=(*plan.vehicles, "stranger"),
        admitted=(*plan.admitted, "stranger"),
        power_kw=np.vstack([plan.power_kw, np.zeros(plan.power_kw.shape[1])]),
    )


def admitted_twice(plan: Plan) -> Plan:
    again = (*plan.admitted, *plan.admitted)
    twice = np.vstack([plan.power_kw[:2], np.zeros((2, plan.power_kw.shape[1]))])
    twice[2:, 2] = 10.0
    return replace(plan, vehicles=(*plan.vehicles[:2], *again), admitted=again, power_kw=twice)


WRONG = {
    "raises SolverFailure": raising(SolverFailure("no plan in time")),
    "raises PowerFlowDiverged": raising(PowerFlowDiverged("no solution")),
    "too much power": power(put(10.5)),
    "too little power": power(put(1.0)),
    "more than the headroom": power(lambda array: array * 1.5),
    "negative power": power(put(-1.0)),
    "not a number": power(put(np.nan)),
    "infinite power": power(put(np.inf)),
    "energy missing": power(lambda array: array * 0.999),
    "a slot missing": power(lambda array: array[:, :-1]),
    "a slot too many": power(lambda array: np.pad(array, ((0, 0), (0, 1)))),
    "one dimension": power(lambda array: array[0]),
    "a contract left out": changing(lambda plan: without_row(plan, 0)),
    "a newcomer's row left out": changing(lambda plan: without_row(plan, 2)),
    "nobody at all": changing(lambda plan: replace(plan, vehicles=(), power_kw=np.zeros((0, 5)))),
    "contracts swapped": changing(
        lambda plan: replace(plan, vehicles=(*plan.vehicles[1::-1], *plan.vehicles[2:]))
    ),
    "a stranger": changing(with_stranger),
    "a stranger in a contract's place": changing(
        lambda plan: replace(plan, vehicles=("stranger", *plan.vehicles[1:]))
    ),
    "a newcomer admitted twice": changing(admitted_twice),
    "admitted by name only": changing(
        lambda plan: replace(plan, vehicles=plan.vehicles[:2], power_kw=plan.power_kw[:2])
    ),
    "a request left unanswered": changing(
        lambda plan: replace(without_row(plan, 2), admitted=(), refused=())
    ),
    "admitted and refused": changing(lambda plan: replace(plan, refused=(Refusal("c", "no"),))),
    "another interval's plan": changing(lambda plan: replace(plan, now=0)),
}


def test_the_day_is_one_in_which_all_that_could_go_wrong():
    plan = run_day(start_day(day()), P1).steps[FAILING].plan
    assert plan.vehicles == ("a", "b", "c")
    assert plan.admitted == ("c",)
    assert plan.report.status == "optimal"


@pytest.mark.parametrize("kind", WRONG)
def test_the_tail_takes_the_place_of_a_wrong_answer(kind):
    trace = run_day(start_day(day()), wrong_only_then(WRONG[kind]))
    failed = trace.steps[FAILING]
    assert failed.plan.report.status == "fallback"
    assert failed.plan.report.note
    assert failed.plan.vehicles == ("a", "b")
    assert (failed.plan.power_kw == failed.before.tail_kw).all()
    assert [r.vehicle for r in failed.plan.refused] == ["c"]
    assert [s.plan.report.status for s in trace.steps if s is not failed] == ["optimal"] * 5
    assert trace.steps[FAILING + 1].plan.admitted == ("d",)
    assert_sound_but_for_the_label(trace)


def assert_sound_but_for_the_label(trace: Trace) -> None:
    told = [problem for taken in trace.steps for problem in problems_of_step(taken)]
    assert all("fallback" in problem for problem in told)
    assert list(contract_problems(trace)) == []


@pytest.mark.parametrize(
    "kind",
    ["raises SolverFailure", "too much power", "not a number", "nobody at all", "a stranger"],
)
def test_a_policy_that_never_has_an_answer_ends_what_it_was_given(kind):
    """One interval by P1, then wrong to the end: both contracts are still kept in full."""
    wrong = WRONG[kind]
    trace = run_day(start_day(day()), lambda s: wrong(s) if s.now and s.contracts else P1(s))
    assert_sound_but_for_the_label(trace)
    assert trace.steps[0].plan.admitted == ("a", "b")
    assert {s.plan.report.status for s in trace.steps if s.before.contracts} == {"fallback"}


def test_a_mistake_in_a_policys_code_is_let_through_and_harms_nothing():
    """Hiding it behind the tail would hide a bug; the trace is as before, so the day goes on."""
    trace = step(start_day(day()), P1)
    steps = without_times(trace)
    with pytest.raises(ZeroDivisionError):
        step(trace, raising(ZeroDivisionError("a bug")))
    assert without_times(trace) == steps
    assert without_times(run_day(trace, P1)) == without_times(run_day(start_day(day()), P1))
