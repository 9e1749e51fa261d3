"""How much a search may do: shares of a whole, and answers that hang on work, not on the clock."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from evdash.scheduling.effort import Effort
from evdash.scheduling.problem import Problem
from evdash.scheduling.shortfall import least_shortfall
from tests.scheduling.problems import random_problem

HALF_WAY = 150_000.0
"""Work after which a search of `crowded` has found something and proven nothing."""


def test_a_part_draws_on_the_whole():
    whole = Effort(work=100.0)
    part = whole.part(0.5)
    part.spend(30.0)
    assert (part.work, whole.work) == (20.0, 70.0)
    whole.part(1.0).spend(60.0)
    assert (part.work, whole.work) == (10.0, 10.0), "no part has more than the whole"


def test_spent_is_spent():
    assert Effort(work=0.0).is_spent
    assert not Effort().is_spent
    assert not Effort(10.0).part(0.1).is_spent


def test_what_was_cut_short_is_known_of_the_whole():
    whole = Effort()
    whole.part(0.5).part(0.5).cut()
    assert (whole.cut_short, whole.left_behind) == (True, False)
    assert not whole.is_spent


def test_after_a_solver_that_did_not_come_back_nobody_in_the_whole_asks_another():
    whole = Effort()
    other = whole.part(0.5)
    whole.part(0.5).leave_behind()
    assert (whole.cut_short, whole.left_behind) == (True, True)
    assert whole.is_spent
    assert other.is_spent


def crowded() -> Problem:
    """35 contracts, 5 chargers and hardly any headroom: more is short than any eye could settle."""
    rng = np.random.default_rng(1)
    problem = random_problem(rng, 40, 24)
    while problem.n_vehicles < 25 or problem.n_slots < 16 or problem.low_kw.max() < 2:
        problem = random_problem(rng, 40, 24)
    rows = replace(problem.rows, limit_kw=np.full_like(problem.rows.limit_kw, 30.0))
    return replace(problem, n_contracts=problem.n_vehicles, rows=rows, chargers=5)


@contextmanager
def busy(threads: int = 4) -> Iterator[None]:
    """A processor with much else to do."""
    over = threading.Event()

    def turn() -> None:
        while not over.is_set():
            sum(range(1000))

    for _ in range(threads):
        threading.Thread(target=turn, daemon=True).start()
    try:
        yield
    finally:
        over.set()


def test_what_work_cuts_short_is_the_same_on_a_busy_machine_and_said_not_to_be_proven():
    problem = crowded()
    idle_effort, busy_effort = Effort(HALF_WAY), Effort(HALF_WAY)
    idle = least_shortfall(problem, idle_effort)
    with busy():
        under_load = least_shortfall(problem, busy_effort)
    assert np.array_equal(idle.power_kw, under_load.power_kw)
    assert idle_effort.work == busy_effort.work
    assert idle_effort.cut_short
    assert not idle_effort.left_behind
    assert not (idle.proven and idle.fewest)
    longer = least_shortfall(problem, Effort(3 * HALF_WAY))
    assert longer.short_kwh.sum() < idle.short_kwh.sum() - 1.0
