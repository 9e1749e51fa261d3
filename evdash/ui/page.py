"""What every page begins with: the bar of pages, its address, and the way in by a deep link."""

import gc
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from functools import lru_cache

import streamlit as st
from streamlit.navigation.page import Page

from evdash.ui.apart import forget_typed
from evdash.ui.keeping import LINK
from evdash.ui.session import KEY, PRESET, Session
from evdash.ui.studies import mine

BEGUN, GOAL = "evdash:begun", "evdash:goal"


def begin() -> None:
    """Remember that `app.py` came first."""
    st.session_state[BEGUN] = True
    forget_typed()


def navigation(groups: Mapping[str, Sequence[Page]]) -> Page:
    """The bar of all pages in their groups, and the page to show."""
    return st.navigation({name: pages for name, pages in groups.items() if pages}, position="top")


def drawing() -> AbstractContextManager[None]:
    """While the page is being drawn."""
    session: Session | None = st.session_state.get(KEY)
    return session.rest.broken() if session else nullcontext()


def keep_address() -> None:
    """Have the address say which run this is, also after a change or a link to another page."""
    mine.keep_address()
    session: Session | None = st.session_state.get(KEY)
    if session is None:
        return  # what the address says is still to be read
    folder = session.run.folder
    truth = {PRESET: folder.name if folder else "", LINK: session.keeper.link}
    for name, value in truth.items():
        if value and st.query_params.get(name) != value:
            st.query_params[name] = value
        elif not value:
            st.query_params.pop(name, None)


def by_way_of_app(page: str) -> None:
    """Make sure that `app.py` comes first; the first line of every page.

    If a server's very first visitor asks for a page other than `/`, Streamlit runs that page's
    file alone. Then the goal is remembered, with the query, and the app goes on to it.
    """
    if BEGUN not in st.session_state:
        st.session_state[GOAL] = page
        st.switch_page("app.py", query_params=st.query_params.to_dict())
    keep_address()


def go_on(shown: str) -> None:
    """Switch to the page remembered by `by_way_of_app`, unless it is the one about to be shown."""
    goal = st.session_state.pop(GOAL, shown)
    if goal != shown:
        st.switch_page(goal, query_params=st.query_params.to_dict())


@lru_cache(maxsize=1)
def settle_in() -> None:
    """What is to be done once, after the first page of a server is out.

    Tables need pandas; imported in the middle of another page, plotly would take it for whole while
    it is half imported. And what imports brought along is taken out of the garbage collector's way.
    """
    import pandas  # noqa: F401, PLC0415

    gc.freeze()
