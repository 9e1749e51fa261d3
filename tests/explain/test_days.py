"""Days nobody tuned to: every refusal has its cause, every remedy does what it says."""

from itertools import islice

import pytest

from benchmarks.random_days import random_scenario
from evdash.explain.causes import DOOR
from evdash.explain.refusals import explain_vehicle, explanations
from evdash.files.bundled import DEFAULT, bundled_scenarios
from evdash.files.scenario_folder import read_scenario
from evdash.metrics.records import vehicle_records
from evdash.scheduling.p1 import p1_policy
from evdash.scheduling.reference import solve_reference
from tests.explain.cases import ran
from tests.explain.judge import admits, problems_of

CI_SEEDS = (0, 1, 2, 3, 4, 5)
LONG_SEEDS = range(100, 150)
CI_VEHICLES = 8


@pytest.fixture(scope="module")
def bundled():
    return ran(read_scenario(DEFAULT, ()))


@pytest.fixture(scope="module")
def told_of_bundled(bundled):
    return list(explanations(bundled))


def judged(trace, most=None, told=None):
    """Every refusal of a day, and all that is wrong with what is said of it."""
    told = list(explanations(trace)) if told is None else told
    refused = [r.vehicle for r in vehicle_records(trace) if r.status == "refused"]
    assert [explanation.vehicle for explanation in told] == refused
    policy = p1_policy()
    chosen = told if most is None else told[:: max(1, len(told) // most)]
    return told, [problem for e in chosen for problem in problems_of(trace, e, policy)]


@pytest.mark.parametrize("seed", CI_SEEDS)
def test_random_days(seed):
    _, problems = judged(ran(random_scenario(seed)), CI_VEHICLES)
    assert not problems


def test_the_bundled_day(bundled, told_of_bundled):
    told, problems = judged(bundled, CI_VEHICLES, told_of_bundled)
    assert not problems
    assert {"headroom", "headroom and chargers", "outbid", "end of horizon", "chargers"} <= {
        explanation.cause.kind for explanation in told
    }


def test_under_ac(bundled):
    """The evening's first refusals, under limits found by AC power flow."""
    trace = ran(bundled.scenario, "ac")
    told = list(islice(explanations(trace), 6))
    policy = p1_policy()
    assert len({e.cause.kind for e in told}) > 1
    assert not [problem for e in told for problem in problems_of(trace, e, policy)]


def test_prices_hold_for_any_solver_true_to_a_cent(bundled, told_of_bundled):
    reference = p1_policy(solve_reference)
    told = [e for e in told_of_bundled if e.cause.kind == "outbid"]
    for explanation in told[-4:]:
        price = next(r for r in explanation.remedies if r.kind == "price")
        assert admits(bundled, explanation, price, price.amount, reference)
        assert not admits(bundled, explanation, price, price.refused_at, reference)


def test_the_same_words_every_time_and_one_by_one(bundled, told_of_bundled):
    for once in told_of_bundled[::9]:
        assert explain_vehicle(bundled, once.vehicle) == once


def test_a_day_is_explained_one_vehicle_at_a_time(bundled):
    solved = []

    def counting(snapshot):
        solved.append(snapshot)
        return p1_policy()(snapshot)

    lazily = explanations(bundled, counting)
    assert not solved
    next(lazily)
    first = len(solved)
    lazily.close()
    assert 0 < first < 60
    assert len(solved) == first


def test_who_was_not_refused_has_no_explanation(bundled):
    admitted = next(r.vehicle for r in vehicle_records(bundled) if r.status == "charged")
    with pytest.raises(ValueError, match="was not refused"):
        explain_vehicle(bundled, admitted)


@pytest.mark.long
@pytest.mark.parametrize("seed", LONG_SEEDS)
def test_fifty_random_days(seed):
    told, problems = judged(ran(random_scenario(seed)))
    assert not problems
    assert all(e.remedies or e.helpless for e in told)


@pytest.mark.long
@pytest.mark.parametrize("folder", bundled_scenarios(), ids=lambda folder: folder.name)
@pytest.mark.parametrize("network", ["lindistflow", "ac"])
def test_every_bundled_day(folder, network):
    told, problems = judged(ran(read_scenario(folder, ()), network))
    assert not problems
    assert any(e.cause.kind not in DOOR for e in told)
