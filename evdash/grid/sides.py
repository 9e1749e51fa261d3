"""The two sides of a rating: what flows away from the source, and what flows back to it.

Each counts by itself (decision 5 of `docs/equations.md`). A rating exceeded by generation that
flows back, which charging relieves, allows nothing on the other side.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evdash.domain.limits import Floats
from evdash.grid.radial import RadialFeeder

Power = NDArray[np.complex128]
"""kW + j kvar, counted away from the source."""


@dataclass(frozen=True, slots=True)
class Side:
    """What flows on one side of some ratings: kVA, and how much of it is reactive alone, kvar.

    Of both ends the larger. -inf where no active power flows that way, NaN where nothing is known.
    """

    kva: Floats
    reactive_kvar: Floats

    def held_kva(self, base_kva: Floats) -> Floats:
        """What of `kva` is not the station's doing: what this side has without it, `base_kva`.

        A side that is empty without the station has its reactive power alone: that fills it
        already when active power turns, and a rating below it was exceeded on the other side.
        """
        return np.where(np.isneginf(base_kva), self.reactive_kvar, base_kva)


def by_side(power: Power) -> tuple[Side, Side]:
    """Import and export of ratings whose ends carry `power` (…, ends)."""
    away = power.real >= 0
    return _side(power, away), _side(power, ~away)


def _side(power: Power, there: NDArray[np.bool_]) -> Side:
    elsewhere = np.where(there, 0.0, -np.inf)
    return Side(
        kva=(np.abs(power) + elsewhere).max(axis=-1),
        reactive_kvar=(np.abs(power.imag) + elsewhere).max(axis=-1),
    )


def away_from_source(feeder: RadialFeeder, into_from: Power, into_to: Power) -> Power:
    """What flows away from the source at both ends of each line, the nearer first, (…, lines, 2).

    `into_from` and `into_to` (…, lines) are what flows into a line at its from_node and to_node.
    """
    near = np.where(feeder.starts_at_source, into_from, into_to)
    far = np.where(feeder.starts_at_source, into_to, into_from)
    return np.stack([near, -far], axis=-1)
