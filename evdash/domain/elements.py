"""What limits stand on: nodes, lines and the chargers, as data; `domain.words` puts them in words.

Files name an element in one cell, `voltage_min:652`, `line:633-634`, `node:634` or `chargers`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal, get_args

from pydantic import BeforeValidator

ElementKind = Literal["voltage_min", "voltage_max", "line", "node", "power_flow", "chargers"]
EXPORT = ":export"
"""What an element's name in files ends with where power flowing back is limited."""


@dataclass(frozen=True, slots=True, order=True)
class Element:
    """One limit of the feeder or the station.

    `voltage_min` and `voltage_max` are those of a node's voltage, `node` the rating of its net
    injection, `line` the rating of the line or transformer between `node` and `to_node`, in the
    order of `lines.csv`; `power_flow` is where AC power flow has no solution, `chargers` how many
    vehicles may charge at once. `is_export`: the side of a rating on which power flows back.
    """

    kind: ElementKind
    node: str = ""
    to_node: str = ""
    is_export: bool = False

    @property
    def name(self) -> str:
        """Its node, or its line as `633-634`; two lines may share a name, never an element."""
        return f"{self.node}-{self.to_node}" if self.kind == "line" else self.node

    @property
    def is_voltage(self) -> bool:
        """Whether it limits a voltage."""
        return self.kind in ("voltage_min", "voltage_max")

    @property
    def is_rating(self) -> bool:
        """Whether it limits what flows, in kVA."""
        return self.kind in ("line", "node")

    @property
    def import_side(self) -> "Element":
        """The same element, whichever side of it is meant."""
        return replace(self, is_export=False)

    @property
    def export_side(self) -> "Element":
        """The side of a rating on which power flows back."""
        return replace(self, is_export=True)

    def __str__(self) -> str:
        """As files name it."""
        if self.kind == "chargers":
            return self.kind
        return f"{self.kind}:{self.name}{EXPORT if self.is_export else ''}"

    @classmethod
    def read(cls, text: str) -> "Element":
        """The element of a name in a file; a line's first node is what comes before the first `-`.

        Raises ValueError where no element has such a name.
        """
        kind, _, name = text.removesuffix(EXPORT).partition(":")
        node, _, to_node = name.partition("-") if kind == "line" else (name, "", "")
        if kind not in KINDS or bool(name) != (kind != "chargers"):
            raise ValueError(f"{text!r} names no element")
        return cls(KINDS[kind], node, to_node, text.endswith(EXPORT))


KINDS: Mapping[str, ElementKind] = {kind: kind for kind in get_args(ElementKind)}
CHARGERS = Element("chargers")
"""The one limit that is no element of the feeder."""


def _from_older(value: Any) -> Any:
    """Earlier versions kept the name alone."""
    return Element.read(value) if isinstance(value, str) else value


Kept = Annotated[Element, BeforeValidator(_from_older)]
"""An element as it is read back, also from what earlier versions kept."""
