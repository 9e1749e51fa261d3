"""How long and how deep a quantity is beyond a threshold: tables planners ask for."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from evdash.domain.limits import Floats

TOLERANCE = 1e-9


@dataclass(frozen=True, slots=True)
class Beyond:
    """One threshold over the horizon, for all elements together; nothing beyond it is all zero.

    `hours` in which at least one element is beyond it, `element_hours` summed over elements,
    `longest_hours` without a break at one element. `depth` is the deepest, at `element` in
    interval `interval`, in the quantity's own unit.
    """

    threshold: float
    hours: float = 0.0
    element_hours: float = 0.0
    longest_hours: float = 0.0
    depth: float = 0.0
    element: str = ""
    interval: int | None = None


def above(
    values: Floats, threshold: float, elements: Sequence[str], interval_hours: float
) -> Beyond:
    """Where `values` (intervals, elements) are above a threshold; NaN counts as not beyond."""
    return _beyond(values - threshold, threshold, elements, interval_hours)


def below(
    values: Floats, threshold: float, elements: Sequence[str], interval_hours: float
) -> Beyond:
    """Where `values` (intervals, elements) are below a threshold; NaN counts as not beyond."""
    return _beyond(threshold - values, threshold, elements, interval_hours)


def longest_run(beyond: np.ndarray) -> int:
    """The most consecutive true rows in any column of (intervals, elements)."""
    run = np.zeros(beyond.shape[1], dtype=int)
    longest = 0
    for row in beyond:
        run = np.where(row, run + 1, 0)
        longest = max(longest, int(run.max(initial=0)))
    return longest


def _beyond(
    depth: Floats, threshold: float, elements: Sequence[str], interval_hours: float
) -> Beyond:
    depth = np.nan_to_num(depth, nan=-np.inf)
    beyond = depth > TOLERANCE
    if not beyond.any():
        return Beyond(threshold)
    interval, element = np.unravel_index(int(depth.argmax()), depth.shape)
    return Beyond(
        threshold=threshold,
        hours=float(beyond.any(axis=1).sum()) * interval_hours,
        element_hours=float(beyond.sum()) * interval_hours,
        longest_hours=longest_run(beyond) * interval_hours,
        depth=float(depth[interval, element]),
        element=elements[int(element)],
        interval=int(interval),
    )
