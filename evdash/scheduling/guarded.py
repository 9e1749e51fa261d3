"""A solver is somebody else's program: it may crash, or never come back. A step may not.

What a solver may try is limited by its work (`effort.py`). Only one that overlooks that limit is
ended from here, and no machine is too slow or too busy for one that does not: counted are the
solver's own seconds of the processor, and those in which it took none.
"""

import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import TypeVar

from evdash.errors import EvdashError, SolverFailure
from evdash.scheduling.effort import Effort

T = TypeVar("T")
PROCESSOR_SECONDS = 300.0
"""What a solver's thread may take of a processor: many times what any limit of work comes to."""
IDLE_SECONDS = 120.0
"""How long it may take nothing of a processor, as if it waited for something that never comes."""
LOOK_SECONDS = 0.5
"""How often that is looked at. Looks are counted, not the clock: a program that is stopped and
goes on later has not looked in between."""


def answered(ask: Callable[[], T], effort: Effort) -> T:
    """What `ask` returns. Raises SolverFailure if it crashes or does not come back.

    It runs in a thread, as nothing else can be left while a library's code does not return;
    such a thread ends with the program, and `effort` is used up.
    """
    answers: list[T] = []
    failures: list[Exception] = []
    clock = _Clock()

    def work() -> None:
        clock.starts()
        try:
            answers.append(ask())
        except Exception as error:  # noqa: BLE001 - whatever a solver raises, the step goes on
            failures.append(error)

    thread = threading.Thread(target=work, name="solver", daemon=True)
    thread.start()
    why = _waited_for(thread, clock)
    if answers:
        return answers[0]
    if not failures:
        effort.leave_behind()
        raise SolverFailure(f"the solver did not come back and was left behind after {why}")
    if isinstance(failures[0], EvdashError):
        raise failures[0]
    told = f"the solver crashed: {type(failures[0]).__name__}: {failures[0]}"
    raise SolverFailure(told) from failures[0]


class _Clock:
    """Seconds of the processor that a thread has taken since it called `starts`.

    Those of the whole program where the system does not tell threads apart.
    """

    def __init__(self) -> None:
        self._thread: int | None = None
        self._before, self._taken = time.process_time(), 0.0

    def starts(self) -> None:
        with suppress(AttributeError):  # no such clock on this system
            self._thread = time.pthread_getcpuclockid(threading.get_ident())

    def taken(self) -> float:
        if self._thread is None:
            return time.process_time() - self._before
        with suppress(OSError):  # the thread has just ended
            self._taken = time.clock_gettime(self._thread)
        return self._taken


def _waited_for(thread: threading.Thread, clock: _Clock) -> str:
    """Wait for a solver's thread; empty once it has ended, else why it is waited for no longer."""
    taken, idle = 0.0, 0.0
    while True:
        thread.join(LOOK_SECONDS)
        if not thread.is_alive():
            return ""
        before, taken = taken, clock.taken()
        idle = idle + LOOK_SECONDS if taken <= before else 0.0
        if taken >= PROCESSOR_SECONDS:
            return f"{PROCESSOR_SECONDS:g} s of the processor"
        if idle >= IDLE_SECONDS:
            return f"{IDLE_SECONDS:g} s in which it did nothing"
