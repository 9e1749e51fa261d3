"""Every reason P1 gives, held against P1 written down once more here and solved by scipy.

The referee takes who is in as given and tries all choices of newcomers: it shares nothing with
the closed forms, the linear programs and the solver that found the reason.
"""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from scipy.optimize import Bounds, LinearConstraint, milp

from evdash.domain.plan import Snapshot
from evdash.domain.refusal import CLAUSES, RefusalReason
from evdash.horizon.advance import snapshot_of
from evdash.horizon.day import run_day, start_day
from evdash.scheduling.p1 import p1_policy
from tests.builders import OPTIONS, make_scenario, vehicle
from tests.horizon.days import crowded_days, small_days, with_headroom

CENT, HAIR = 0.01, 1e-6
ROOM = {
    "headroom": (True, False),
    "chargers": (False, True),
    "headroom or chargers": (True, True),
    "headroom and chargers": (False, False),
}
"""Whether no end of headroom, and of chargers, makes room."""


def cheapest(snapshot: Snapshot, requests, *, contracts=True, feeder=True, count=True) -> float:
    """The least energy cost, $, with all of these served; inf where they cannot be."""
    here = [(r, r.need_kwh) for r in requests]
    if contracts:
        here += [(c.request, c.owed_kwh) for c in snapshot.contracts]
    n, slots, hours = len(here), snapshot.n_slots, snapshot.interval_hours
    if not n:
        return 0.0
    low = np.array([min(r.min_kw, owed / hours) for r, owed in here])
    high = np.array([r.max_kw for r, _ in here])
    ends = np.array([r.deadline_interval - snapshot.now for r, _ in here])
    power, on = np.arange(n * slots).reshape(n, slots), np.arange(n * slots, 2 * n * slots)
    on = on.reshape(n, slots)
    matrix, lower, upper = [], [], []

    def add(columns, values, least, most):
        whole = np.zeros(2 * n * slots)
        whole[columns] = values
        matrix.append(whole)
        lower.append(least)
        upper.append(most)

    for i, (_, owed) in enumerate(here):
        add(power[i], hours, owed, owed)
        for t in range(slots):
            add([power[i, t], on[i, t]], [1.0, -high[i]], -np.inf, 0.0)
            add([power[i, t], on[i, t]], [1.0, -low[i]], 0.0, np.inf)
    for t in range(slots):
        if feeder:
            add(power[:, t], 1.0, -np.inf, max(0.0, snapshot.rows.headroom_kw()[t]))
        if count:
            add(on[:, t], 1.0, -np.inf, snapshot.chargers)
    open_ = (np.arange(slots) < ends[:, None]).ravel().astype(float)
    most = np.concatenate([open_ * np.repeat(high, slots), open_])
    cost = np.concatenate([np.tile(snapshot.price_per_kwh * hours, n), np.zeros(n * slots)])
    found = milp(
        cost,
        constraints=LinearConstraint(np.array(matrix), lower, upper),
        bounds=Bounds(0, most),
        integrality=np.repeat([0, 1], n * slots),
    )
    return found.fun if found.success else np.inf


def best(snapshot: Snapshot, offered, forced=()) -> float:
    """P1's value, $, by trying every choice of those offered, with some in whatever they cost."""
    return min(
        cheapest(snapshot, [*forced, *chosen]) - sum(r.revenue for r in [*forced, *chosen])
        for size in range(len(offered) + 1)
        for chosen in combinations(offered, size)
    )


def problems(snapshot: Snapshot, plan, request, reason: RefusalReason):
    """What of a reason is not so."""
    pays, alone = request.revenue, {"contracts": False, "count": snapshot.chargers > 0}
    free = cheapest(snapshot, [request], feeder=False, **alone)
    fed = cheapest(snapshot, [request], **alone)
    beside, without = cheapest(snapshot, [request]), cheapest(snapshot, [])
    if reason.kind == "energy":
        yield free >= pays - HAIR and free == pytest.approx(reason.cost, abs=HAIR)
        return
    yield free < pays + HAIR
    if reason.kind == "feeder":
        yield np.isinf(fed)
        return
    yield np.isfinite(fed)
    if reason.kind == "feeder cost":
        yield fed >= pays - HAIR and reason.cost == pytest.approx(fed, abs=2 * CENT)
        return
    if reason.kind in ROOM:
        lifted = [cheapest(snapshot, [request], feeder=False), 0.0]
        lifted[1] = cheapest(snapshot, [request], count=False)
        yield np.isinf(beside)
        yield tuple(np.isfinite(lifted).tolist()) == ROOM[reason.kind]
        return
    yield np.isfinite(beside)
    others = [r for r in snapshot.requests if r.vehicle != request.vehicle and not r.refusal]
    if reason.kind == "contracts cost":
        yield beside - without >= pays - HAIR
        yield reason.cost == pytest.approx(beside - without, abs=3 * CENT)
    elif reason.kind == "cent":
        yield beside - without >= pays - 2 * CENT
    elif reason.kind == "outbid":
        admitted = [r for r in others if r.vehicle in plan.admitted]
        left = [r for r in admitted if r.vehicle not in reason.by]
        yield set(reason.by) <= set(plan.admitted) and bool(reason.by)
        yield best(snapshot, left, [request]) < best(snapshot, left) + 2 * CENT
        yield best(snapshot, others, [request]) > best(snapshot, others) - 2 * CENT
    else:
        yield False


