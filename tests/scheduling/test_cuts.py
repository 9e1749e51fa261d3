"""Every row of the relaxation and every cut holds at every integer-feasible point of P1."""

from itertools import product

import numpy as np
import pytest
from scipy.optimize import Bounds, LinearConstraint, milp

from evdash.domain.limits import Floats, LimitRows
from evdash.domain.tariff import Tariff
from evdash.scheduling.effort import Effort
from evdash.scheduling.fast.candidates import Prices
from evdash.scheduling.fast.relaxation import Relaxation, charges_of, contested_slots, relaxation_of
from evdash.scheduling.fast.rounding import violated_cuts
from evdash.scheduling.fast.solver import search_over
from evdash.scheduling.problem import Problem
from tests.scheduling.problems import random_problem

HAIR = 1e-7


def relaxed(problem: Problem, everywhere: bool) -> Relaxation:
    """The relaxation, with D in every slot or only where chargers can bind."""
    charges, headroom = charges_of(problem), problem.rows.headroom_kw()
    slots = contested_slots(problem, charges, headroom)
    return relaxation_of(problem, charges, headroom, slots | everywhere)


def one_charge(rng: np.random.Generator) -> Problem:
    """A lone request over up to five slots."""
    n_slots, high = int(rng.integers(1, 6)), float(rng.uniform(4, 20))
    owed = float(rng.choice([rng.uniform(0.1, high * n_slots), high * rng.integers(1, 4)]))
    return Problem(
        vehicles=("v0",),
        n_contracts=0,
        owed_kwh=np.array([owed]),
        intervals_left=np.array([n_slots]),
        low_kw=np.array([min(owed, float(rng.choice([0.0, 1.0, 3.3])))]),
        high_kw=np.array([high]),
        revenue=np.ones(1),
        tariff=Tariff(np.ones(n_slots), 1.0),
        chargers=1,
        rows=LimitRows((), np.empty((0, 1)), np.empty((n_slots, 0))),
        tail_kw=np.zeros((1, n_slots)),
    )


def least_left_side(problem: Problem, relaxation: Relaxation, row: Floats) -> float:
    """The least value of a row over every integer-feasible point with u = 1.

    For one vehicle and D given, P ranges over a box cut by Σ P = s, where a linear function is
    least by filling the cheapest slots first.
    """
    at, low, high = relaxation.columns, problem.low_kw[0], problem.high_kw[0]
    owed, least = problem.owed_kwh[0], np.inf
    for pattern in product([0.0, 1.0], repeat=at.n_pairs):
        on = np.array(pattern)
        if not on.sum() * low - 1e-12 <= owed <= on.sum() * high + 1e-12:
            continue
        power, left = low * on, owed - low * on.sum()
        for pair in np.argsort(row[: at.n_pairs]):
            more = min(left, (high - low) * on[pair])
            power[pair] += more
            left -= more
        written = at.d >= 0
        value = row[: at.n_pairs] @ power + row[at.d[written]] @ on[written] + row[at.u[0]]
        least = min(least, float(value))
    return least


@pytest.mark.parametrize("everywhere", [True, False], ids=["with D", "without D"])
def test_no_schedule_of_a_vehicle_violates_a_cut(everywhere):
    rng, found = np.random.default_rng(3), 0
    for _ in range(400):
        problem = one_charge(rng)
        relaxation = relaxed(problem, everywhere)
        at = relaxation.columns
        for _ in range(3):
            point = rng.uniform(0, 1, at.total) * (rng.random(at.total) < 0.7)
            point[: at.n_pairs] *= problem.high_kw[0]
            point[at.u] = 1.0
            cuts = violated_cuts(relaxation, point)
            if cuts.count:
                row = cuts.matrix(at.total).toarray()[0]
                lower, _ = cuts.limits()
                assert row @ point < lower[0]
                assert least_left_side(problem, relaxation, row) >= lower[0] - HAIR
                found += 1
    assert found > 200


