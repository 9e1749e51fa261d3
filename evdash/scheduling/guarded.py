"""A solver is somebody else's program: it may crash, or never come back. A step may not."""

import threading
from collections.abc import Callable
from typing import TypeVar

from evdash.errors import EvdashError, SolverFailure

T = TypeVar("T")
GRACE_SECONDS = 5.0
"""Solvers are given a time limit of their own; this long after it they are left behind."""


def answered(ask: Callable[[], T], seconds: float) -> T:
    """What `ask` returns. Raises SolverFailure if it crashes or is not back in time.

    It runs in a thread, as nothing else can be left while a library's code does not return;
    such a thread ends with the program.
    """
    answers: list[T] = []
    failures: list[Exception] = []

    def work() -> None:
        try:
            answers.append(ask())
        except Exception as error:  # noqa: BLE001 - whatever a solver raises, the step goes on
            failures.append(error)

    thread = threading.Thread(target=work, name="solver", daemon=True)
    thread.start()
    thread.join(seconds + GRACE_SECONDS)
    if answers:
        return answers[0]
    if not failures:
        raise SolverFailure(f"the solver was not back after {seconds + GRACE_SECONDS:g} s")
    if isinstance(failures[0], EvdashError):
        raise failures[0]
    told = f"the solver crashed: {type(failures[0]).__name__}: {failures[0]}"
    raise SolverFailure(told) from failures[0]
