"""An edit is refused only if no schedule keeps the contracts, and told what it costs at least."""

import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st

from benchmarks.soundness import problems_of_day, without_times
from evdash.checker.feeder import FeederCheck
from evdash.checker.plans import plan_problems
from evdash.domain.plan import Plan, Snapshot
from evdash.domain.trace import Trace
from evdash.errors import ImpossibleCommitments
from evdash.files.overrides import edit_scenario
from evdash.horizon.advance import snapshot_of
from evdash.horizon.day import start_day, step
from evdash.horizon.inputs import prepare_from
from evdash.horizon.revise import revise
from evdash.scheduling.p1 import p1_policy
from tests.horizon.days import crowded_days, small_days
from tests.scheduling_reference.by_hand import least_shortfall

P1 = p1_policy()
MISSES_KWH = 1e-5


def snapshot_under(trace: Trace, scenario) -> Snapshot:
    return snapshot_of(
        prepare_from(scenario, trace.inputs.network, trace.inputs, trace.now), trace.state
    )


def edit_and_check(trace: Trace, settings: dict[str, object]) -> Trace:
    """The trace with the edit in force, or as it was where enumeration says it must fail."""
    scenario = edit_scenario(trace.scenario, settings)
    least = least_shortfall(snapshot_under(trace, scenario)) if trace.steps else 0.0
    before = without_times(trace), trace.state
    try:
        after = revise(trace, scenario)
    except ImpossibleCommitments as impossible:
        event("impossible")
        told = sum(s.missing_kwh for s in impossible.shortfalls)
        assert least > MISSES_KWH
        assert told == pytest.approx(least, abs=1e-5)
        assert before == (without_times(trace), trace.state)
        return trace
    assert least <= MISSES_KWH
    if trace.steps:
        event("the same tail" if after.state is trace.state else "another tail")
        names = tuple(contract.vehicle for contract in after.state.contracts)
        tail = Plan(now=after.now, vehicles=names, power_kw=after.state.tail_kw.copy())
        assert plan_problems(FeederCheck(scenario), after.state.contracts, tail) == []
    return after


def run_with_edits(scenario, edits) -> None:
    trace = start_day(scenario)
    while not trace.is_over:
        trace = step(edit_and_check(trace, edits[trace.now]), P1)
    assert problems_of_day(trace, same_inputs=False) == []


def edits(intervals: int) -> st.SearchStrategy[list[dict[str, object]]]:
    """Before each interval, how many chargers there are and how much else the feeder carries."""
    before_each = {
        "station.chargers": st.sampled_from([2, 2, 1, 3, 0]),
        "feeder.load_scale": st.sampled_from([1.0, 1.2, 1.0, 1.5, 0.8]),
    }
    return st.lists(st.fixed_dictionaries(before_each), min_size=intervals, max_size=intervals).map(
        lambda listed: [{}, *listed[1:]]
    )


@settings(max_examples=80)
@given(crowded_days(3), edits(4))
def test_an_edit_is_refused_just_where_no_schedule_is_left(scenario, edits):
    run_with_edits(scenario, edits)


@settings(max_examples=40)
@given(small_days(max_intervals=4, max_vehicles=3), edits(4))
def test_an_edit_is_refused_just_where_no_schedule_is_left_on_any_day(scenario, edits):
    run_with_edits(scenario, edits)


@pytest.mark.long
@settings(max_examples=200)
@given(st.one_of(crowded_days(4), small_days(4, 4)), edits(4))
def test_an_edit_is_refused_just_where_no_schedule_is_left_in_many_days(scenario, edits):
    run_with_edits(scenario, edits)
