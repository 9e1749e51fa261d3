"""A thousand days of the bundled scenario as a study: days a second, parallel efficiency, memory.

    python -m benchmarks.studies [--days 1000] [--workers 1 2]

Each line is the command `python -m evdash study` in a process of its own, start included, with AC
by batched power flow and pandapower on one run in fifty. Efficiency is against the first line.
Run it on a machine that does nothing else. Ends with status 3 where the tables of two lines differ.
"""

import argparse
import hashlib
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import psutil
from rich.console import Console
from rich.table import Table

from evdash.studies.folder import DIFFERENCES, RUNS, SUMMARY, StudyFolder
from evdash.studies.reading import read_study

STUDY = """
format = 1
name = "a thousand days"
metrics = ["profit", "acceptance", "lowest_ac_pu", "ac_limits_broken", "referee_error_pu"]
[seeds]
count = {days}
"""
LOOK_SECONDS = 0.5
EARLY = 0.1


@dataclass(frozen=True, slots=True)
class Taken:
    """A study run by so many workers: seconds on the clock and of processors, memory in MB."""

    workers: int
    days: int
    wall_seconds: float
    busy_seconds: float
    early_mb: float
    late_mb: float
    referee_error_pu: float
    tables: str

    @property
    def days_a_second(self) -> float:
        return self.days / self.wall_seconds


def taken(days: int, workers: int, place: Path) -> Taken:
    """Run the study from its command line and watch it."""
    file, folder = place / "study.toml", StudyFolder(place / f"out-{workers}")
    file.write_text(STUDY.format(days=days), encoding="utf-8")
    command = [sys.executable, "-m", "evdash", "study", str(file), "--out", str(folder.path)]
    began = time.perf_counter()
    process = psutil.Popen([*command, "--workers", f"{workers}"], stdout=subprocess.DEVNULL)
    memory: list[float] = []
    while process.poll() is None:
        memory.append(resident_mb(process))
        time.sleep(LOOK_SECONDS)
    wall = time.perf_counter() - began
    if process.returncode != 0:
        raise SystemExit(f"the study ended with status {process.returncode}")
    found = folder.found(read_study(file))
    errors = [found.value(run, "referee_error_pu") for run in found.runs.runs]
    busy = sum(result.seconds for result in found.results.values())
    # the start, and the end when workers are already gone, say nothing of memory at work
    early, late = (memory[int(share * len(memory))] for share in (2 * EARLY, 1 - EARLY))
    worst = max(error for error in errors if error is not None)
    return Taken(workers, days, wall, busy, early, late, worst, digest(folder))


def resident_mb(process: psutil.Popen) -> float:
    """Memory of a process and all its workers, MB."""
    total = 0
    try:
        for one in (process, *process.children(recursive=True)):
            total += one.memory_info().rss
    except psutil.NoSuchProcess:
        pass
    return total / 2**20


def digest(folder: StudyFolder) -> str:
    """What the tables hold, as a digest."""
    tables = (folder.path / name for name in (RUNS, SUMMARY, DIFFERENCES))
    return hashlib.sha256(b"".join(table.read_bytes() for table in tables)).hexdigest()


def main() -> None:
    """Run the study with each number of workers and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--days", type=int, default=1000)
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2])
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        lines = [taken(asked.days, workers, Path(place)) for workers in asked.workers]
    table = Table(box=None, header_style="dim")
    for head in (
        *("workers", "days", "clock, s", "days/s", "days/s per core", "efficiency"),
        *("processor s/day", "MB early", "MB late", "worst pu from pandapower"),
    ):
        table.add_column(head, justify="right")
    first = lines[0]
    for line in lines:
        efficiency = line.days_a_second * first.workers / (first.days_a_second * line.workers)
        table.add_row(
            f"{line.workers}",
            f"{line.days:,}",
            f"{line.wall_seconds:.1f}",
            f"{line.days_a_second:.2f}",
            f"{line.days_a_second / line.workers:.2f}",
            f"{efficiency:.0%}",
            f"{line.busy_seconds / line.days:.3f}",
            f"{line.early_mb:.0f}",
            f"{line.late_mb:.0f}",
            f"{line.referee_error_pu:.1e}",
        )
    console = Console(width=150)
    console.print(table)
    same = len({line.tables for line in lines}) == 1
    console.print("the tables are the same" if same else "[bold red]the tables differ[/]")
    if not same:
        raise SystemExit(3)


if __name__ == "__main__":
    main()
