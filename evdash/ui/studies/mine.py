"""Whose studies a tab shows: those begun from it, or named by its address."""

import re
from typing import TYPE_CHECKING

import streamlit as st

from evdash.errors import legible
from evdash.store.place import store_directory
from evdash.store.runs import new_link
from evdash.ui.words import plain

if TYPE_CHECKING:
    from evdash.studies.shelf import Shelf

OWNER = "studies"
"""What the address calls somebody's studies."""
KEY = "evdash:studies"
LINK = re.compile(r"[\w-]{16,40}")


def keep_address() -> None:
    """Have the address lead back to this tab's studies, once there are any."""
    said = st.query_params.get(OWNER, "")
    if KEY not in st.session_state and LINK.fullmatch(said):
        st.session_state[KEY] = _shelf(said)
    shelf: Shelf | None = st.session_state.get(KEY)
    if shelf is not None and shelf.owner != said and shelf.folders():
        st.query_params[OWNER] = shelf.owner


def said_of_address() -> str:
    """What a person should know of an address whose studies are not there; empty where they are."""
    said, shelf = st.query_params.get(OWNER, ""), current_shelf()
    if not said or shelf.folders():
        return ""
    if shelf.owner != said:
        return f"{plain(legible(said))} in this address is no name of studies: none can be shown."
    return "No studies are kept under this address any more, or it was not copied whole."


def current_shelf() -> "Shelf":
    """This tab's studies."""
    if KEY not in st.session_state:
        st.session_state[KEY] = _shelf(new_link())
    shelf: Shelf = st.session_state[KEY]
    return shelf


def _shelf(owner: str) -> "Shelf":
    # what studies are made of takes a second to import, and no first page is to wait for it
    from evdash.studies.shelf import Shelf  # noqa: PLC0415

    return Shelf(store_directory() / "studies", owner)
