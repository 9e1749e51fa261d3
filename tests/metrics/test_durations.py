"""Duration and depth beyond thresholds, counted by hand and against a count cell by cell."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from evdash.metrics.durations import Beyond, above, below

NODES = ("a", "b")
VOLTAGE = np.array([[0.99, 1.00], [0.96, 0.97], [0.95, 0.98], [0.99, 0.96], [0.96, 1.00]])


def test_a_day_counted_by_hand():
    found = below(VOLTAGE, 0.97, NODES, 0.5)
    assert found == Beyond(
        threshold=0.97,
        hours=2.0,  # intervals 1, 2, 3, 4
        element_hours=2.0,  # a in 1, 2, 4; b in 3
        longest_hours=1.0,  # a in 1 and 2
        depth=pytest.approx(0.02),
        element="a",
        interval=2,
    )


def test_at_the_threshold_is_not_beyond_it():
    assert below(VOLTAGE, 0.95, NODES, 1.0) == Beyond(0.95)
    assert above(VOLTAGE, 1.0, NODES, 1.0) == Beyond(1.0)


def test_where_nothing_is_known_nothing_is_beyond():
    missing = np.where(VOLTAGE < 0.96, np.nan, VOLTAGE)
    assert below(missing, 0.97, NODES, 1.0).hours == 3.0
    assert below(np.full((3, 2), np.nan), 0.97, NODES, 1.0) == Beyond(0.97)


@given(
    arrays(float, (6, 3), elements=st.floats(-2, 2)),
    st.floats(-2, 2).map(lambda value: round(value, 3)),
)
def test_above_mirrors_below_and_counts_cell_by_cell(values, threshold):
    found = above(values, threshold, ("x", "y", "z"), 0.25)
    mirrored = below(-values, -threshold, ("x", "y", "z"), 0.25)
    assert (found.hours, found.element_hours, found.depth) == (
        mirrored.hours,
        mirrored.element_hours,
        mirrored.depth,
    )
    cells = [(t, e) for t in range(6) for e in range(3) if values[t, e] - threshold > 1e-9]
    assert found.element_hours == 0.25 * len(cells)
    assert found.hours == 0.25 * len({t for t, _ in cells})
    longest = 0
    for first in range(6):
        for last in range(first, 6):
            if any(all((t, e) in cells for t in range(first, last + 1)) for e in range(3)):
                longest = max(longest, last - first + 1)
    assert found.longest_hours == 0.25 * longest
