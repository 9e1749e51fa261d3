"""Parts of a page that run by themselves, and clicks that count once although such parts exist.

A part that looks again by itself may be due while the page is being drawn. Two things then go
wrong in Streamlit 1.67 on a busy machine, and both are kept out here:

- What the page's run said of the part is withdrawn, since the part's own run will say it anew. If
  nothing of the page has been sent yet, everything below the part moves up by one place, and a
  later word to its old place empties the whole page. A container of its own holds the place.
- A click is sent twice: by the part's timer, which tells the state of all widgets, and by itself.

And a click right after something was typed comes together with it: what was typed counts first.
"""

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec

import streamlit as st
from streamlit.runtime.scriptrunner import get_script_run_ctx

P = ParamSpec("P")
TAKE = "evdash:take_typed"
NOT_TAKEN = "Not done: what you just typed could not be taken. Click again to go on without it."


def apart(
    draw: Callable[P, None], every_seconds: float | None = None, key: str | None = None
) -> Callable[P, None]:
    """`draw` as a part of the page that runs by itself, also every so many seconds."""

    def placed(*args: P.args, **kwargs: P.kwargs) -> None:
        with st.container():
            st.fragment(draw, run_every=every_seconds, key=key)(*args, **kwargs)

    return placed


def take_typed(take: Callable[[], bool]) -> None:
    """Take what was typed on this page since it was drawn: now, and before each click on it.

    `take` says whether all of it could be taken.
    """
    st.session_state[TAKE] = take
    take()


def forget_typed() -> None:
    """Another page may be drawn, which has fields of its own or none."""
    st.session_state.pop(TAKE, None)


def one_click(act: Callable[P, object]) -> Callable[P, None]:
    """`act` as what a widget outside all such parts does when clicked.

    A click that comes with the run of a part is followed by one of its own. One that comes with
    something typed that cannot be taken does nothing: it was meant for what was typed.
    """

    @wraps(act)
    def clicked(*args: P.args, **kwargs: P.kwargs) -> None:
        run = get_script_run_ctx()
        if run is not None and run.fragment_ids_this_run:
            return
        take = st.session_state.get(TAKE)
        if take is None or take():
            act(*args, **kwargs)
        else:
            st.toast(NOT_TAKEN, icon=":material/edit:")

    return clicked
