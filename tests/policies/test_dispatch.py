"""Charging by precedence: what one charge can take, and who comes first."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evdash.policies.dispatch import Charge, dispatch, largest_power_kw
from evdash.policies.rules import earliest_deadline, first_come, least_laxity


def charge(owed_kw, low_kw=2.0, high_kw=10.0, slots=4, order=0):
    return Charge(owed_kw, low_kw, high_kw, slots, order)


def reachable(owed_kw, low_kw, high_kw):
    """Whether some whole number of slots holds the energy."""
    return owed_kw == 0 or any(
        m * low_kw <= owed_kw + 1e-9 and owed_kw <= m * high_kw + 1e-9 for m in range(1, 60)
    )


@given(
    owed_kw=st.integers(1, 80),
    low_kw=st.integers(1, 6),
    wider_kw=st.integers(0, 8),
    room_kw=st.integers(0, 20),
)
def test_the_largest_power_that_leaves_a_rest_that_can_be_charged(
    owed_kw, low_kw, wider_kw, room_kw
):
    high_kw = low_kw + wider_kw
    low_kw = min(low_kw, owed_kw)
    found = largest_power_kw(owed_kw, charge(owed_kw, low_kw, high_kw), room_kw)
    # all numbers whole, so a whole power is among the largest
    possible = [
        power
        for power in range(low_kw, min(high_kw, owed_kw, room_kw) + 1)
        if reachable(owed_kw - power, low_kw, high_kw)
    ]
    assert found == pytest.approx(max(possible, default=0))


def test_precedence_decides_who_waits():
    late = charge(10.0, slots=4, order=0)
    soon = charge(10.0, slots=1, order=1)
    room = np.full(4, 10.0)
    assert dispatch([late, soon], room, [1] * 4, first_come) is None
    power = dispatch([late, soon], room, [1] * 4, earliest_deadline)
    assert power.tolist() == [[0, 10, 0, 0], [10, 0, 0, 0]]


def test_laxity_counts_what_is_owed_against_the_time_left():
    much = charge(30.0, slots=4, order=1)
    little = charge(5.0, slots=3, order=0)
    power = dispatch([much, little], np.full(4, 10.0), [1] * 4, least_laxity)
    assert power.tolist() == [[10, 10, 0, 10], [0, 0, 5, 0]]


def test_chargers_and_room_are_shared():
    charges = [charge(10.0, order=n) for n in range(3)]
    power = dispatch(charges, np.full(4, 15.0), [2] * 4, first_come)
    assert power.T.tolist() == [[10, 5, 0], [0, 5, 10], [0, 0, 0], [0, 0, 0]]
