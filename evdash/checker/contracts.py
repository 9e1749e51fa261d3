"""Does a schedule keep every promise and every limit of the chargers?"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from evdash.domain.limits import Floats

ENERGY_KWH = 1e-6
POWER_KW = 1e-6


@dataclass(frozen=True, slots=True)
class Promise:
    """What one vehicle was promised, in the checker's own terms.

    Charging is allowed in intervals [first, deadline); `owed_kwh` is still to come.
    """

    vehicle: str
    first: int
    deadline: int
    owed_kwh: float
    min_kw: float
    max_kw: float


def broken_promises(
    promises: Sequence[Promise], power_kw: Floats, begin: int, interval_hours: float
) -> list[str]:
    """What is wrong with `power_kw` (vehicles, intervals from `begin` on), in words."""
    problems = []
    for promise, row in zip(promises, power_kw, strict=True):
        problems += _row_problems(promise, row, begin, interval_hours)
    return problems


def _row_problems(promise: Promise, row: Floats, begin: int, hours: float) -> list[str]:
    problems = []
    if not np.all(np.isfinite(row)) or (row < 0).any():
        return [f"{promise.vehicle}: power is not a number of at least 0 kW"]
    delivered = math.fsum(float(value) for value in row) * hours
    if abs(delivered - promise.owed_kwh) > ENERGY_KWH:
        problems.append(
            f"{promise.vehicle}: {delivered:.6f} kWh planned, {promise.owed_kwh:.6f} kWh owed"
        )
    owed = promise.owed_kwh
    lowest = min(promise.min_kw, owed / hours)
    for slot in np.flatnonzero(row > 0):
        interval, power = begin + int(slot), float(row[slot])
        if not promise.first <= interval < promise.deadline:
            problems.append(f"{promise.vehicle}: charges in interval {interval}, outside its time")
        if power > promise.max_kw + POWER_KW:
            problems.append(
                f"{promise.vehicle}: {power:.6f} kW in interval {interval}, "
                f"at most {promise.max_kw:g} kW"
            )
        if power < lowest - POWER_KW:
            problems.append(
                f"{promise.vehicle}: {power:.6f} kW in interval {interval}, "
                f"at least {lowest:g} kW while charging"
            )
    return problems


def charger_excess(charging: Sequence[int], chargers: int, begin: int) -> list[str]:
    """Intervals in which more vehicles charge than chargers exist, in words."""
    return [
        f"{count} vehicles charge in interval {begin + slot}, {chargers} chargers exist"
        for slot, count in enumerate(charging)
        if count > chargers
    ]
