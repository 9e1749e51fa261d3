"""A limit exceeded, whoever found it."""

from dataclasses import dataclass

EXPORT = ":export"
"""What the element's name ends with in a breach by power flowing back through it."""


@dataclass(frozen=True, slots=True)
class Breach:
    """A limit exceeded in one interval by `depth`, in `unit`.

    `base_depth` is how far this side of it is exceeded without the station, or by reactive power
    alone where no active power flows that way without it; `tolerance` what counts as equal, in
    the same unit. `is_export`: by power flowing back through a rated element.
    """

    interval: int
    element: str
    depth: float
    base_depth: float
    unit: str
    tolerance: float
    is_export: bool = False

    @property
    def limit(self) -> str:
        """The element whatever the side, as `binding` names it."""
        return self.element.removesuffix(EXPORT) if self.is_export else self.element

    @property
    def by_station(self) -> bool:
        """Whether charging causes or worsens it; otherwise it is the feeder's own."""
        return self.depth > self.base_depth + self.tolerance
