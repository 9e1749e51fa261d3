"""Explanations worked out in the background: solving again takes from moments to seconds.

One worker for the whole server, so that explaining never keeps anybody's step waiting for
both of the optimiser's turns. What was told is kept, bounded.
"""

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from concurrent.futures import Future, ThreadPoolExecutor, wait

import streamlit as st

from evdash.domain.trace import Trace
from evdash.ui.apart import apart

MOST_KEPT = 200
POLL_SECONDS = 0.4
AT_ONCE_SECONDS = 0.05
"""What is told so soon is told without a word of waiting."""
Told = list[str]


class Teller:
    """Tells what takes solving: at once if it is known, else later, without anyone waiting."""

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(max_workers=1, thread_name_prefix="explain")
        self._kept: OrderedDict[Hashable, tuple[object, Future[Told]]] = OrderedDict()
        self._lock = threading.Lock()

    def told(
        self,
        about: object,
        what: Hashable,
        tell: Callable[[], Told],
        patience_seconds: float = 0.0,
    ) -> Told | None:
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
        wait([future], patience_seconds)
        return future.result() if future.done() else None


def refused_in(trace: Trace, vehicle: str) -> object:
    """What a refusal depends on: the step that decided it, or the whole day if it came too late."""
    for step in trace.steps:
        if any(refusal.vehicle == vehicle for refusal in step.plan.refused):
            return step
    return trace


teller = Teller()
"""The teller of this server."""


def told_later(name: str, about: object, what: Hashable, tell: Callable[[], Told]) -> None:
    """Paragraphs that take solving; until they are known, the page goes on without them."""
    known = teller.told(about, what, tell, AT_ONCE_SECONDS) is not None
    apart(_told, None if known else POLL_SECONDS, key=name)(
        name, about, what, tell, awaited=not known
    )


def _told(
    name: str, about: object, what: Hashable, tell: Callable[[], Told], *, awaited: bool
) -> None:
    with st.container(key=name):
        told = teller.told(about, what, tell)
        if told is None:
            st.markdown(":material/hourglass_top: Being found out by solving again …")
            return
        for line in told:
            st.markdown(line)
    if awaited:
        st.rerun()


def told_below(name: str, label: str, trace: Trace, tell: Callable[[Trace], Told]) -> None:
    """What `tell` says of a trace, worked out only when opened, once for each trace."""
    box = st.expander(label, key=f"told_{name}", type="compact", on_change="rerun")
    if box.open:
        with box:
            told_later(f"told_{name}_lines", trace, name, lambda: tell(trace))
