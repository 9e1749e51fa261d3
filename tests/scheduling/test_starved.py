"""The same answers on a machine that has no time for them, and an end where a solver has none."""

import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count

import highspy
import pytest

from benchmarks.soundness import without_times
from evdash.domain.trace import Trace
from evdash.errors import SolverFailure
from evdash.explain.refusals import explanations
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import run_day, start_day, step
from evdash.horizon.happen import happen
from evdash.horizon.relief import relief
from evdash.policies.registry import RULES
from evdash.scheduling import guarded
from evdash.scheduling.effort import Effort
from evdash.scheduling.guarded import answered
from tests.builders import PRESETS
from tests.horizon.test_events import event

HOUR = 3600.0


@contextmanager
def starved(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[float]]:
    """Every clock that Python reads is an hour later at every reading.

    HiGHS has clocks of its own, so that the limits of time it is given are collected.
    """
    limits: list[float] = []
    run = highspy.Highs.run

    def noting(solver: highspy.Highs) -> highspy.HighsStatus:
        limits.append(solver.getOptionValue("time_limit")[1])
        return run(solver)

    ticks = count(1)
    with monkeypatch.context() as patch:
        patch.setattr(highspy.Highs, "run", noting)
        for clock in ("perf_counter", "monotonic", "time", "process_time", "thread_time"):
            patch.setattr(time, clock, lambda: HOUR * next(ticks))
        yield limits


def day_of(policy: str) -> Trace:
    scenario = read_scenario(PRESETS / "voltage-limited")
    scenario = edit_scenario(scenario, {"arrivals.vehicles_per_day": 60.0})
    begun = start_day(scenario)
    return run_day(begun, RULES[policy].make(begun.inputs))


@pytest.mark.parametrize("policy", ["p1", "p1-plain", "bid-price", "oracle"])
def test_a_day_is_the_same_where_every_look_at_the_clock_is_an_hour_later(policy, monkeypatch):
    quiet = day_of(policy)
    with starved(monkeypatch) as limits:
        assert without_times(day_of(policy)) == without_times(quiet)
    assert limits
    assert set(limits) == {highspy.kHighsInf}


def after_a_failure() -> tuple[object, ...]:
    """A day on which chargers fail: what is told of it, what would help, who was refused why."""
    policy = RULES["p1"].make
    trace = start_day(read_scenario(PRESETS / "summer-weekday"))
    while trace.now < 15:
        trace = step(trace, policy(trace.inputs))
    more = [event("asks_more", subject=trace.state.contracts[0].vehicle, value=1.0, interval=15)]
    trace = happen(trace, (event("chargers", value=1, interval=15), *more))
    happening = trace.happenings[-1]
    return happening.note, happening.revisions, relief(trace), [*explanations(trace)][:6]


def test_so_is_what_follows_a_failure(monkeypatch):
    quiet = after_a_failure()
    assert any(revision.short_kwh > 0 for revision in quiet[1])
    with starved(monkeypatch) as limits:
        assert after_a_failure() == quiet
    assert set(limits) == {highspy.kHighsInf}


@pytest.fixture
def soon(monkeypatch):
    """A guard that loses patience within a second."""
    monkeypatch.setattr(guarded, "LOOK_SECONDS", 0.02)
    monkeypatch.setattr(guarded, "IDLE_SECONDS", 0.4)
    monkeypatch.setattr(guarded, "PROCESSOR_SECONDS", 0.4)
    OVER.clear()
    yield
    OVER.set()


OVER = threading.Event()
"""Set once a test is done with those that never come back."""


def idling() -> None:
    OVER.wait()


def spinning() -> None:
    while not OVER.is_set():
        sum(range(1000))


@pytest.mark.parametrize(
    ("hanging", "told"), [(idling, "s in which it did nothing"), (spinning, "s of the processor")]
)
def test_a_solver_that_does_not_come_back_is_left_behind(hanging, told, soon):
    effort, began = Effort(), time.monotonic()
    with pytest.raises(SolverFailure, match=f"was left behind after 0.4 {told}"):
        answered(hanging, effort)
    assert time.monotonic() - began < 10.0
    assert effort.left_behind
    assert effort.is_spent


def creeping() -> str:
    """Little work and long waits: a processor with much else to do."""
    for _ in range(12):
        time.sleep(0.1)
        sum(range(20_000))
    return "done"


def test_one_that_hardly_gets_a_processor_is_waited_for(soon):
    began = time.monotonic()
    assert answered(creeping, Effort()) == "done"
    assert time.monotonic() - began > 2 * guarded.IDLE_SECONDS


STOPPED = """
import sys, time
from evdash.scheduling import guarded
from evdash.scheduling.effort import Effort
guarded.LOOK_SECONDS, guarded.IDLE_SECONDS = 0.05, 0.5

def ask():
    print("asked", flush=True)
    time.sleep(0.2)
    return "done"

print(guarded.answered(ask, Effort()))
"""


@pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="nothing stops a process here")
def test_a_program_that_was_stopped_has_not_waited_meanwhile():
    with subprocess.Popen([sys.executable, "-c", STOPPED], stdout=subprocess.PIPE) as program:
        assert program.stdout
        assert program.stdout.readline() == b"asked\n"
        program.send_signal(signal.SIGSTOP)
        time.sleep(1.5)
        program.send_signal(signal.SIGCONT)
        assert program.stdout.read() == b"done\n"


def test_where_no_thread_has_a_clock_the_whole_program_is_watched(soon, monkeypatch):
    monkeypatch.delattr(time, "pthread_getcpuclockid", raising=False)
    assert answered(creeping, Effort()) == "done"
    with pytest.raises(SolverFailure, match="s of the processor"):
        answered(spinning, Effort())
