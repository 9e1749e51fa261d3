"""What an LP's duals say of every choice of contracts, against each choice's own LP."""

from itertools import product

import numpy as np
import pytest

from evdash.scheduling.effort import Effort
from evdash.scheduling.fast.branch import added_cost, priced_columns
from evdash.scheduling.fast.relaxation import Relaxation, made_from
from evdash.scheduling.fast.search import CUT_ROUNDS, Search
from evdash.scheduling.fast.solver import search_over
from evdash.scheduling.highs import LpPoint
from tests.scheduling.problems import random_problem

HAIR = 1e-7


def over(search: Search, lower: np.ndarray, upper: np.ndarray) -> LpPoint | None:
    """The LP over these bounds on u, cut where it can be."""
    return search.relaxed(lower, upper, CUT_ROUNDS)


def choices_of(relaxation: Relaxation) -> list[np.ndarray]:
    """Every choice of contracts, (vehicles,) each."""
    program, u = relaxation.program, relaxation.columns.u
    free = np.flatnonzero(program.lower[u] < program.upper[u])
    choices = []
    for one in product([0.0, 1.0], repeat=len(free)):
        choice = program.lower[u].copy()
        choice[free] = one
        choices.append(choice)
    return choices


@pytest.mark.parametrize("seed", range(4))
def test_no_choice_costs_less_than_it_is_priced_at(seed):
    """Whatever LP the duals are of: of the whole, or of a single choice."""
    rng, tight, priced = np.random.default_rng([23, seed]), 0, 0
    for _ in range(30):
        relaxation = made_from(random_problem(rng))
        choices, search = choices_of(relaxation), search_over(relaxation, Effort())
        costs = [
            np.inf if (point := over(search, choice, choice)) is None else point.objective
            for choice in choices
        ]
        program, u = relaxation.program, relaxation.columns.u
        sources = [(program.lower[u], program.upper[u])]
        sources += [(choices[n], choices[n]) for n in rng.integers(0, len(choices), 3)]
        for lower, upper in sources:
            point = over(search, lower, upper)
            if point is None:
                continue
            added = added_cost(relaxation, point)
            base = point.objective - added @ point.values[u]
            for choice, cost in zip(choices, costs, strict=True):
                bound = base + added @ choice
                assert bound <= cost + HAIR * (1 + abs(cost))
                tight += bound > cost - HAIR
                priced += 1
    assert priced > 300
    assert tight > 100


def test_it_says_no_less_than_reduced_costs_and_at_times_more():
    rng, more = np.random.default_rng(29), 0
    for _ in range(60):
        relaxation = made_from(random_problem(rng))
        search, u = search_over(relaxation, Effort()), relaxation.columns.u
        program = relaxation.program
        point = over(search, program.lower[u], program.upper[u])
        if point is None:
            continue
        refused = (program.lower[u] < program.upper[u]) & (point.values[u] < HAIR)
        added, reduced = added_cost(relaxation, point), point.reduced_cost[u]
        assert (added[refused] >= reduced[refused] - HAIR).all()
        more += (added[refused] > reduced[refused] + 1e-3).sum()
    assert more > 10


def test_shared_rows_are_those_with_columns_of_several_vehicles():
    """Every other row is one vehicle's own and limits nothing but in proportion to its u."""
    rng, seen = np.random.default_rng(31), 0
    for _ in range(40):
        relaxation = made_from(random_problem(rng))
        at, program = relaxation.columns, relaxation.program
        owner = np.concatenate([at.vehicle, at.vehicle[at.d >= 0], np.arange(len(at.u))])
        matrix = program.matrix
        own = np.setdiff1d(np.arange(matrix.shape[0]), np.r_[relaxation.shared])
        for row in own:
            assert len(set(owner[matrix[row].indices])) == 1
            assert {program.row_lower[row], program.row_upper[row]} <= {0.0, np.inf, -np.inf}
            seen += 1
    assert seen > 100


def test_an_lp_is_worth_its_shared_limits_at_their_duals_and_each_vehicles_part():
    rng = np.random.default_rng(37)
    for _ in range(40):
        relaxation = made_from(random_problem(rng))
        search, program = search_over(relaxation, Effort()), relaxation.program
        u = relaxation.columns.u
        point = over(search, program.lower[u], program.upper[u])
        if point is None:
            continue
        limit = np.nan_to_num(program.row_upper[relaxation.shared], posinf=0.0)
        paid = limit @ point.row_dual[relaxation.shared]
        parts = priced_columns(relaxation, point) @ point.values
        assert paid + parts == pytest.approx(point.objective, abs=1e-6)
