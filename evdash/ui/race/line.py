"""The line that races of this server wait in: nothing runs for them before their turn comes."""

import subprocess
import threading
from collections.abc import Callable

from evdash.domain.quotas import WAITING_RACES

Process = subprocess.Popen[bytes]


class Place:
    """A race's place in the line, and its process once its turn has come."""

    def __init__(self, visitor: str | None, begin: Callable[[], Process]) -> None:
        self.visitor = visitor
        self.begin = begin
        self.process: Process | None = None
        self.failure = ""
        self.left = threading.Event()
        """Whether it is over, or nobody wants it any more."""


class Line:
    """Begins one process after the other, first come first served."""

    def __init__(self) -> None:
        self._waiting: list[Place] = []
        self._turn = threading.Condition()
        self._worker: threading.Thread | None = None

    def join(self, visitor: str | None, begin: Callable[[], Process]) -> Place:
        """A place at the end of the line; raises QuotaReached where it is too long.

        `begin` is called when its turn comes.
        """
        with self._turn:
            WAITING_RACES.check_one(visitor, [place.visitor for place in self._waiting])
            place = Place(visitor, begin)
            self._waiting.append(place)
            if self._worker is None:
                self._worker = threading.Thread(target=self._work, name="races", daemon=True)
                self._worker.start()
            self._turn.notify()
        return place

    def leave(self, place: Place) -> None:
        """Give a place up; its process, if it has one, is ended."""
        with self._turn:
            place.left.set()
            if place in self._waiting:
                self._waiting.remove(place)
            process = place.process
        if process is not None:
            process.terminate()
            process.wait(10)

    def ahead_of(self, place: Place) -> int:
        """How many wait before a place; the race that is on is not among them."""
        with self._turn:
            return self._waiting.index(place) if place in self._waiting else 0

    def _work(self) -> None:
        while True:
            with self._turn:
                self._turn.wait_for(lambda: self._waiting)
                place = self._waiting.pop(0)
                try:
                    place.process = place.begin()
                except OSError as error:
                    place.failure = f"The race could not be begun ({error})."
                    place.left.set()
            if place.process is not None:
                place.process.wait()
                place.left.set()


line = Line()
"""The line of this server."""
