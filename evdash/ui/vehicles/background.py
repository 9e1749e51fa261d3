"""Explanations worked out in the background: solving again takes from moments to seconds.

One worker for the whole server, so that explaining never keeps anybody's step waiting for
both of the optimiser's turns. What was told is kept, bounded. No Streamlit in here.
"""

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from concurrent.futures import Future, ThreadPoolExecutor

from evdash.domain.trace import Trace

MOST_KEPT = 200
Told = list[str]


class Teller:
    """Tells what takes solving: at once if it is known, else later, without anyone waiting."""

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(max_workers=1, thread_name_prefix="explain")
        self._kept: OrderedDict[Hashable, tuple[object, Future[Told]]] = OrderedDict()
        self._lock = threading.Lock()

    def told(self, about: object, what: Hashable, tell: Callable[[], Told]) -> Told | None:
        """What `tell` says of `what` in `about`, or None while that is being found out.

        `about` is told apart by identity, and kept as long as what was said of it.
        """
        key = (id(about), what)
        with self._lock:
            if key not in self._kept:
                self._kept[key] = (about, self._pool.submit(tell))
                while len(self._kept) > MOST_KEPT:
                    _, (_, dropped) = self._kept.popitem(last=False)
                    dropped.cancel()
            self._kept.move_to_end(key)
            future = self._kept[key][1]
        return future.result() if future.done() else None


def refused_in(trace: Trace, vehicle: str) -> object:
    """What a refusal depends on: the step that decided it, or the whole day if it came too late."""
    for step in trace.steps:
        if any(refusal.vehicle == vehicle for refusal in step.plan.refused):
            return step
    return trace


teller = Teller()
"""The teller of this server."""
