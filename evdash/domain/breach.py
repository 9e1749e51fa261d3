"""A limit exceeded, whoever found it."""

from dataclasses import dataclass

from evdash.domain.elements import Element


@dataclass(frozen=True, slots=True)
class Breach:
    """A limit exceeded in one interval by `depth`, in `unit`.

    `base_depth` is how far this side of it is exceeded without the station, or by reactive power
    alone where no active power flows that way without it; `tolerance` what counts as equal, in
    the same unit.
    """

    interval: int
    element: Element
    depth: float
    base_depth: float
    unit: str
    tolerance: float

    @property
    def by_station(self) -> bool:
        """Whether charging causes or worsens it; otherwise it is the feeder's own."""
        return self.depth > self.base_depth + self.tolerance
