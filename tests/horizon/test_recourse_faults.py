"""The optimiser of recourse fails in every way: what has happened is still settled, and said."""

import threading
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.soundness import problems_of_step
from evdash.domain.trace import Trace
from evdash.errors import SolverFailure
from evdash.horizon import recourse
from evdash.horizon.day import run_day
from evdash.metrics.breaches import charger_breaches, linear_breaches
from evdash.metrics.ledger import ledger
from evdash.scheduling import guarded
from evdash.scheduling.effort import Effort
from evdash.scheduling.p1 import p1_policy
from evdash.scheduling.shortfall import Recourse, least_shortfall, most_energy_for
from tests.horizon.test_events import begun, event, told

P1 = p1_policy()
HANG_SECONDS = 20.0


def raising(error: Exception) -> Callable[[Recourse], Recourse]:
    def fault(right: Recourse) -> Recourse:
        raise error

    return fault


def hanging(right: Recourse) -> Recourse:
    threading.Event().wait(HANG_SECONDS)
    return right


def power(change: Callable[[np.ndarray], np.ndarray]) -> Callable[[Recourse], Recourse]:
    return lambda right: replace(right, power_kw=change(right.power_kw.copy()))


FAULTS = {
    "no plan in time": raising(SolverFailure("HiGHS found no plan: Not Solved")),
    "crash": raising(RuntimeError("HiGHS stopped working")),
    "out of memory": raising(MemoryError("HiGHS")),
    "never back": hanging,
    "not a number": power(lambda kw: kw * np.nan),
    "infinite": power(lambda kw: np.where(kw > 0, np.inf, kw)),
    "1e-3 too much": power(lambda kw: kw * 1.001),
    "far over the limits": power(lambda kw: kw * 3),
    "negative": power(lambda kw: kw - 1.0),
    "nothing charged": power(lambda kw: kw * 0),
    "another shape": power(lambda kw: kw[:, :-1]),
    "one vehicle missing": power(lambda kw: kw[:-1]),
    "a shortfall that is none": lambda right: replace(right, short_kwh=right.short_kwh * 0),
    "a shortfall that is no number": lambda right: replace(
        right, short_kwh=right.short_kwh + np.nan
    ),
}


@pytest.fixture(autouse=True)
def little_patience(monkeypatch):
    monkeypatch.setattr(guarded, "IDLE_SECONDS", 0.2)
    monkeypatch.setattr(guarded, "LOOK_SECONDS", 0.05)


def failing(monkeypatch, kind: str) -> None:
    """Both questions of recourse are answered rightly, and then spoilt."""
    fault = FAULTS[kind]
    monkeypatch.setattr(recourse, "least_shortfall", lambda p, e: fault(least_shortfall(p, e)))
    monkeypatch.setattr(
        recourse,
        "most_energy_for",
        lambda p, x, e: fault(most_energy_for(p, x, Effort())),
    )


def assert_nothing_lost(after: Trace) -> None:
    """The day goes on to its end within every limit, and the ledger is what was delivered."""
    done = run_day(after, P1)
    assert len(done.steps) == done.scenario.intervals
    assert [b for b in linear_breaches(done) if b.by_station] == []
    assert list(charger_breaches(done)) == []
    assert [p for s in done.steps for p in problems_of_step(s)] == []
    for entry in ledger(done):
        missing = entry.revised_kwh - entry.delivered_kwh
        assert entry.short_kwh == pytest.approx(missing if missing > 0.01 else 0.0, abs=1e-6)


@pytest.mark.parametrize("kind", FAULTS)
def test_a_failure_of_chargers_is_settled_whatever_the_optimiser_does(kind, monkeypatch):
    trace = begun([2, 5, 5])
    failing(monkeypatch, kind)
    after, happening = told(trace, event("rating", subject="node:a", value=9.0))
    assert after.now == trace.now
    assert happening.short_kwh >= 2.0 - 1e-6, "20 kWh are owed and 18 can be had"
    assert recourse.SHED in happening.note
    assert not happening.proven
    assert_nothing_lost(after)


@pytest.mark.parametrize("kind", FAULTS)
def test_who_asks_for_more_gets_nothing_that_was_not_checked(kind, monkeypatch):
    trace = begun()
    failing(monkeypatch, kind)
    after, happening = told(trace, event("asks_more", subject="a", value=2.0))
    assert "a gets nothing more" in happening.note or kind == "a shortfall that is none"
    assert happening.short_kwh == 0
    assert {entry.status for entry in ledger(run_day(after, P1))} == {"kept"}
    assert_nothing_lost(after)
