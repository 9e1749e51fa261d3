"""The two sides of a rating: what flows away from the source, and what flows back to it.

Each counts by itself (decision 5 of `docs/equations.md`). A rating exceeded by generation that
flows back, which charging relieves, allows nothing on the other side.
"""

import numpy as np
from numpy.typing import NDArray

from evdash.domain.limits import Floats
from evdash.grid.radial import RadialFeeder

Power = NDArray[np.complex128]
"""kW + j kvar, counted away from the source."""
EXPORT = ":export"
"""What an element's name ends with where power flows back through it."""


def by_side(power: Power) -> tuple[Floats, Floats]:
    """kVA on the side on which active power flows, import and export; -inf on the other."""
    kva, away = np.abs(power), power.real >= 0
    return np.where(away, kva, -np.inf), np.where(away, -np.inf, kva)


def held_by_side(power: Power) -> tuple[Floats, Floats]:
    """kVA that each side has by what flows already, import and export.

    Reactive power alone counts on both: beyond it the other side is not exceeded before active
    power flows there.
    """
    active, reactive = power.real, power.imag
    return (
        np.hypot(np.maximum(active, 0.0), reactive),
        np.hypot(np.maximum(-active, 0.0), reactive),
    )


def away_from_source(feeder: RadialFeeder, into_from: Power, into_to: Power) -> Power:
    """What flows away from the source at both ends of each line, the nearer first, (…, lines, 2).

    `into_from` and `into_to` (…, lines) are what flows into a line at its from_node and to_node.
    """
    near = np.where(feeder.starts_at_source, into_from, into_to)
    far = np.where(feeder.starts_at_source, into_to, into_from)
    return np.stack([near, -far], axis=-1)