def hold(scenario) -> list[str]:
    """The kinds a day gave, each true."""
    kinds = []
    for step in run_day(start_day(scenario), p1_policy()).steps:
        snapshot = snapshot_of(step.inputs, step.before)
        for refusal in step.plan.refused:
            request = next(r for r in step.requests if r.vehicle == refusal.vehicle)
            if request.refusal is None:
                wrong = not all(problems(snapshot, step.plan, request, refusal.reason))
                assert not wrong, (step.interval, request, refusal.reason)
                kinds.append(refusal.reason.kind)
    return kinds


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(small_days(max_vehicles=4))
def test_every_reason_of_a_small_day_is_true(scenario):
    hold(scenario)


@settings(max_examples=30, deadline=None, suppress_health_check=list(HealthCheck))
@given(crowded_days())
def test_every_reason_of_a_crowd_is_true(scenario):
    hold(scenario)


def test_the_whole_cheapest_schedule_counts_and_not_its_cheapest_slot():
    """An empty station: 19.2 kWh at 0.10 $/kWh, the other 10.8 kWh of its 30 at 0.90."""
    day = make_scenario(
        price=[0.1, 0.9],
        vehicles=[vehicle("v", need_kwh=30.0)],
        station={"min_kw": 3.3, "max_kw": 19.2},
        options=({"name": "C1", "price_per_kwh": 0.35, "average_kw": 15.0},),
    )
    reason = run_day(start_day(day), p1_policy()).steps[0].plan.refused[0].reason
    assert reason.kind == "energy"
    assert reason.cost == pytest.approx(19.2 * 0.1 + 10.8 * 0.9)
    assert str(reason) == (
        "its energy costs no less than it pays: at least $11.64, and it pays $10.50 for 30.0 kWh"
    )


@pytest.mark.parametrize(
    ("kind", "room", "day"),
    [
        ("feeder", [7.0, 30.0], {"vehicles": [vehicle("v", need_kwh=8.0)]}),
        (
            "feeder cost",
            [0.0, 9.0],
            {"vehicles": [vehicle("v", need_kwh=8.0, option="C2")], "price": [0.1, 0.5]},
        ),
        (
            "contracts cost",
            [8.0, 8.0, 50.0],
            {
                "price": [0.1, 0.1, 0.6],
                "vehicles": [
                    vehicle("c", need_kwh=16.0),
                    vehicle("v", hour=1, need_kwh=8.0, option="C2"),
                ],
                "station": {"max_kw": 8.0},
            },
        ),
        (
            "outbid",
            [8.0, 50.0],
            {"vehicles": [vehicle("rich", need_kwh=8.0), vehicle("v", need_kwh=7.0)]},
        ),
        (
            "chargers",
            [50.0] * 3,
            {
                "vehicles": [vehicle("c", need_kwh=16.0), vehicle("v", hour=1, need_kwh=8.0)],
                "station": {"chargers": 1, "max_kw": 8.0},
            },
        ),
        (
            "headroom and chargers",
            [8.0] * 3,
            {
                "vehicles": [vehicle("c", need_kwh=24.0), vehicle("v", hour=1, need_kwh=8.0)],
                "station": {"chargers": 1, "max_kw": 8.0},
            },
        ),
        (
            "headroom",
            [10.0, 10.0, 30.0],
            {
                "vehicles": [vehicle("c", need_kwh=16.0), vehicle("v", hour=1, need_kwh=8.0)],
                "station": {"max_kw": 8.0},
            },
        ),
        (
            "headroom or chargers",
            [8.0] * 3,
            {
                "vehicles": [
                    vehicle("c", need_kwh=20.0),
                    vehicle("v", hour=1, need_kwh=4.0, option="C3"),
                ],
                "station": {"chargers": 1, "max_kw": 12.0},
                "options": [*OPTIONS, {"name": "C3", "price_per_kwh": 0.4, "average_kw": 2.0}],
            },
        ),
    ],
)
def test_each_kind_in_a_day_made_for_it(kind, room, day):
    day = {"price": [0.1] * len(room), **day}
    assert hold(make_scenario(**with_headroom(room), **day)) == [kind]
    assert kind in CLAUSES
