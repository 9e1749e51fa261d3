"""What one person does: steps, looks around, clicks twice, reloads and leaves in mid-step."""

import asyncio
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from benchmarks.crowd.days import MARK, steps_kept
from benchmarks.crowd.visitor import Visitor

SOON_SECONDS = 5.0
HASTE_SECONDS = 0.12
"""Between two clicks of a person in a hurry."""
OTHER_PAGES = ("vehicles", "feeder", "compare", "model")
HABITS = {
    "step": 0.62,
    "look around": 0.14,
    "double click": 0.08,
    "leave in mid-step": 0.06,
    "reload in mid-step": 0.06,
    "back": 0.04,
}


@dataclass(slots=True)
class User:
    """A person with a day of their own. `steps` counts what was clicked less what was undone."""

    number: int
    link: str
    rng: np.random.Generator
    store: Path
    steps: int = 0
    length: int = 24
    seconds: dict[str, list[float]] = field(default_factory=dict)
    done: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)
    tab: Visitor | None = None

    @property
    def visitor(self) -> Visitor:
        """The tab that is open."""
        if self.tab is None:
            raise RuntimeError("no tab is open")
        return self.tab

    async def come(self, address: str) -> None:
        """Open the day by its link."""
        self.tab = Visitor(address, on_message=self._look)
        began = time.perf_counter()
        await self.tab.open(f"run={self.link}")
        self._took("open", time.perf_counter() - began)
        await self._hold("coming")

    async def go(self) -> None:
        """Close the tab."""
        if self.tab is not None:
            await self.tab.close()
            self.faults += self.tab.exceptions
            self.tab = None

    async def act(self) -> None:
        """One thing a person does, and whether the page then shows what it should."""
        visitor = self.visitor
        habit = str(self.rng.choice(list(HABITS), p=list(HABITS.values())))
        if self.steps >= self.length:
            self._took("reset", await visitor.press("reset"))
            self.steps, habit = 0, "reset"
        elif habit == "back" and self.steps:
            self._took("back", await visitor.press("back"))
            self.steps -= 1
        elif habit == "look around":
            self._took("page", await visitor.turn_to(str(self.rng.choice(OTHER_PAGES))))
            await asyncio.sleep(self.rng.uniform(0.5, 1.5))
            self._took("page", await visitor.turn_to("live"))
        elif habit == "double click":
            await self._double_click(visitor)
        elif habit == "leave in mid-step":
            await visitor.press("step", wait=False)
            await asyncio.sleep(HASTE_SECONDS)
            self._took("page", await visitor.turn_to("vehicles"))
            self._took("page", await visitor.turn_to("live"))
            self.steps += 1
        elif habit == "reload in mid-step":
            await self._reload(visitor)
        else:
            habit = "step"
            self._took("step", await visitor.press("step"))
            self.steps += 1
        self.done[habit] += 1
        await self._hold(habit)

    async def _double_click(self, visitor: Visitor) -> None:
        """Two clicks as quick as fingers are."""
        twice = self.steps + 2 <= self.length
        await visitor.press("step", wait=False)
        await asyncio.sleep(HASTE_SECONDS)
        if twice:
            await visitor.press("step", wait=False)
        await visitor.settled()
        await asyncio.sleep(0.3)
        await visitor.settled()
        self.steps += 1 + twice

    async def _reload(self, visitor: Visitor) -> None:
        """Close the tab while a step is being decided and open its address again."""
        await visitor.press("step", wait=False)
        await asyncio.sleep(HASTE_SECONDS)
        await visitor.close()
        self.faults += visitor.exceptions
        self.steps += 1
        await self.come(visitor.address)

    async def _hold(self, what: str) -> None:
        """What is shown against what was done; what is not so is told, and then taken over."""
        until = time.monotonic() + SOON_SECONDS
        while (shown := self.visitor.steps_shown) != self.steps and time.monotonic() < until:
            await asyncio.sleep(0.1)
            await self.visitor.settled()
        if shown != self.steps:
            self.faults.append(f"{what}: {self.steps} steps done, {shown} shown")
            self.steps = shown or 0
        if self.visitor.link and self.visitor.link != self.link:
            self.faults.append(f"{what}: goes on as a copy")
            self.link = self.visitor.link

    def kept(self) -> None:
        """Whether the store has what was done."""
        kept = steps_kept(self.store, self.link)
        if kept != self.steps:
            self.faults.append(f"{self.steps} steps done, {kept} kept")

    def _look(self, data: bytes) -> None:
        """Anybody else's mark in what this person receives."""
        others = {mark for mark in MARK.findall(data) if int(mark) != self.number}
        if others:
            self.faults.append(f"saw data of {', '.join(sorted(m.decode() for m in others))}")

    def _took(self, what: str, seconds: float) -> None:
        self.seconds.setdefault(what, []).append(seconds)
