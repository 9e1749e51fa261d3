"""Kills a real server again and again while people step; everybody goes on by their link.

python -m benchmarks.server_cuts [--kills 30] [--users 4] [--think 0.3] [--seed 1]

A server is killed (SIGKILL) at a random instant, another begins on the same store, and everybody
opens their link again. What the page then shows must be what was last shown, or what the click
on its way asked for, and nothing else; in the end every day must be what it is when decided
alone. After every kill the database must be sound. Exit status 0 if nothing was ever lost,
doubled or otherwise, else 3.
"""

import argparse
import asyncio
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table
from websockets.exceptions import ConnectionClosed

from benchmarks.crowd.days import day_of, is_as_decided_alone, kept_in, steps_kept
from benchmarks.crowd.server import serving
from benchmarks.crowd.visitor import Visitor
from benchmarks.power_cuts import soundness

SOON_SECONDS = 10.0
LONGEST_SECONDS = 6.0
"""A server lives at most so long after everybody's page is there."""


@dataclass(slots=True)
class Stepper:
    """One person with a day of their own.

    `shown` counts the steps on the page, `asked` those that it shows after the click on its way.
    """

    number: int
    link: str
    rng: np.random.Generator
    length: int
    shown: int = 0
    asked: int = 0
    counts: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)
    tab: Visitor | None = None

    async def come(self, address: str) -> None:
        """Open the link; it must bring what was shown, or what was asked for."""
        self.tab = Visitor(address)
        await self.tab.open(f"run={self.link}")
        await self._wait_for({self.shown, self.asked})
        self.check("brought", self.tab.steps_shown)
        if self.tab.link != self.link:
            self.faults.append(f"the link {self.link} brought {self.tab.link or 'no run'}")

    async def go(self) -> None:
        """Close the tab, whoever is at the other end."""
        if self.tab is not None:
            await self.tab.close()
            self.faults += self.tab.exceptions
            self.tab = None

    async def step_on(self, think: float) -> None:
        """Step, and begin the day again at its end, for as long as there is a server."""
        if self.tab is None:
            raise RuntimeError("no tab is open")
        while True:
            await asyncio.sleep(think * self.rng.uniform(0.5, 1.5))
            is_over = self.shown == self.length
            self.asked = 0 if is_over else self.shown + 1
            await self.tab.press("reset" if is_over else "step")
            await self._wait_for({self.asked})
            if self.tab.steps_shown != self.asked:
                self.counts["pages not drawn to their end"] += 1
                self.faults.append(f"{self.asked} steps asked for, {self.tab.steps_shown} shown")
            self.shown = self.asked
            self.counts["steps shown"] += 1

    def check(self, what: str, steps: int | None) -> None:
        """Whether there are as many steps as shown, or as asked for; from there it goes on."""
        if steps == self.shown:
            self.counts[f"{what}: what was shown"] += 1
        elif steps == self.asked:
            self.counts[f"{what}: what had been asked for"] += 1
        else:
            self.faults.append(f"{what}: {steps} steps; {self.shown} shown, {self.asked} asked for")
        self.shown = self.asked = steps or 0

    async def _wait_for(self, steps: set[int]) -> None:
        """Until the page shows one of these counts, or some time is over."""
        until = time.monotonic() + SOON_SECONDS
        while (
            self.tab is not None and self.tab.steps_shown not in steps and time.monotonic() < until
        ):
            await asyncio.sleep(0.05)


async def one_life(store: Path, people: list[Stepper], think: float, seconds: float) -> None:
    """A server, everybody stepping on it, and its end after so many seconds of that."""
    with serving(store) as server:
        await asyncio.gather(*(one.come(server.address) for one in people))
        stepping = [asyncio.create_task(one.step_on(think)) for one in people]
        await asyncio.sleep(seconds)
        server.process.kill()
        server.process.wait()
        for task in stepping:
            task.cancel()
        ended = await asyncio.gather(*stepping, return_exceptions=True)
        await asyncio.gather(*(one.go() for one in people))
    for one, end in zip(people, ended, strict=True):
        if not isinstance(end, asyncio.CancelledError | ConnectionClosed):
            one.faults.append(f"{type(end).__name__}: {end}")


async def cut_off(store: Path, kills: int, users: int, think: float, seed: int) -> list[Stepper]:
    """So many servers, each killed while everybody steps."""
    people = [
        Stepper(n, kept_in(store, day), np.random.default_rng([seed, n]), day.intervals)
        for n in range(1, users + 1)
        for day in [day_of(n)]
    ]
    instants = np.random.default_rng(seed).uniform(0, LONGEST_SECONDS, kills)
    for seconds in instants:
        await one_life(store, people, think, float(seconds))
        if (found := soundness(store)) != "ok":
            people[0].faults.append(f"the database is not sound: {found}")
    for one in people:
        one.check("kept", steps_kept(store, one.link))
        if not is_as_decided_alone(store, one.link, day_of(one.number)):
            one.faults.append("the day is not what it is when decided alone")
    return people


def main(arguments: list[str] | None = None) -> int:
    """Kill, look, and tell."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.server_cuts", description=__doc__)
    parser.add_argument("--kills", type=int, default=30, help="how many (30)")
    parser.add_argument("--users", type=int, default=4, help="people at once (4)")
    parser.add_argument("--think", type=float, default=0.3, help="seconds between clicks (0.3)")
    parser.add_argument("--seed", type=int, default=1, help="of the instants (1)")
    chosen = parser.parse_args(arguments)
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as place:
        people = asyncio.run(
            cut_off(Path(place), chosen.kills, chosen.users, chosen.think, chosen.seed)
        )
    table = Table("", "", show_header=False, title=f"{chosen.users} people")
    table.add_row("servers killed", f"{chosen.kills}")
    for what, count in sorted(sum((one.counts for one in people), Counter[str]()).items()):
        table.add_row(what, f"{count:,}")
    table.add_row("lost, doubled or otherwise", f"{sum(len(one.faults) for one in people)}")
    table.add_row("wall time", f"{time.perf_counter() - began:.0f} s")
    console = Console(width=110)
    console.print(table)
    for one in people:
        for fault in one.faults:
            console.print(f"person {one.number}: {fault}", markup=False)
    return 3 if any(one.faults for one in people) else 0


if __name__ == "__main__":
    sys.exit(main())
