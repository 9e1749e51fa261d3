"""Figures of a record, each declared once: what it is called, its unit, what it means."""

from dataclasses import dataclass, field, fields
from typing import Any

KEY = "figure"


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure of a record: its field, label, unit ("" for a plain number) and meaning.

    `digits` are the decimals it is told with. A `share` is between 0 and 1 and told in per cent.
    """

    name: str
    label: str
    unit: str
    meaning: str
    digits: int

    @property
    def is_share(self) -> bool:
        return self.unit == "%"

    @property
    def head(self) -> str:
        """Label and unit, as the head of a row or column."""
        return f"{self.label}, {self.unit}" if self.unit else self.label

    def told(self, value: float | None) -> str:
        """A value as a table shows it, without its unit; a dash where there is none."""
        if value is None:
            return "–"
        shown = f"{100 * value if self.is_share else value:,.{self.digits}f}"
        return shown.replace("-", "−") if shown.strip("-0.,") else shown.lstrip("-")


def figure(label: str, unit: str, meaning: str, digits: int = 0) -> Any:
    """The field of a figure."""
    return field(metadata={KEY: (label, unit, meaning, digits)})


def figures_of(record: type) -> tuple[Figure, ...]:
    """The figures a record declares, in their order."""
    return tuple(
        Figure(one.name, *one.metadata[KEY]) for one in fields(record) if KEY in one.metadata
    )
