"""The least amount where admission comes and goes with it, by a made-up P1."""

from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evdash.explain.changes import Change
from evdash.explain.search import Ladder
from evdash.scheduling.problem import OPTIMALITY_USD


@dataclass
class MadeUp:
    """Values of P1 with and without a vehicle by number of steps, both falling."""

    with_it: list[float]
    without: list[float]
    fitting: int = 0
    others: frozenset[str] = frozenset()

    def admits(self, change: Change) -> bool:
        return self.with_it[change.chargers] < self.without[change.chargers]

    def cannot_fit(self, change: Change) -> bool:
        return change.chargers < self.fitting

    def cost(self, change: Change) -> float:
        return min(self.with_it[change.chargers], self.without[change.chargers])

    def none_between(self, less: Change, more: Change) -> bool:
        return self.with_it[more.chargers] >= self.cost(less) - OPTIMALITY_USD


def climb(made_up: MadeUp, start: int = 1):
    most = len(made_up.without) - 1
    return Ladder(made_up, lambda n: Change(chargers=n)).climb(start, most)


def test_a_first_window_below_the_doubling_is_found():
    """Admitted with 3, refused with 4 to 7, admitted with 8: doubling alone says 8."""
    without = [0.0, 0.0, 0.0, 0.0, -5.0, -5.0, -5.0, -5.0, -5.0]
    with_it = [9.0, 9.0, 9.0, -1.0, -1.0, -1.0, -1.0, -1.0, -9.0]
    found = climb(MadeUp(with_it, without))
    assert (found.steps, found.least) == (3, True)


def test_none_is_proven_where_the_vehicle_never_pays():
    found = climb(MadeUp([5.0] * 20, [0.0] * 20))
    assert (found.steps, found.least) == (None, True)


falling = st.lists(st.integers(0, 3), min_size=2, max_size=40).map(
    lambda drops: [10.0 - sum(drops[: n + 1]) for n in range(len(drops))]
)


@given(falling, falling, st.integers(0, 12), st.integers(1, 9))
def test_what_is_called_least_is(with_it, without, head_start, start):
    n = min(len(with_it), len(without))
    made_up = MadeUp([value + head_start for value in with_it[:n]], without[:n])
    if made_up.admits(Change()):
        return
    admitting = [k for k in range(1, n) if made_up.admits(Change(chargers=k))]
    found = climb(made_up, start)
    if found.steps is not None:
        assert found.steps in admitting
        assert found.steps - 1 not in admitting
    if found.least:
        assert found.steps == (admitting[0] if admitting else None)


@pytest.mark.parametrize("fitting", [1, 5, 19])
def test_what_does_not_fit_is_not_tried(fitting):
    tried = []

    class Watched(MadeUp):
        def admits(self, change: Change) -> bool:
            tried.append(change.chargers)
            return super().admits(change)

    with_it = [9.0] * fitting + [-1.0] * (20 - fitting)
    found = climb(Watched(with_it, [0.0] * 20, fitting))
    assert (found.steps, found.least) == (fitting, True)
    assert tried == [fitting]


def test_what_never_fits_is_proven_not_to_help():
    assert climb(MadeUp([9.0] * 20, [0.0] * 20, fitting=99)).least


def test_among_many_newcomers_the_least_found_is_called_so():
    many = frozenset(f"{n}" for n in range(30))
    found = climb(MadeUp([1.0] * 9 + [-1.0] * 11, [0.0] * 20, others=many))
    assert (found.steps, found.least) == (9, False)


@pytest.mark.parametrize("least", [1, 2, 37, 64, 99])
def test_a_single_threshold_is_always_found_and_proven(least):
    with_it = [1.0] * least + [-1.0] * (100 - least)
    found = climb(MadeUp(with_it, [0.0] * 100), start=16)
    assert (found.steps, found.least) == (least, True)
