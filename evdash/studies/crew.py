"""Who does the runs: this machine's cores or a cluster, both through joblib."""

import os
import threading
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Any, TypeVar

from joblib import Parallel, delayed, parallel_config
from joblib.externals.loky import process_executor
from joblib.externals.loky.process_executor import TerminatedWorkerError

from evdash.domain.study import Result
from evdash.errors import EvdashError, Fault, InputError
from evdash.studies.work import Task, leave_interrupts, work

DIED = "the process doing this run died"
AHEAD = 2
"""Runs given out beyond those being done, per worker."""
Work = Callable[[Task], Result]
Item = TypeVar("Item")
Answer = TypeVar("Answer")


@dataclass(frozen=True, slots=True)
class Crew:
    """How many processes of this machine, or the address of a Dask scheduler."""

    workers: int = 0
    scheduler: str = ""

    @property
    def size(self) -> int:
        """Processes on this machine; 0 workers means one a core."""
        return self.workers or cores()


def cores() -> int:
    """Cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def results(tasks: Iterable[Task], crew: Crew, do: Work = work) -> Generator[Result, None, None]:
    """Results as they come, in whatever order. Closing the iterator stops the work."""
    if crew.scheduler:
        yield from _on_cluster(tasks, crew.scheduler, do)
    elif crew.size == 1:
        yield from map(do, tasks)
    else:
        yield from _on_cores(tasks, crew.size, do)


def in_order(items: Sequence[Item], do: Callable[[Item], Answer], workers: int) -> Iterator[Answer]:
    """What `do` makes of every item, in their order, by as many processes of this machine."""
    if min(workers, len(items)) < 2:
        yield from map(do, items)
        return
    try:
        yield from _shared(items, do, workers, "generator")
    except TerminatedWorkerError as error:
        raise EvdashError(f"{DIED}: {_on_one_line(error)}") from error


def _on_cores(tasks: Iterable[Task], workers: int, do: Work) -> Iterator[Result]:
    """As `results`; where a process dies, the runs then given out are done one by one."""
    coming = iter(tasks)
    given: dict[str, Task] = {}

    def noted() -> Iterator[Task]:
        for task in coming:
            given[task.key] = task
            yield task

    while True:
        try:
            for result in _parallel(noted(), workers, do):
                del given[result.key]
                yield result
            return
        except TerminatedWorkerError:
            suspects = list(given.values())
            given.clear()
            for task in suspects:
                yield _alone(task, do)


def _parallel(tasks: Iterable[Task], workers: int, do: Work) -> Iterator[Result]:
    return _shared(tasks, do, workers, "generator_unordered")


def _shared(
    items: Iterable[Item], do: Callable[[Item], Answer], workers: int, order: str
) -> Iterator[Answer]:
    crew = Parallel(
        n_jobs=workers,
        backend="loky",
        return_as=order,
        batch_size=1,
        pre_dispatch=(1 + AHEAD) * workers,
        inner_max_num_threads=1,
        initializer=leave_interrupts,
    )
    with _hushed():
        yield from crew(delayed(do)(item) for item in items)


@contextmanager
def _hushed() -> Iterator[None]:
    """Keep to itself what loky's own thread trips over when it is stopped at its work."""
    told = threading.excepthook

    def tell(found: threading.ExceptHookArgs) -> None:
        if type(found.thread).__module__ != process_executor.__name__:
            told(found)

    threading.excepthook = tell
    try:
        yield
    finally:
        threading.excepthook = told


def _alone(task: Task, do: Work) -> Result:
    """One run in a process where no other can suffer with it."""
    try:
        return next(_parallel([task], 2, do))
    except TerminatedWorkerError as error:
        return Result(task.key, "failed", f"{DIED}: {_on_one_line(error)}"[:300], {}, 0.0)


def _on_one_line(error: Exception) -> str:
    return " ".join(f"{error}".split())


def _on_cluster(tasks: Iterable[Task], scheduler: str, do: Work) -> Iterator[Result]:
    client = _client(scheduler)
    with ExitStack() as stack:
        stack.callback(client.close)
        stack.enter_context(parallel_config(backend="dask", client=client))
        width = max(1, sum(client.nthreads().values()))
        crew = Parallel(
            n_jobs=-1,
            return_as="generator_unordered",
            batch_size=1,
            pre_dispatch=(1 + AHEAD) * width,
        )
        yield from crew(delayed(do)(task) for task in tasks)


def _client(scheduler: str) -> Any:
    """A connection to a Dask scheduler that has workers."""
    place = f"--scheduler {scheduler}"
    try:
        from distributed import Client  # noqa: PLC0415 - only who uses a cluster needs it
    except ImportError as error:
        rule = "needs `pip install -r requirements-cluster.txt`"
        raise InputError([Fault(place, "no Dask installed", rule)]) from error
    try:
        client = Client(scheduler, timeout="10s", set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        fault = Fault(place, f"nothing that answers ({error})", "should be a Dask scheduler's")
        raise InputError([fault]) from error
    if not client.nthreads():
        client.close()
        raise EvdashError(f"{scheduler}: the scheduler has no workers; start some and try again")
    return client
