"""A study from its first run to its last: only what is missing is done, and told as it lands."""

import os
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from evdash.domain.study import Run, StudyRuns
from evdash.studies.code import code_of
from evdash.studies.crew import Crew, Work, results
from evdash.studies.reading import scenario_at
from evdash.studies.results import Results
from evdash.studies.work import Task, work


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a study is. `earlier` runs were there before this start; `busy_seconds` since it."""

    total: int
    done: int
    failed: int
    earlier: int
    busy_seconds: float

    @property
    def ended(self) -> int:
        return self.done + self.failed

    @property
    def seconds_left(self) -> float | None:
        """Time left at the pace since this start; None before its first run has landed."""
        landed = self.ended - self.earlier
        return self.busy_seconds / landed * (self.total - self.ended) if landed > 0 else None


def run_study(
    runs: StudyRuns,
    kept: Results,
    crew: Crew,
    told: Callable[[Progress], None] = lambda _: None,
    do: Work = work,
) -> Progress:
    """Do every run whose result is not kept yet; each result is kept as it comes.

    Whatever ends this early, an interrupt or a kill, costs only the runs then being done.
    """
    keys = {run.key for run in runs.runs}
    status = kept.status_of(keys)
    failed = sum(each == "failed" for each in status.values())
    now = Progress(len(keys), len(status) - failed, failed, len(status), 0.0)
    told(now)
    began = time.monotonic()
    coming = results(_tasks(runs, set(status)), crew, do)
    with kept.writing() as landing:
        try:
            for result in coming:
                landing.land(result)
                failed += result.status == "failed"
                done = now.done + (result.status == "done")
                now = Progress(now.total, done, failed, now.earlier, time.monotonic() - began)
                told(now)
        finally:
            coming.close()
    return now


def _tasks(runs: StudyRuns, there: set[str]) -> Iterator[Task]:
    """The runs to be done, in order; of two that are the same the first."""
    known = set(there)
    point, scenario = -1, ""
    for run in runs.runs:
        if run.key in known:
            continue
        known.add(run.key)
        if run.point != point:
            point, scenario = run.point, scenario_at(runs, run.point).model_dump_json()
        yield task_of(run, scenario, code_of(run.policy))


def task_of(run: Run, scenario: str, code: str) -> Task:
    """A run as a worker takes it."""
    here = os.getcwd()
    return Task(run.key, scenario, run.seed, run.policy, run.network, run.referee, code, here)
