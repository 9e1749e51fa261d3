"""One step's effort bounds all that is asked of solvers in it, however many ask."""

import threading
import time

import pytest

from evdash.domain.trace import Trace
from evdash.horizon import recourse
from evdash.horizon.day import run_day
from evdash.metrics.ledger import ledger
from evdash.scheduling import guarded, shortfall
from evdash.scheduling.effort import Effort
from evdash.scheduling.p1 import p1_policy
from tests.horizon.test_events import begun, event, told

P1 = p1_policy()
ASKS = 12
HANG_SECONDS = 30.0


def asking(trace: Trace, times: int = ASKS):
    return told(trace, *[event("asks_more", subject="a", value=0.25) for _ in range(times)])


def given(monkeypatch, effort: Effort) -> Effort:
    monkeypatch.setattr(recourse, "step_effort", lambda: effort)
    return effort


def test_many_who_ask_are_granted_what_there_is():
    after, happening = asking(begun())
    assert happening.note.count("a gets 0.25 of 0.25 kWh more") == ASKS
    assert sum(r.promised_kwh for r in happening.revisions) == pytest.approx(0.25 * ASKS)
    assert {e.status for e in ledger(run_day(after, P1))} == {"kept"}


def test_solvers_that_never_come_back_hold_up_a_step_once_not_once_for_each_who_asks(monkeypatch):
    def hanging(problem, extra_kwh, effort):
        asked.append(extra_kwh)
        threading.Event().wait(HANG_SECONDS)

    monkeypatch.setattr(recourse, "most_energy_for", hanging)
    monkeypatch.setattr(guarded, "IDLE_SECONDS", 0.2)
    monkeypatch.setattr(guarded, "LOOK_SECONDS", 0.05)
    asked = []
    began = time.perf_counter()
    after, happening = asking(begun())
    assert time.perf_counter() - began < HANG_SECONDS
    assert len(asked) == 1
    assert recourse.LEFT_BEHIND in happening.note
    assert recourse.SPENT in happening.note
    assert "kWh more" not in happening.note
    assert {e.status for e in ledger(run_day(after, P1))} == {"kept"}


def test_each_who_asks_has_a_share_of_what_is_left(monkeypatch):
    shares = []

    def noting(problem, extra_kwh, effort):
        shares.append(effort.work)
        effort.spend(effort.work)
        return shortfall.most_energy_for(problem, extra_kwh, Effort())

    monkeypatch.setattr(recourse, "most_energy_for", noting)
    effort = given(monkeypatch, Effort(1000.0))
    asking(begun(), 4)
    assert shares == pytest.approx([250.0] * 4)
    assert effort.work == pytest.approx(0.0, abs=1e-6)


def test_without_any_effort_a_step_still_ends_by_switching_off_and_says_so(monkeypatch):
    effort = given(monkeypatch, Effort(0.0))
    after, happening = told(
        begun([2, 5, 5]), event("chargers", value=1), event("asks_more", subject="b", value=1.0)
    )
    assert recourse.SHED in happening.note
    assert not happening.proven
    assert not effort.left_behind
    assert recourse.LEFT_BEHIND not in happening.note
    done = run_day(after, P1)
    assert {s.plan.report.status for s in done.steps} == {"optimal"}


def test_by_arrival_drivers_who_changed_their_terms_last(monkeypatch):
    """Nothing but switching off is left: one charger, and `a`, who came first, leaves early."""
    given(monkeypatch, Effort(0.0))
    gone = event("leaves_early", subject="a", until_interval=2)
    _, alone = told(begun([2, 5, 5]), event("chargers", value=1))
    _, with_own = told(begun([2, 5, 5]), event("chargers", value=1), gone)
    assert [r.vehicle for r in alone.revisions if r.short_kwh > 0] == ["b"]
    assert [r.vehicle for r in with_own.revisions if r.promised_kwh < 0] == ["a"]
