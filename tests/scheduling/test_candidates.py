"""Lists of choices against all choices there are, one by one."""

from itertools import product
from unittest.mock import patch

import numpy as np
import pytest

from evdash.scheduling.fast import candidates
from evdash.scheduling.fast.candidates import Knapsacks, Prices, knapsacks_of, listed
from evdash.scheduling.fast.relaxation import made_from
from tests.scheduling.problems import random_problem


def random_inequalities(rng: np.random.Generator, n: int) -> tuple[Prices, Knapsacks]:
    prices = Prices(rng.normal(0, 1, (int(rng.integers(1, 5)), n)), rng.normal(0, 1, 0))
    prices.offset = rng.normal(0, 1, len(prices.slope))
    weight = rng.uniform(0, 1, (int(rng.integers(0, 4)), n)) * (rng.random(n) < 0.7)
    return prices, Knapsacks(weight, rng.uniform(0, 0.4 * n, len(weight)))


@pytest.mark.parametrize("seed", range(5))
def test_a_list_holds_all_that_is_possible_and_cheap_and_nothing_else(seed):
    rng, lengths = np.random.default_rng([17, seed]), set()
    for _ in range(40):
        n, below = int(rng.integers(0, 9)), float(rng.normal(0, 1.5))
        prices, knapsacks = random_inequalities(rng, n)
        expected = {}
        for one in product([False, True], repeat=n):
            x = np.array(one, dtype=bool)
            bound = max(prices.offset + prices.slope @ x)
            if bound < below and (knapsacks.weight @ x <= knapsacks.room).all():
                expected[one] = bound
        found = listed(prices, knapsacks, below)
        assert found is not None
        rows = [tuple(map(bool, x)) for x in found.x]
        assert sorted(rows) == sorted(expected)
        assert found.bound == pytest.approx([expected[row] for row in rows])
        lengths.add(len(rows))
    assert len(lengths) > 5


def test_a_list_that_grows_too_long_is_none():
    prices, no_rows = (
        Prices(np.zeros((1, 8)), np.zeros(1)),
        Knapsacks(np.empty((0, 8)), np.empty(0)),
    )
    with patch.object(candidates, "MOST", 255):
        assert listed(prices, no_rows, 1.0) is None
    with patch.object(candidates, "MOST", 256):
        found = listed(prices, no_rows, 1.0)
    assert found is not None
    assert len(found.x) == 256


def test_knapsacks_are_the_rows_over_contracts_alone():
    rng, seen = np.random.default_rng(19), 0
    for _ in range(60):
        problem = random_problem(rng)
        relaxation = made_from(problem)
        program, u = relaxation.program, relaxation.columns.u
        doubt = np.flatnonzero(program.lower[u] < program.upper[u])
        knapsacks = knapsacks_of(relaxation, doubt)
        for weight, room in zip(knapsacks.weight, knapsacks.room, strict=True):
            dense = program.matrix.toarray()
            alike = (dense[:, : u[0]] == 0).all(axis=1) & (dense[:, u[doubt]] == weight).all(axis=1)
            used = dense[:, u] @ program.lower[u]
            assert np.isclose(program.row_upper[alike] - used[alike], room, atol=1e-5).any()
            assert (weight >= 0).all()
            seen += 1
    assert seen > 30
