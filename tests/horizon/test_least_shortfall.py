"""Days with random events: every shortfall is the least an independent MILP finds."""

from dataclasses import replace

import pytest

from benchmarks import events as benchmark
from benchmarks.events import Result, day_problems, judge, rows_of, run_one
from benchmarks.recourse_by_milp import claims_of, least_of
from benchmarks.soundness import without_times
from evdash.domain.events import Event
from evdash.horizon.day import run_day, start_day, step
from evdash.horizon.happen import happen
from evdash.scheduling.p1 import p1_policy
from tests.horizon.test_events import begun, event

P1 = p1_policy()


@pytest.mark.parametrize("seed", [12, 15])
def test_shortfalls_of_random_days_are_the_least(seed):
    result = run_one(seed)
    assert result.problems == []
    assert result.counts["happenings"] > 0


def test_the_days_have_shortfalls_in_them():
    results = [run_one(seed) for seed in (2, 19)]
    rows = dict(rows_of(results, 1.0))
    assert int(rows["  after which promises were short"]) > 0
    assert rows["days with any problem"] == "0"


@pytest.mark.parametrize(
    "events",
    [
        [event("chargers", value=0)],
        [event("rating", subject="node:a", value=9.0), event("chargers_fail", value=2)],
        [event("rating", subject="node:a", value=9.0), event("late", subject="a", from_interval=2)],
        [event("chargers", value=1), event("leaves_early", subject="a", until_interval=2)],
    ],
)
def test_one_happening_by_both(events: list[Event]):
    trace = begun([2, 5, 5])
    after = happen(trace, events)
    result = Result(0)
    judge(result, after, trace.state)
    assert result.problems == []
    least = least_of(after.inputs, 1, claims_of(after.inputs, trace.state, events))
    assert after.happenings[-1].short_kwh == pytest.approx(least.short_kwh, abs=1e-5)


def test_the_judge_tells_a_shortfall_that_is_not_the_least():
    trace = begun([2, 5, 5])
    after = happen(trace, [event("chargers", value=1), event("rating", subject="node:a", value=9)])
    happening = after.happenings[-1]
    worse = [
        replace(one, after=replace(one.after, short_kwh=one.after.short_kwh + 1.0))
        for one in happening.revisions
    ]
    spoilt = replace(after, happenings=(replace(happening, revisions=tuple(worse)),))
    result = Result(0)
    judge(result, spoilt, trace.state)
    assert "kWh short, least" in result.problems[0]


def test_the_judge_tells_newcomers_taken_while_promises_are_short():
    trace = run_day(happen(begun([2, 5, 5]), [event("chargers", value=0)]), P1)
    assert list(day_problems(trace)) == []
    taken = replace(trace.steps[2], plan=replace(trace.steps[2].plan, admitted=("c",)))
    spoilt = replace(trace, steps=(*trace.steps[:2], taken, *trace.steps[3:]))
    assert any("while promises are short" in problem for problem in day_problems(spoilt))


def test_a_day_with_events_is_the_same_from_its_own_scenario():
    rng_day = run_live(15)
    again = run_day(start_day(rng_day.inputs.given), P1)
    assert without_times(again) == without_times(rng_day)
    assert [h.revisions for h in again.happenings] == [h.revisions for h in rng_day.happenings]


def run_live(seed: int):
    """The benchmark's day, things happening as it goes."""
    rng = benchmark.np.random.default_rng(seed + 1_000_000)
    trace = start_day(benchmark.random_scenario(seed))
    while not trace.is_over:
        events = benchmark.random_events(rng, trace)
        trace = step(happen(trace, events) if events else trace, P1)
    assert trace.happenings
    return trace
