"""Feeds the program bad input, structure-aware and by the tens of thousands; nothing may break.

python -m benchmarks.fuzz [--inputs 20000] [--seed 1] [--kind NAME …] [--only NUMBER]

Every input must end in a refusal that names place, finding and rule, or in a right run that the
independent checker and the audit pass: no other error, no hang, no more memory than allowed.
Exit status 0 if so, else 3, with kind and number of every input that did not; `--kind NAME
--only NUMBER` tries a single one again in this process, to be looked at.
"""

import argparse
import sys
import time
from collections import Counter
from collections.abc import Sequence

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.progress import track
from rich.table import Table

from benchmarks.fuzzing.kinds import KINDS, answered, made
from benchmarks.fuzzing.trial import ALLOWED
from benchmarks.fuzzing.watched import MEMORY_MB, Job, Tried, tried_all


def jobs_for(inputs: int, names: Sequence[str]) -> list[Job]:
    """So many inputs, shared among the kinds."""
    whole = sum(KINDS[name].share for name in names)
    return [
        (name, number)
        for name in names
        for number in range(max(1, round(inputs * KINDS[name].share / whole)))
    ]


def table_of(tried: Sequence[Tried], seconds: float) -> Table:
    """Outcomes by kind of input."""
    table = Table(title=f"{len(tried):,} inputs in {seconds:.0f} s")
    columns = ("input", "tried", *ALLOWED, "anything else", "CPU s, median", "worst", "peak MB")
    for column in columns:
        table.add_column(column, justify="left" if column == "input" else "right")
    for name in dict.fromkeys(one.name for one in tried):
        mine = [one for one in tried if one.name == name]
        kinds = Counter(one.outcome.kind for one in mine)
        cpu = [one.cpu_seconds for one in mine]
        table.add_row(
            name,
            f"{len(mine):,}",
            *(f"{kinds[kind]:,}" for kind in ALLOWED),
            f"{sum(bool(one.outcome.problem) for one in mine):,}",
            f"{np.median(cpu):.3f}",
            f"{max(cpu):.2f}",
            f"{max(one.peak_mb for one in mine):,.0f}",
        )
    return table


def main(arguments: list[str] | None = None) -> int:
    """Try all inputs, print the table, name every one that broke something."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fuzz", description=__doc__)
    parser.add_argument("--inputs", type=int, default=20_000, help="how many (20000)")
    parser.add_argument("--seed", type=int, default=1, help="which (1)")
    parser.add_argument("--kind", action="append", choices=list(KINDS), help="only this kind")
    parser.add_argument("--only", type=int, help="only this number, tried in this process")
    chosen = parser.parse_args(arguments)
    names = chosen.kind or list(KINDS)
    console = Console(width=120)
    if chosen.only is not None:
        for name in names:
            console.print(made(name, chosen.seed, chosen.only), markup=False)
            console.print(f"{answered(name, chosen.seed, chosen.only)}", markup=False)
        return 0
    began = time.perf_counter()
    jobs = jobs_for(chosen.inputs, names)
    progress = track(
        tried_all(jobs, chosen.seed), "inputs", len(jobs), console=Console(stderr=True)
    )
    tried = list(progress)
    console.print(table_of(tried, time.perf_counter() - began))
    console.print(f"A process may take {MEMORY_MB:,} MB, the program included.")
    broken = [one for one in tried if one.outcome.problem]
    for one in broken:
        console.print(f"{one.name} {one.number}: {escape(one.outcome.problem)}")
    return 3 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
