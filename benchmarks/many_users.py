"""Thirty people at once on a real server, each with a day of their own, none a browser.

python -m benchmarks.many_users [--users 30] [--minutes 3] [--think 5] [--stay 0] [--heavy]

Everybody steps, looks around, clicks twice, reloads and changes pages in mid-step, with `--think`
seconds between two actions. Latency is from the click to the last message of the page it gives;
what a browser then draws is not in it. `--stay MINUTES` has people leave after so long and others
come, so that an hour (`--minutes 60`) shows whether memory is bounded; it is written every minute.
`--heavy` lets one more run a day of 5,000 vehicles to its end and another a study.
Exit status 0 if nobody saw another's data, no step was lost or came twice, no page failed, and
every day is what it is when decided alone; else 3.
"""

import argparse
import asyncio
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.crowd.days import day_of, is_as_decided_alone, kept_in
from benchmarks.crowd.heavy import heavy_users
from benchmarks.crowd.server import Server, serving
from benchmarks.crowd.user import User

SAMPLE_SECONDS = 60.0


@dataclass(slots=True)
class Crowd:
    """Everyone who came, and the server's memory at every minute."""

    users: list[User] = field(default_factory=list)
    memory_mb: list[float] = field(default_factory=list)
    cpu_seconds: float = 0.0


async def visit(user: User, server: Server, think: float, until: float) -> None:
    """One person's stay."""
    await asyncio.sleep(user.rng.uniform(0, think))
    try:
        await user.come(server.address)
        while time.monotonic() < until:
            await asyncio.sleep(user.rng.uniform(0.5, 1.5) * think)
            await user.act()
    except TimeoutError:
        user.faults.append("waited in vain")
    finally:
        await user.go()


async def seat(
    place: int, crowd: Crowd, server: Server, chosen: argparse.Namespace, end: float
) -> None:
    """One seat in the room: somebody sits there, and after a while somebody else."""
    turn = 0
    while time.monotonic() < end:
        number = place + turn * chosen.users
        link = kept_in(server.store, day_of(number))
        user = User(number, link, np.random.default_rng([chosen.seed, number]), server.store)
        crowd.users.append(user)
        stay = 60 * chosen.stay * user.rng.uniform(0.5, 1.5) if chosen.stay else end
        await visit(user, server, chosen.think, min(end, time.monotonic() + stay))
        user.kept()
        turn += 1


async def watch(crowd: Crowd, server: Server, end: float, console: Console) -> None:
    """Memory at the start and after every minute."""
    began = time.monotonic()
    while True:
        crowd.memory_mb.append(server.memory_mb)
        minute = round((time.monotonic() - began) / 60)
        steps = sum(user.done.total() for user in crowd.users)
        console.print(f"minute {minute}: {crowd.memory_mb[-1]:.0f} MB, {steps:,} actions")
        if time.monotonic() >= end:
            return
        await asyncio.sleep(min(SAMPLE_SECONDS, max(0.1, end - time.monotonic())))


async def all_at_once(server: Server, chosen: argparse.Namespace, console: Console) -> Crowd:
    """Everybody, until time is up."""
    crowd = Crowd()
    end = time.monotonic() + 60 * chosen.minutes
    before = server.cpu_seconds
    heavy = heavy_users(server, end) if chosen.heavy else ()
    await asyncio.gather(
        watch(crowd, server, end, console),
        *(seat(n, crowd, server, chosen, end) for n in range(1, chosen.users + 1)),
        *heavy,
    )
    crowd.cpu_seconds = server.cpu_seconds - before
    return crowd


def latencies(crowd: Crowd) -> Table:
    """How long people waited, by what they did."""
    table = Table("", "times", "p50, s", "p95, s", "worst, s", title="Waiting")
    kinds = dict.fromkeys(kind for user in crowd.users for kind in user.seconds)
    for kind in kinds:
        waits = [wait for user in crowd.users for wait in user.seconds.get(kind, [])]
        p50, p95 = np.percentile(waits, [50, 95])
        table.add_row(kind, f"{len(waits):,}", f"{p50:.2f}", f"{p95:.2f}", f"{max(waits):.2f}")
    return table


def facts(crowd: Crowd, differing: Sequence[int]) -> Table:
    """What else came of it."""
    table = Table("", "", show_header=False, title="Everybody")
    done = sum((user.done for user in crowd.users), Counter[str]())
    table.add_row("people", f"{len(crowd.users)}")
    table.add_row("actions", ", ".join(f"{what} {n:,}" for what, n in done.most_common()))
    table.add_row("pages, steps or data wrong", f"{sum(len(user.faults) for user in crowd.users)}")
    table.add_row("days other than when decided alone", f"{len(differing)}")
    memory = crowd.memory_mb
    table.add_row(
        "memory, MB", f"{memory[0]:.0f} first, {max(memory):.0f} most, {memory[-1]:.0f} last"
    )
    table.add_row("processor seconds", f"{crowd.cpu_seconds:.0f}")
    return table


def main(arguments: list[str] | None = None) -> int:
    """Serve everybody, print the tables, tell everything that went wrong."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.many_users", description=__doc__)
    parser.add_argument("--users", type=int, default=30, help="how many at a time (30)")
    parser.add_argument("--minutes", type=float, default=3, help="for how long (3)")
    parser.add_argument("--think", type=float, default=5, help="seconds between actions (5)")
    parser.add_argument("--stay", type=float, default=0, help="minutes after which people leave")
    parser.add_argument("--seed", type=int, default=1, help="of everybody's habits (1)")
    parser.add_argument("--heavy", action="store_true", help="two more who ask for a lot")
    chosen = parser.parse_args(arguments)
    console = Console(width=110)
    with tempfile.TemporaryDirectory() as place, serving(Path(place)) as server:
        crowd = asyncio.run(all_at_once(server, chosen, console))
        differing = [
            user.number
            for user in crowd.users
            if not is_as_decided_alone(Path(place), user.link, day_of(user.number))
        ]
    console.print(latencies(crowd), facts(crowd, differing))
    for user in crowd.users:
        for fault in user.faults:
            console.print(f"user {user.number}: {fault}", markup=False)
    for number in differing:
        console.print(f"user {number}: the day is not what it is when decided alone")
    return 3 if differing or any(user.faults for user in crowd.users) else 0


if __name__ == "__main__":
    sys.exit(main())
