"""Charging by a rule of precedence: slot by slot, whoever comes first takes what it can."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from evdash.domain.limits import Floats

WHOLE = 1e-9
"""Keeps 5.000000000000001 slots at 5, and what floating point leaves over at nothing."""


@dataclass(frozen=True, slots=True)
class Charge:
    """What one vehicle still wants, in mean kW of a slot.

    `owed_kw` in kW·slots; it charges at 0 or between `low_kw` and `high_kw`, in the first
    `slots` slots only. `arrival_order` is its place among all who ever came.
    """

    owed_kw: float
    low_kw: float
    high_kw: float
    slots: int
    arrival_order: int


Precedence = Callable[[Charge, float, int], tuple[float, ...]]
"""Key of a charge with so much still owed (kW·slots) and so many slots left; lowest goes first."""


def dispatch(
    charges: Sequence[Charge], room_kw: Floats, chargers: Sequence[int], precedence: Precedence
) -> Floats | None:
    """Power (charges, slots), kW, by precedence; None if not everyone gets all in time.

    `room_kw` (slots,) is what the feeder allows, `chargers` (slots,) how many may charge.
    """
    power = np.zeros((len(charges), len(room_kw)))
    owed = [charge.owed_kw for charge in charges]
    for slot in range(len(room_kw)):
        wanting = [n for n, c in enumerate(charges) if owed[n] > WHOLE and slot < c.slots]
        wanting.sort(key=lambda n: precedence(charges[n], owed[n], charges[n].slots - slot))
        room, free = float(room_kw[slot]), chargers[slot]
        for n in wanting:
            if free <= 0:
                break
            taken = largest_power_kw(owed[n], charges[n], room)
            if taken > 0:
                power[n, slot], owed[n] = taken, owed[n] - taken
                room, free = room - taken, free - 1
    return power if max(owed, default=0.0) <= WHOLE else None


def largest_power_kw(owed_kw: float, charge: Charge, room_kw: float) -> float:
    """The most a charge can take in one slot so that what it leaves can still be charged; or 0.

    A rest that no whole number of slots holds between `low_kw` and `high_kw` would be stuck.
    """
    most = min(charge.high_kw, owed_kw, room_kw)
    if most < charge.low_kw - WHOLE:
        return 0.0
    later = math.ceil((owed_kw - most) / charge.high_kw - WHOLE)
    taken = min(most, owed_kw - later * charge.low_kw)
    return taken if taken >= charge.low_kw - WHOLE else 0.0
