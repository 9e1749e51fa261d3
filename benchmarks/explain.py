"""Time taken to explain a day's refusals, per vehicle and in all: `python -m benchmarks.explain`.

Times are of the processor, so that what else the machine does counts little.
"""

import time
from collections import Counter
from itertools import pairwise

import numpy as np
from rich.console import Console
from rich.table import Table

from evdash.domain.plan import Plan, Policy, Snapshot
from evdash.domain.trace import Trace
from evdash.explain.refusals import explanations
from evdash.explain.revisions import explain_revision
from evdash.explain.worth import day_worths
from evdash.files.bundled import bundled_scenarios
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import run_day, start_day
from evdash.scheduling.p1 import p1_answers, p1_policy

COLUMNS = ("day", "run, s", "refused", "solves", "median, ms", "worst, ms", "day, s", "worths, s")


def counting(policy: Policy, solves: Counter[str]) -> Policy:
    """The policy, its calls counted."""

    def counted(snapshot: Snapshot) -> Plan:
        solves["made"] += 1
        return policy(snapshot)

    return counted


def seconds_per_vehicle(trace: Trace, solves: Counter[str]) -> list[float]:
    """Processor time of each explanation, s."""
    told = explanations(trace, counting(p1_answers(), solves))
    moments = [time.process_time()] + [time.process_time() for _ in told]
    return [after - before for before, after in pairwise(moments)]


def row_of(trace: Trace, name: str, run_seconds: float) -> list[str]:
    """One line of the table."""
    solves: Counter[str] = Counter()
    each = seconds_per_vehicle(trace, solves) or [0.0]
    began = time.process_time()
    list(day_worths(trace))
    worths = time.process_time() - began
    began = time.process_time()
    for interval in range(1, len(trace.steps)):
        explain_revision(trace, interval)
    revisions = time.process_time() - began
    numbers = (1000 * np.median(each), 1000 * max(each), sum(each), worths, revisions)
    told = ("{:.0f}", "{:.0f}", "{:.2f}", "{:.2f}", "{:.2f}")
    return [
        name,
        f"{run_seconds:.2f}",
        str(len(each)),
        str(solves["made"]),
        *(form.format(number) for form, number in zip(told, numbers, strict=True)),
    ]


def main() -> None:
    """Every bundled day, each once in the linearised model."""
    table = Table(*COLUMNS, "revisions, s", title="Explaining a day")
    for folder in bundled_scenarios():
        began = time.process_time()
        trace = run_day(start_day(read_scenario(folder, ())), p1_policy())
        table.add_row(*row_of(trace, folder.name, time.process_time() - began))
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
