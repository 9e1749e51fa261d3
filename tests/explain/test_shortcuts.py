"""What is not solved: amounts beyond what matters, and refusals the LP proves."""

from dataclasses import replace

import pytest

from benchmarks.random_days import random_scenario
from evdash.explain.changes import NOTHING, Change, changed
from evdash.explain.refusals import trials_of
from evdash.scheduling.fast.forced import lp_bound_with
from evdash.scheduling.p1 import p1_policy
from evdash.scheduling.problem import OPTIMALITY_USD, problem_of
from tests.explain.cases import ran

SEEDS = (0, 1, 2, 3, 4, 5)
MORE = (
    Change(headroom_kw=0.3),
    Change(headroom_kw=6.0),
    Change(headroom_kw=1000.0),
    Change(headroom_kw=6.0, slots=(0,)),
)


def refused(seed, most=4):
    """Some who passed the door and were refused, ready to be asked about again."""
    trace = ran(random_scenario(seed))
    let_in = [
        (step, refusal.vehicle)
        for step in trace.steps
        for refusal in step.plan.refused
        if not next(
            r for r in trace.inputs.requests[step.interval] if r.vehicle == refusal.vehicle
        ).refusal
    ]
    return [
        trials_of(step.inputs, step.before, vehicle)
        for step, vehicle in let_in[:: max(1, len(let_in) // most)]
    ]


@pytest.fixture(scope="module")
def asked_again():
    trials = [trial for seed in SEEDS for trial in refused(seed)]
    assert len(trials) > 10
    return trials


@pytest.mark.parametrize("change", MORE, ids=str)
def test_headroom_that_cannot_matter_is_left_out_without_changing_p1(asked_again, change):
    shortened = 0
    for trials in asked_again:
        short = trials.as_far_as_it_matters(change)
        shortened += short.headroom_kw < change.headroom_kw
        values = [
            p1_policy()(changed(trials.inputs, trials.snapshot, trials.vehicle, asked))
            for asked in (change, short)
        ]
        in_full, in_short = (plan.report.objective for plan in values)
        assert in_full == pytest.approx(in_short, abs=OPTIMALITY_USD)
    assert shortened or change.headroom_kw < 1000


def test_the_lp_never_claims_more_than_p1_with_the_vehicle_in_costs(asked_again):
    compared = 0
    for trials in asked_again:
        forced = trials.cost_with(NOTHING)
        snapshot = changed(trials.inputs, trials.snapshot, trials.vehicle, NOTHING)
        bound = lp_bound_with(problem_of(snapshot), trials.vehicle)
        assert bound <= forced + 1e-6
        compared += bound > trials.cost_without
    assert compared


def test_who_is_not_in_the_problem_cannot_be_in(asked_again):
    trials = asked_again[0]
    snapshot = replace(trials.snapshot, requests=())
    assert lp_bound_with(problem_of(snapshot), trials.vehicle) == float("inf")
