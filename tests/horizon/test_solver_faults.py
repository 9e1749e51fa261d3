"""The solver fails in every way: the step ends in time, says so, and the next is as before."""

import time

import numpy as np
import pytest

from benchmarks import faults
from benchmarks.faults import FAULTS, rows_of, run_one
from benchmarks.soundness import contract_problems, problems_of_step, without_times
from evdash.domain.plan import Plan, Snapshot
from evdash.domain.trace import Trace
from evdash.errors import SolverFailure
from evdash.horizon.day import run_day, start_day
from evdash.scheduling import guarded
from evdash.scheduling.effort import Effort
from evdash.scheduling.fast.solver import solve_fast
from evdash.scheduling.guarded import answered
from evdash.scheduling.p1 import p1_policy
from tests.horizon.test_fallback import FAILING, P1, day

REPAIRED = {"1e-6 off", "1e-3 off", "far over the limits", "everyone at once"}
"""Cleaning makes a certified plan of these; of the others nothing is left to make one of."""


@pytest.fixture(autouse=True)
def little_patience(monkeypatch):
    monkeypatch.setattr(guarded, "IDLE_SECONDS", faults.IDLE_SECONDS)
    monkeypatch.setattr(guarded, "LOOK_SECONDS", faults.LOOK_SECONDS)


def faulty_day(kind: str) -> Trace:
    failing = p1_policy(FAULTS[kind])

    def policy(snapshot: Snapshot) -> Plan:
        return failing(snapshot) if snapshot.now == FAILING else P1(snapshot)

    return run_day(start_day(day()), policy)


@pytest.mark.parametrize("kind", FAULTS)
def test_a_fault_costs_no_promise_and_the_next_interval_is_as_ever(kind):
    began = time.perf_counter()
    trace = faulty_day(kind)
    failed = trace.steps[FAILING]
    assert time.perf_counter() - began < faults.HANG_SECONDS
    assert [s.plan.report.status for s in trace.steps if s is not failed] == ["optimal"] * 5
    told = [problem for step in trace.steps for problem in problems_of_step(step)]
    assert all("fallback" in problem for problem in told)
    assert list(contract_problems(trace)) == []
    if failed.plan.report.status == "fallback":
        assert failed.plan.report.note
        assert (failed.plan.power_kw == failed.before.tail_kw).all()
    else:
        assert kind in REPAIRED | {"a bound that is not true"}


def test_a_bound_that_a_point_undercuts_proves_nothing():
    report = faulty_day("a bound that is not true").steps[FAILING].plan.report
    assert (report.status, report.bound) == ("feasible", None)


def test_a_crash_is_told_by_its_name():
    assert "RuntimeError: HiGHS stopped" in faulty_day("crash").steps[FAILING].plan.report.note


def test_a_solver_that_works_is_not_disturbed():
    unguarded = run_day(start_day(day()), p1_policy(solve_fast))
    assert without_times(unguarded) == without_times(run_day(start_day(day()), P1))


def test_our_own_errors_pass_as_they_are_and_answers_too():
    def fails() -> None:
        raise SolverFailure("in its own words")

    with pytest.raises(SolverFailure, match="in its own words"):
        answered(fails, Effort())
    assert answered(lambda: np.pi, Effort()) == np.pi


@pytest.mark.parametrize("seed", [4, 15])
def test_a_short_run_of_the_benchmark(seed):
    result = run_one(seed)
    assert result.problems == ()
    assert sum(result.answers.values()) > 0
    assert result.worst_seconds < faults.HANG_SECONDS
    assert dict(rows_of([result], 1.0))["days with any problem"] == "0"