def integer_point(
    problem: Problem, rng: np.random.Generator, price: Floats | None = None
) -> tuple[Floats, Floats, Floats]:
    """An integer-feasible point of P1, extreme in a random direction: u, D, P.

    With a `price` of each slot, (slots,), random only in u and cheapest beyond it.
    Written out for scipy on its own, sharing nothing with the solver.
    """
    n, t = problem.n_vehicles, problem.n_slots
    size, u, d, p = n + 2 * n * t, np.arange(n), n + np.arange(n * t), n + n * t + np.arange(n * t)
    rows, lower, upper = [], [], []

    def add(columns, values, low, high):
        row = np.zeros(size)
        row[columns] = values
        rows.append(row)
        lower.append(low)
        upper.append(high)

    for v in range(n):
        own = slice(v * t, (v + 1) * t)
        add([*p[own], u[v]], [1.0] * t + [-problem.owed_kwh[v] / problem.interval_hours], 0, 0)
        for slot in range(t):
            pair = v * t + slot
            add([p[pair], d[pair]], [1, -problem.low_kw[v]], 0, np.inf)
            add([p[pair], d[pair]], [1, -problem.high_kw[v]], -np.inf, 0)
            add([d[pair], u[v]], [1, -1], -np.inf, 0)
    for slot in range(t):
        add(d[slot::t], 1.0, -np.inf, problem.chargers)
        add(p[slot::t], 1.0, -np.inf, problem.rows.headroom_kw()[slot])
    open_slots = problem.window.ravel().astype(float)
    top = np.concatenate([np.ones(n), open_slots, open_slots * np.repeat(problem.high_kw, t)])
    bottom = np.where(np.arange(size) < problem.n_contracts, 1.0, 0.0)
    by_slot = rng.normal(0, 1, n * t) if price is None else np.tile(price, n)
    by_charger = rng.normal(0, 1, n * t) if price is None else np.zeros(n * t)
    cost = np.concatenate([rng.normal(-2, 4, n), by_charger, by_slot])
    result = milp(
        cost,
        constraints=LinearConstraint(np.array(rows), lower, upper),
        integrality=np.arange(size) < n + n * t,
        bounds=Bounds(bottom, top),
        options={"presolve": False},  # scipy 1.14's calls some of these infeasible
    )
    assert result.x is not None, result.message
    return result.x[u].round(), result.x[d].round().reshape(n, t), result.x[p].reshape(n, t)


@pytest.mark.parametrize("seed", range(4))
def test_integer_points_satisfy_every_row_and_cut(seed):
    rng = np.random.default_rng([11, seed])
    for _ in range(60):
        problem = random_problem(rng, max_vehicles=6, max_slots=5)
        relaxation = relaxed(problem, everywhere=bool(rng.integers(2)))
        at, program = relaxation.columns, relaxation.program
        fractional = rng.uniform(0, 1, at.total)
        fractional[: at.n_pairs] *= relaxation.charges.top_kw[at.vehicle]
        cuts = violated_cuts(relaxation, fractional)
        cut_matrix, (cut_lower, _) = cuts.matrix(at.total), cuts.limits()
        for _ in range(3):
            u, d, p = integer_point(problem, rng)
            point = np.zeros(at.total)
            point[: at.n_pairs] = p[at.vehicle, at.slot]
            written = at.d >= 0
            point[at.d[written]] = d[at.vehicle, at.slot][written]
            point[at.u] = u
            values = program.matrix @ point
            assert (values >= program.row_lower - 1e-5).all()
            assert (values <= program.row_upper + 1e-5).all()
            assert (point >= program.lower - 1e-6).all()
            assert (point <= program.upper + 1e-5).all()
            assert (cut_matrix @ point >= cut_lower - 1e-5).all()


@pytest.mark.parametrize("seed", range(4))
def test_no_lp_prices_a_choice_of_contracts_too_high(seed):
    rng, tight = np.random.default_rng([13, seed]), 0
    for _ in range(40):
        problem = random_problem(rng, max_vehicles=6, max_slots=5)
        relaxation = relaxed(problem, everywhere=False)
        at, program = relaxation.columns, relaxation.program
        search = search_over(relaxation, Effort())
        n = problem.n_vehicles
        prices = Prices(np.empty((0, n)), np.empty(0))
        contract = np.arange(n) < problem.n_contracts
        for _ in range(6):
            decided, value = rng.random(n) < 0.4, rng.integers(0, 2, n)
            lower = np.where(contract | (decided & (value == 1)), 1.0, 0.0)
            upper = np.where(~contract & decided & (value == 0), 0.0, program.upper[at.u])
            point = search.relaxed(np.minimum(lower, upper), upper, 4)
            if point is not None:
                prices.learn(point.values[at.u], point, point.reduced_cost[at.u])
        for _ in range(4):
            u, _, p = integer_point(problem, rng, problem.tariff.cost_per_kw)
            cost = problem.objective(u > 0.5, p)
            bound = (prices.offset + prices.slope @ u).max(initial=-np.inf)
            assert bound <= cost + 1e-4
            tight += bound > cost - 0.5
    assert tight > 20


def test_chargers_are_dropped_only_where_they_cannot_bind():
    rng = np.random.default_rng(5)
    dropped = 0
    for _ in range(300):
        problem = random_problem(rng)
        charges, headroom = charges_of(problem), problem.rows.headroom_kw()
        kept = contested_slots(problem, charges, headroom)
        for slot in np.flatnonzero(~kept):
            able = charges.servable & (problem.intervals_left > slot)
            lowest = np.sort(problem.low_kw[able])[: problem.chargers + 1]
            crowd = len(lowest) > problem.chargers
            assert not crowd or lowest.sum() > headroom[slot]
            dropped += 1
    assert dropped > 100
