"""What is not solved: amounts beyond what matters, and refusals the LP proves."""

from dataclasses import replace

import pytest

from benchmarks.random_days import random_scenario
from evdash.explain.changes import NOTHING, Change, changed
from evdash.explain.refusals import trials_of
from evdash.scheduling.fast.forced import lp_bound_with
from evdash.scheduling.p1 import p1_policy
from evdash.scheduling.problem import OPTIMALITY_USD, problem_of
from tests.builders import vehicle
from tests.explain.cases import ran, roomy

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


def afresh(trials):
    """The same vehicle with nothing known."""
    return replace(trials, plans={}, lp_bounds={})


def test_no_plan_is_dearer_than_one_with_less_room(asked_again):
    """What is known of smaller amounts bounds P1's value with more."""
    by_a_plan = 0
    for trials in asked_again:
        known = afresh(trials)
        known.plan(Change(headroom_kw=0.3))
        for more in (Change(headroom_kw=6.0), Change(headroom_kw=0.3, chargers=1)):
            bound = known.known_cost(more)
            assert bound >= afresh(trials).cost(more) - OPTIMALITY_USD
            by_a_plan += bound < known.cost_without - OPTIMALITY_USD
    assert by_a_plan


def test_an_lp_not_solved_says_what_it_would_have_said(asked_again):
    amounts = [Change(headroom_kw=kw) for kw in (20.0, 0.3, 2.0, 6.0, 0.1)]
    saved = 0
    for trials in asked_again:
        known = afresh(trials)
        for usd in (known.cost_without, known.cost_without - 1.0):
            for change in amounts:
                told = known.lp_exceeds(change, usd)
                assert told == (afresh(trials).lp_bound_with(change) > usd)
        saved += len(amounts) > len(known.lp_bounds)
    assert saved


def test_who_fits_with_less_is_not_asked_again_with_more(asked_again):
    fitting = 0
    for trials in asked_again:
        known = afresh(trials)
        known.admits(Change(headroom_kw=0.3, bonus=known.bonus))
        for change in (NOTHING, Change(headroom_kw=0.3), Change(headroom_kw=6.0, chargers=1)):
            if known.known_to_fit(change):
                assert afresh(trials).admits(replace(change, bonus=known.bonus))
                fitting += 1
    assert fitting


def test_who_fits_needs_no_more_headroom(asked_again):
    fitting = [trials for trials in asked_again if not trials.cannot_fit(NOTHING)]
    assert fitting
    for trials in fitting:
        assert trials.least_headroom_kw() <= 1e-6


@pytest.mark.parametrize(("room_kw", "least_kw"), [(7.0, 1.0), (1.5, 6.5), (0.0, 8.0)])
def test_with_less_than_the_least_headroom_nobody_fits(room_kw, least_kw):
    """One slot for 8 kWh; a grid of amounts knows from it where to begin."""
    trace = ran(roomy([room_kw, 30.0], vehicles=[vehicle("v", need_kwh=8.0)]))
    step = trace.steps[0]
    trials = trials_of(step.inputs, step.before, "v")
    assert trials.least_headroom_kw() == pytest.approx(least_kw, abs=1e-6)
    assert trials.cannot_fit(Change(headroom_kw=least_kw - 0.01))
    assert not trials.cannot_fit(Change(headroom_kw=least_kw + 0.01))


def test_no_headroom_makes_room_for_who_lacks_a_charger():
    """One charger, held all the time by a contract without slack."""
    scenario = roomy(
        [50.0] * 3,
        vehicles=[vehicle("c", hour=0, need_kwh=16.0), vehicle("v", hour=1, need_kwh=8.0)],
        station={"chargers": 1, "max_kw": 8.0},
    )
    step = ran(scenario).steps[1]
    assert trials_of(step.inputs, step.before, "v").least_headroom_kw() == float("inf")


def test_more_is_more_of_headroom_or_chargers_and_of_nothing_else():
    less = Change(headroom_kw=2.0, slots=(1,), chargers=1)
    assert less.is_within(less)
    assert NOTHING.is_within(less)
    assert less.is_within(Change(headroom_kw=2.5, slots=(0, 1), chargers=1))
    assert not less.is_within(Change(headroom_kw=2.5, slots=(0, 2), chargers=1))
    assert not less.is_within(Change(headroom_kw=1.5, slots=(1,), chargers=1))
    assert not less.is_within(Change(headroom_kw=2.0, slots=(1,)))
    assert not less.is_within(replace(less, later=1))
    assert not replace(less, bonus=1.0).is_within(less)
