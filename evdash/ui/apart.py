"""Parts of a page that run by themselves, and clicks that count once although such parts exist.

A part that looks again by itself may be due while the page is being drawn. Two things then go
wrong in Streamlit 1.67 on a busy machine, and both are kept out here:

- What the page's run said of the part is withdrawn, since the part's own run will say it anew. If
  nothing of the page has been sent yet, everything below the part moves up by one place, and a
  later word to its old place empties the whole page. A container of its own holds the place.
- A click is sent twice: by the part's timer, which tells the state of all widgets, and by itself.
"""

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec

import streamlit as st
from streamlit.runtime.scriptrunner import get_script_run_ctx

P = ParamSpec("P")


def apart(
    draw: Callable[P, None], every_seconds: float | None = None, key: str | None = None
) -> Callable[P, None]:
    """`draw` as a part of the page that runs by itself, also every so many seconds."""

    def placed(*args: P.args, **kwargs: P.kwargs) -> None:
        with st.container():
            st.fragment(draw, run_every=every_seconds, key=key)(*args, **kwargs)

    return placed


def one_click(act: Callable[P, object]) -> Callable[P, None]:
    """`act` as what a widget outside all such parts does when clicked.

    A click that comes with the run of a part is followed by one of its own.
    """

    @wraps(act)
    def clicked(*args: P.args, **kwargs: P.kwargs) -> None:
        run = get_script_run_ctx()
        if run is None or not run.fragment_ids_this_run:
            act(*args, **kwargs)

    return clicked
