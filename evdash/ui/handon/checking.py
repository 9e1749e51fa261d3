"""A finished day's AC check in the background: one at a time on this server, told and cancelled.

No Streamlit in here.
"""

import threading
from concurrent.futures import ThreadPoolExecutor

from evdash.domain.trace import Trace
from evdash.errors import EvdashError
from evdash.files.run_export import Verdict
from evdash.reports.account import flows_needed, verdict_on

WORKER = ThreadPoolExecutor(max_workers=1, thread_name_prefix="handon")
"""Whoever else wants a day handed on waits here; stepping a day never does."""


class Cancelled(Exception):
    """Nobody wants it any more."""


class Checking:
    """The check of one trace: waiting, under way, done, failed, or cancelled."""

    def __init__(self, trace: Trace) -> None:
        self.trace = trace
        self.total = flows_needed(trace)
        self.done = 0
        self.verdict: Verdict | None = None
        self.failure = ""
        self._unwanted = threading.Event()
        self._future = WORKER.submit(self._work)

    @property
    def is_waiting(self) -> bool:
        """Whether somebody else's comes first."""
        return self.done == 0 and not self._future.running() and not self._future.done()

    @property
    def is_over(self) -> bool:
        return self._future.done()

    def cancel(self) -> None:
        """Stop it between two power flows."""
        self._unwanted.set()
        self._future.cancel()

    def _work(self) -> None:
        try:
            self.verdict = verdict_on(self.trace, self._count)
        except Cancelled:
            self.failure = "Cancelled."
        except EvdashError as error:
            self.failure = str(error)

    def _count(self) -> None:
        if self._unwanted.is_set():
            raise Cancelled
        self.done += 1
