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
    """What flows on one side of some ratings, at each of their ends, (…, ends).

    `end_kva`, and how much of it is reactive alone, `end_kvar`; both -inf where no active power
    flows that way, NaN where nothing is known.
    """

    end_kva: Floats
    end_kvar: Floats

    @property
    def kva(self) -> Floats:
        """The larger of both ends."""
        return np.asarray(self.end_kva.max(axis=-1))

    def held_kva(self, base_end_kva: Floats) -> Floats:
        """What of `kva` is not the station's doing: what this side has without it.

        An end empty on this side without the station has its reactive power alone: that fills it
        already when active power turns, and a rating below it was exceeded on the other side.
        """
        held_kva = np.where(np.isneginf(base_end_kva), self.end_kvar, base_end_kva)
        return np.asarray(held_kva.max(axis=-1))


def by_side(power: Power) -> tuple[Side, Side]:
    """Import and export of ratings whose ends carry `power` (…, ends)."""
    away = power.real >= 0
    return _side(power, away), _side(power, ~away)


def _side(power: Power, there: NDArray[np.bool_]) -> Side:
    elsewhere = np.where(there, 0.0, -np.inf)
    return Side(np.abs(power) + elsewhere, np.abs(power.imag) + elsewhere)


def away_from_source(feeder: RadialFeeder, into_from: Power, into_to: Power) -> Power:
    """What flows away from the source at both ends of each line, the nearer first, (…, lines, 2).

    `into_from` and `into_to` (…, lines) are what flows into a line at its from_node and to_node.
    """
    near = np.where(feeder.starts_at_source, into_from, into_to)
    far = np.where(feeder.starts_at_source, into_to, into_from)
    return np.stack([near, -far], axis=-1)
