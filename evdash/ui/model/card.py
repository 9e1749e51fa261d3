"""One equation of P1 as a card: its formula, this run's numbers in it, and a sentence."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from evdash.domain.trace import Step
from evdash.metrics.equations import (
    NodeNumbers,
    RatingNumbers,
    StationNumbers,
    VehicleNumbers,
)


@dataclass(frozen=True, slots=True)
class Numbers:
    """All that the equations of one step are filled in with; no vehicle where nobody is there."""

    step: Step
    node: NodeNumbers
    rating: RatingNumbers | None
    station: StationNumbers
    vehicle: VehicleNumbers | None

    @property
    def span(self) -> str:
        scenario, t = self.step.inputs.scenario, self.step.interval
        return f"{scenario.time_of(t):%H:%M}–{scenario.time_of(t + 1):%H:%M}"


Filled = tuple[str, str]
"""An equation with numbers, as KaTeX, and what it says in a sentence, as Markdown."""


@dataclass(frozen=True, slots=True)
class Card:
    """One equation: the paper's number, its title, its formula, its numbers, its code."""

    paper: str
    title: str
    formula: str
    fill: Callable[[Numbers], Filled]
    code: Callable[..., Any]


NOBODY = ("", "Nobody is under contract or asking in this interval.")
