"""A worker that is watched: an input that takes too long, too much memory, or the whole process
down with it is an outcome like any other, and the next input gets a new worker."""

import gc
import multiprocessing
import resource
import time
from collections.abc import Iterator
from dataclasses import dataclass
from multiprocessing.connection import Connection

from benchmarks.fuzzing.kinds import answered
from benchmarks.fuzzing.trial import WRONG, Outcome

ADDRESS_BYTES = 6 * 2**30
"""Address space an input may ask for beyond the program's own; more is an error at once."""
MEMORY_MB = 1024
"""What the process may really take, the program itself included."""
WALL_SECONDS = 240.0
"""The time after which an input is taken for one that hangs; a shared machine may be slow."""
RECYCLED_AFTER = 2_000
Job = tuple[str, int]


@dataclass(frozen=True, slots=True)
class Tried:
    """An input (kind and number), its outcome, its CPU seconds and the worker's peak memory."""

    name: str
    number: int
    outcome: Outcome
    cpu_seconds: float = 0.0
    peak_mb: float = 0.0


def tried_all(jobs: list[Job], seed: int) -> Iterator[Tried]:
    """Every input's outcome, one after the other."""
    context = multiprocessing.get_context("forkserver")
    at = 0
    while at < len(jobs):
        ours, theirs = context.Pipe()
        batch = jobs[at : at + RECYCLED_AFTER]
        worker = context.Process(target=_work, args=(theirs, batch, seed), daemon=True)
        worker.start()
        theirs.close()
        try:
            for name, number in batch:
                told = _next(ours)
                at += 1
                if isinstance(told, str):
                    yield Tried(name, number, Outcome(WRONG, told))
                    break
                yield told
                if told.peak_mb > MEMORY_MB:
                    break
        finally:
            worker.kill()
            worker.join()


def _next(ours: Connection) -> "Tried | str":
    """The next outcome, or in words why there is none."""
    if not ours.poll(WALL_SECONDS):
        return f"no answer within {WALL_SECONDS:g} s"
    try:
        told: Tried = ours.recv()
    except EOFError:
        return "the process died"
    return told


def _work(theirs: Connection, batch: list[Job], seed: int) -> None:
    with open("/proc/self/statm", encoding="ascii") as file:
        taken = int(file.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (taken + ADDRESS_BYTES, taken + ADDRESS_BYTES))
    for name, number in batch:
        began = time.process_time()
        try:
            outcome = answered(name, seed, number)
        except BaseException as error:  # noqa: BLE001 - whatever is not allowed is told
            outcome = Outcome(WRONG, f"{type(error).__name__}: {str(error)[:300]}")
            del error
            gc.collect()
        peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        if peak_mb > MEMORY_MB:
            outcome = Outcome(WRONG, f"the process took {peak_mb:.0f} MB")
        theirs.send(Tried(name, number, outcome, time.process_time() - began, peak_mb))
        if peak_mb > MEMORY_MB:
            return  # the peak would be held against all that follow
