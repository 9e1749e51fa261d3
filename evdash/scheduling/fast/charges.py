"""What one vehicle's charge comes to in whole slots: the numbers all cuts are made of.

Powers are mean kW over a slot, so that energy owed is a sum of powers, in kW·slots.
"""

from dataclasses import dataclass

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.problem import Bools, Ints, Problem

WHOLE = 1e-9
"""Keeps 5.000000000000001 slots at 5."""


@dataclass(frozen=True, slots=True)
class Charges:
    """Each vehicle's charge; all arrays (vehicles,).

    `owed_kw` s: energy owed, kW·slots. `top_kw` p: the most it can take in a slot,
    min(high, s). `fewest` m = ⌈s/p⌉: the fewest slots. `rest_kw` r = s − (m − 1)·p: what the
    last of the fewest slots holds. `least_kw` max(r, low): with j < m slots elsewhere, the
    slots left hold at least this for each of the m − j missing. `slots` L: where the
    window ends, and its length but for who is late. `servable`: whether any number of slots
    within the window can hold the charge.
    """

    owed_kw: Floats
    low_kw: Floats
    top_kw: Floats
    fewest: Ints
    rest_kw: Floats
    least_kw: Floats
    slots: Ints
    servable: Bools


def charges_of(problem: Problem) -> Charges:
    """The charge of every vehicle of a problem."""
    s, low = problem.owed_kwh / problem.interval_hours, problem.low_kw
    p = np.minimum(problem.high_kw, s)
    slots = np.minimum(problem.intervals_left, problem.n_slots)
    there = slots - problem.first_slot
    per_slot = np.where(p > 0, p, 1.0)
    m = np.maximum(1, np.ceil(s / per_slot - WHOLE)).astype(np.int64)
    r = np.clip(s - (m - 1) * p, 0.0, p)
    return Charges(
        owed_kw=s,
        low_kw=low,
        top_kw=p,
        fewest=m,
        rest_kw=r,
        least_kw=np.maximum(r, low),
        slots=slots,
        servable=(m <= there) & (m * low <= s + WHOLE) & (s <= m * p + WHOLE),
    )
