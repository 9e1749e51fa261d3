"""Kills a program in the midst of keeping a run, again and again; what was kept must be there.

python -m benchmarks.power_cuts [--kills 300] [--seed 1] [--writers 2]

A process steps a day, keeps it after every step and says so; at a random instant it is killed
(SIGKILL, as no power cut can be had). Then the store is opened again: the link must bring back
at least the last step that was said to be kept and at most the one that was on its way, equal to
the bit to what the same day gives without a kill, and the database must be sound. The next
process goes on from there. With two writers at once both keep runs of their own in one store.
Exit status 0 if nothing was ever lost, else 3.
"""

import argparse
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.soundness import without_times
from evdash.domain.trace import Trace
from evdash.errors import StoreUnavailable
from evdash.files.bundled import DEFAULT
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import run_day, start_day
from evdash.metrics.key_figures import until
from evdash.scheduling.p1 import p1_policy
from evdash.store.database import NAME
from evdash.store.journal import Journal
from evdash.store.parts import Kept
from evdash.store.runs import Store

ROOT = Path(__file__).parents[1]
BESIDE = "beside"
PAUSE_SECONDS = 0.005
"""Between two steps, so that the other writer gets its turn."""
LONGEST_SECONDS = 0.4
"""A writer lives at most so long after its first word."""


def write_on(directory: Path, link: str) -> None:
    """Keep the run of a link, or a new one, step by step, telling every one; never ends.

    The steps come from the day beside the store, so that all the time goes into keeping.
    """
    store = Store(directory)
    found = Journal.resume(store, link) if link else None
    days = day_beside(directory)
    journal, done = (found[0], len(found[1].trace.steps)) if found else (Journal(store), 0)
    while True:
        done = (done + 1) % len(days)
        try:
            journal.keep(Kept("", days[0].scenario, days[done]))
        except StoreUnavailable:  # told in the app, where the next change is kept again
            done -= 1
            continue
        print(journal.link, done, flush=True)
        time.sleep(PAUSE_SECONDS)


def put_beside(directory: Path) -> None:
    """The bundled day, run to its end and kept in a store of its own."""
    trace = run_day(start_day(read_scenario(DEFAULT)), p1_policy())
    journal = Journal(Store(directory / BESIDE))
    journal.keep(Kept("", trace.scenario, trace))
    (directory / BESIDE / "link").write_text(journal.link, encoding="ascii")
    journal.store.database.close()


def day_beside(directory: Path) -> list[Trace]:
    """That day after 0, 1, 2 … steps."""
    store = Store(directory / BESIDE)
    found = store.read((directory / BESIDE / "link").read_text(encoding="ascii"))
    store.database.close()
    if found is None:
        raise RuntimeError("the day beside the store is gone")
    trace = found[1].trace
    return [until(trace, count) for count in range(len(trace.steps) + 1)]


@dataclass(slots=True)
class Writer:
    """One process after another keeping the same run."""

    directory: Path
    days: list[Trace]
    rng: np.random.Generator
    link: str = ""
    told: int = 0
    counts: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)
    process: subprocess.Popen[str] | None = None

    def start(self) -> None:
        """Start a process that goes on with the run."""
        command = [sys.executable, "-m", "benchmarks.power_cuts", "--write", str(self.directory)]
        self.process = subprocess.Popen(
            [*command, f"--link={self.link}"],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            text=True,
        )

    def kill(self) -> None:
        """Kill it at a random instant, and hear what it said last."""
        process = self.process
        if process is None or process.stdout is None:
            raise RuntimeError("there is nothing to kill")
        first = process.stdout.readline()
        time.sleep(float(self.rng.uniform(0, LONGEST_SECONDS)))
        process.kill()
        said = [first, *process.stdout]
        process.wait()
        whole = [line for line in said if line.endswith("\n")]
        if not whole:
            self.counts["did not get to its first word"] += 1
            return
        self.link, told = whole[-1].split()
        self.told = int(told)
        self.counts["steps kept"] += len(whole)

    def check(self) -> None:
        """Whether the store has what was said to be kept."""
        if not self.link:
            return
        store = Store(self.directory)
        found = Journal.resume(store, self.link)
        store.database.close()
        if found is None:
            self.faults.append(f"{self.link}: the run is gone")
            return
        steps = len(found[1].trace.steps)
        following = (self.told + 1) % len(self.days)
        if steps == self.told:
            self.counts["ended with the last step told"] += 1
        elif steps == following:
            self.counts["ended with the one being told"] += 1
        else:
            self.faults.append(f"{self.link}: told {self.told} steps, kept {steps}")
        if without_times(found[1].trace) != without_times(self.days[steps]):
            self.faults.append(f"{self.link}: the day is another than without a kill")


def soundness(directory: Path) -> str:
    """SQLite's own opinion of the file."""
    connection = sqlite3.connect(directory / NAME)
    found = connection.execute("PRAGMA integrity_check").fetchone()[0]
    orphans = connection.execute("PRAGMA foreign_key_check").fetchall()
    connection.close()
    return str(found) if not orphans else f"{len(orphans)} rows refer to nothing"


def cut_power(directory: Path, kills: int, seed: int, writers: int) -> list[Writer]:
    """So many kills of so many writers at once in one store."""
    put_beside(directory)
    days = day_beside(directory)
    all_of_them = [
        Writer(directory, days, np.random.default_rng([seed, n])) for n in range(writers)
    ]
    for _ in track(range(kills), "kills", console=Console(stderr=True)):
        for writer in all_of_them:
            writer.start()
        for writer in all_of_them:
            writer.kill()
        for writer in all_of_them:
            writer.check()
        if (found := soundness(directory)) != "ok":
            all_of_them[0].faults.append(f"the database is not sound: {found}")
    return all_of_them


def main(arguments: list[str] | None = None) -> int:
    """Kill, look, and tell."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.power_cuts", description=__doc__)
    parser.add_argument("--kills", type=int, default=300, help="how many (300)")
    parser.add_argument("--seed", type=int, default=1, help="of the instants (1)")
    parser.add_argument("--writers", type=int, default=2, help="processes at once (2)")
    parser.add_argument("--write", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--link", default="", help=argparse.SUPPRESS)
    chosen = parser.parse_args(arguments)
    if chosen.write is not None:
        write_on(chosen.write, chosen.link)
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as place:
        writers = cut_power(Path(place), chosen.kills, chosen.seed, chosen.writers)
        size = (Path(place) / NAME).stat().st_size
    counts = sum((writer.counts for writer in writers), Counter[str]())
    faults = [fault for writer in writers for fault in writer.faults]
    table = Table("", "", show_header=False, title=f"{chosen.writers} writers on one store")
    table.add_row("kills", f"{chosen.kills * chosen.writers:,}")
    for what, count in sorted(counts.items()):
        table.add_row(what, f"{count:,}")
    table.add_row("runs, steps or bits lost", f"{len(faults)}")
    table.add_row("file at the end", f"{size / 1e6:.1f} MB")
    table.add_row("wall time", f"{time.perf_counter() - began:.0f} s")
    console = Console(width=110)
    console.print(table)
    for fault in faults:
        console.print(fault, markup=False)
    return 3 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
