"""Downloads of what a page shows, also right after something was typed into it.

A click on a download asks for the file at once, beside the script run that takes in what was typed
just before it. The file is made only when the page is at rest again.
"""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

T = TypeVar("T")
GRACE_SECONDS = 0.25
"""Until a script run that has been asked for has surely begun."""
MOST_SECONDS = 30.0


class Rest:
    """Whether a tab's page is at rest, which is when no script run is drawing it."""

    def __init__(self) -> None:
        self._is_drawn = threading.Event()
        self._is_drawn.set()

    @contextmanager
    def broken(self) -> Iterator[None]:
        """While the page, or within that a part of it, is being drawn."""
        is_outermost = self._is_drawn.is_set()
        self._is_drawn.clear()
        try:
            yield
        finally:
            if is_outermost:
                self._is_drawn.set()

    def then(self, make: Callable[[], T]) -> Callable[[], T]:
        """`make` for a download: called once the page is at rest; nothing if it never is."""

        def made() -> T:
            until = time.monotonic() + MOST_SECONDS
            while time.monotonic() < until:
                time.sleep(GRACE_SECONDS)
                if self._is_drawn.is_set():
                    return make()
            raise TimeoutError("the page is still being drawn")

        return made
