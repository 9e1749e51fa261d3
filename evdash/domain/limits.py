"""What the feeder hands over to scheduling: named linear limits on station power."""

import base64
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import PlainSerializer, PlainValidator

from evdash.domain.elements import Element, Kept


def _in_words(array: NDArray[np.float64]) -> dict[str, Any]:
    """An array to the bit as JSON can carry it: its shape and its bytes."""
    little = np.ascontiguousarray(array, dtype="<f8")
    return {"shape": list(array.shape), "float64": base64.b64encode(little.tobytes()).decode()}


def _from_words(value: Any) -> NDArray[np.float64]:
    if not isinstance(value, dict) or set(value) != {"shape", "float64"}:
        raise ValueError("should be an array as shape and float64")
    flat = np.frombuffer(base64.b64decode(value["float64"], validate=True), dtype="<f8")
    return flat.reshape(value["shape"])  # read-only, as everything in a trace is


Floats = Annotated[
    NDArray[np.float64],
    PlainValidator(_from_words),
    PlainSerializer(_in_words, when_used="json"),
]
STATION = 0
"""The one port there is today: the charging station."""


@dataclass(frozen=True, slots=True)
class LimitRows:
    """Σ_port coefficient[row, port] · power_kw[port] ≤ limit_kw[interval, row].

    `elements` are what each row stands for. Rows of the station's port are scaled to
    coefficient 1, so that a limit is that element's headroom. Shapes: elements (rows,),
    coefficient (rows, ports), limit_kw (intervals, rows).
    """

    elements: tuple[Kept, ...]
    coefficient: Floats
    limit_kw: Floats

    def from_interval(self, interval: int) -> "LimitRows":
        """The rows of `interval` and later."""
        return LimitRows(self.elements, self.coefficient, self.limit_kw[interval:])

    def capacity_kw(self) -> Floats:
        """Room of each row for the station alone, kW, shape (intervals, rows), never below 0."""
        return np.maximum(0.0, self.limit_kw) / self.coefficient[:, STATION]

    def headroom_kw(self) -> Floats:
        """Largest station power of each interval, kW, shape (intervals,); inf if unlimited."""
        if not self.elements:
            return np.full(len(self.limit_kw), np.inf)
        return np.asarray(self.capacity_kw().min(axis=1))

    def binding(self) -> tuple[Element | None, ...]:
        """The tightest element of each interval, whether reached or not; None if unlimited."""
        if not self.elements:
            return (None,) * len(self.limit_kw)
        # argmin of the unclipped limits: of two elements without room, the one further beyond
        tightest = (self.limit_kw / self.coefficient[:, STATION]).argmin(axis=1)
        return tuple(self.elements[row] for row in tightest)
