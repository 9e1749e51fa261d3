"""The admissions of least mean cost, against trying every set."""

from itertools import product

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from evdash.horizon.advance import initial_state, snapshot_of
from evdash.horizon.inputs import prepare
from evdash.policies.expectation import (
    LATER_USD_PER_KWH,
    best_admissions,
    costs_of,
    expectation_of,
    sampled_days,
)
from evdash.scheduling.p1 import p1_policy
from tests.builders import make_scenario, vehicle

HOURS = 5


@st.composite
def crowds(draw, min_kw=2.0):
    """A snapshot with newcomers, and three futures."""
    asking = [
        vehicle(
            f"{n}",
            need_kwh=draw(st.integers(4, 30)),
            battery_kwh=80.0,
            option=draw(st.sampled_from(["C1", "C2"])),
        )
        for n in range(draw(st.integers(1, 5)))
    ]
    scenario = make_scenario(
        price=[draw(st.integers(5, 35)) / 100 for _ in range(HOURS)],
        station={"chargers": draw(st.integers(1, 3)), "min_kw": min_kw},
        lines=(
            {
                "from_node": "s",
                "to_node": "a",
                "r_ohm": 0.1,
                "x_ohm": 0.1,
                "rating_kva": draw(st.integers(8, 30)),
            },
        ),
        vehicles=asking,
    )
    futures = []
    for future in range(3):
        coming = [
            vehicle(
                f"f{future}-{n}",
                hour=draw(st.integers(1, HOURS - 1)),
                battery_kwh=80.0,
                need_kwh=draw(st.integers(4, 30)),
                option=draw(st.sampled_from(["C1", "C2"])),
            )
            for n in range(draw(st.integers(0, 4)))
        ]
        known = prepare(scenario.model_copy(update={"arrivals": _recorded(scenario, coming)}))
        futures.append(tuple(r for group in known.requests[1:-1] for r in group if not r.refusal))
    inputs = prepare(scenario)
    return snapshot_of(inputs, initial_state(HOURS)), futures


def _recorded(scenario, coming):
    return make_scenario(price=[0.1] * HOURS, vehicles=coming).arrivals


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(crowds())
def test_no_other_set_is_a_cent_better_in_the_mean(crowd):
    snapshot, futures = crowd
    n = sum(not request.refusal for request in snapshot.requests)
    days = sampled_days(snapshot, futures, n)
    best = best_admissions(days, n, rounds=2**n)
    tried = [
        expectation_of(days, np.array(admitted, dtype=float))
        for admitted in product((0, 1), repeat=n)
    ]
    least = min(found.cost for found in tried if found is not None)
    assert best.cost <= least + 0.0101


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(crowds(min_kw=0.0))
def test_no_cut_takes_away_what_can_be_done(crowd):
    """P1's own decision, carried out, costs in a future where nobody comes what P1 says.

    Without a lowest power, whose relaxation in later slots may cost less than any plan.
    """
    snapshot, _ = crowd
    asking = [request for request in snapshot.requests if not request.refusal]
    plan = p1_policy()(snapshot)
    days = sampled_days(snapshot, [()], len(asking))
    best_admissions(days, len(asking))
    admitted = np.array([float(request.vehicle in plan.admitted) for request in asking])
    now_kw = dict(zip(plan.vehicles, plan.power_kw[:, 0], strict=True))
    first_kw = np.array([now_kw.get(request.vehicle, 0.0) for request in asking])
    (cost,) = costs_of(days, admitted, first_kw)
    later = LATER_USD_PER_KWH * (np.arange(HOURS) @ plan.power_kw.sum(axis=0))
    assert cost <= plan.report.objective + later + 1e-4
    assert cost >= plan.report.bound - 1e-3
    (without,) = costs_of(days, 0 * admitted, 0 * first_kw)
    assert without == pytest.approx(0.0, abs=1e-6)  # and the question before is forgotten


def test_prices_tell_what_the_expected_would_pay():
    """One charger, one slot at noon wanted by an expected payer of 0.4 $/kWh, energy 0.1 $/kWh."""
    scenario = make_scenario(
        price=(0.1, 0.1),
        station={"chargers": 5, "max_kw": 10.0},
        lines=(
            {"from_node": "s", "to_node": "a", "r_ohm": 0.001, "x_ohm": 0.001, "rating_kva": 10.0},
        ),
        vehicles=[
            vehicle("later", hour=1, need_kwh=10.0, max_kw=10.0),
            vehicle("too", hour=1, need_kwh=10.0, max_kw=10.0),
        ],
    )
    inputs = prepare(scenario)
    snapshot = snapshot_of(inputs, initial_state(2))
    found = expectation_of(sampled_days(snapshot, [inputs.requests[1]], 0), np.zeros(0))
    assert found.energy_price == pytest.approx([0.0, 0.3], abs=1e-3)
