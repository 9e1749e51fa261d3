"""A prepared case as data: what to press, and claims on the run that comes of it.

Every number a case tells is worked out from that run, and no sentence is told that does not hold
of it. No Streamlit in here.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from evdash.domain.trace import Trace
from evdash.ui import run as runs
from evdash.ui.cases.doing import Doing
from evdash.ui.run import Run
from evdash.ui.session import bundled, bundled_names

PRESS = "press "
Figures = Mapping[str, Any]
"""Numbers and names by what a sentence calls them."""


@dataclass(frozen=True, slots=True)
class Press:
    """Things to do one after the other, and what to look at then, as Markdown; may be blank."""

    doing: tuple[Doing, ...]
    look: str = ""

    @property
    def told(self) -> str:
        """In a sentence."""
        *first, last = (one.told for one in self.doing)
        if first and first[-1].startswith(PRESS):
            last = last.removeprefix(PRESS)
        told = f"{', '.join(first)} and {last}" if first else last
        full = f"{told[:1].upper()}{told[1:]}{f'; {self.look}' if self.look else ''}"
        return full if full.endswith("?**") else f"{full}."

    def done(self, run: Run) -> Run:
        """The run once all of it is done."""
        for one in self.doing:
            run = one.done(run)
        return run


@dataclass(frozen=True, slots=True)
class Walk:
    """The run as it was opened, and as it was after each press."""

    runs: tuple[Run, ...]

    def after(self, press: int) -> Trace:
        """The day so far after a press, numbered from 1; 0 as it was opened."""
        return self.runs[press].trace


@dataclass(frozen=True, slots=True)
class Claim:
    """A sentence, the figures it is filled with, and what must hold of them for it to be told.

    `told` is Markdown with figures' names in braces, with formats.
    """

    told: str
    figures: Callable[[Walk], Figures]
    holds: Callable[[Figures], bool]

    def sentence(self, walk: Walk) -> str | None:
        """The sentence, filled in; None where it does not hold."""
        figures = self.figures(walk)
        return self.told.format(**figures) if self.holds(figures) else None


@dataclass(frozen=True, slots=True)
class Case:
    """A question, the bundled day it is asked on, what to press, what to see, and why."""

    question: str
    preset: str
    about: str
    press: tuple[Press, ...]
    claims: tuple[Claim, ...]
    why: str

    def walk(self, preset: str = "") -> Walk:
        """All presses done, on the case's own day unless another is named."""
        folder = bundled_names()[preset or self.preset]
        run = runs.open_run(folder, bundled(folder))
        done = [run]
        for press in self.press:
            run = press.done(run)
            done.append(run)
        return Walk(tuple(done))


def seen(case: Case) -> list[str]:
    """What to see, and why, as two paragraphs of Markdown; the day is run for it."""
    walk = case.walk()
    told = [sentence for claim in case.claims if (sentence := claim.sentence(walk))]
    return ["\n".join(f"- {sentence}" for sentence in told), f"**Why?** {case.why}"]
