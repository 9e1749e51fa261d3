"""Why a study could not be lined up, from the click to the page that tells it."""

from collections.abc import Iterator
from contextlib import contextmanager

import streamlit as st

from evdash.errors import EvdashError
from evdash.studies.folder import StudyFolder
from evdash.studies.shelf import Shelf
from evdash.ui.visitors import visitor
from evdash.ui.words import plain

KEY = "evdash:studies:refused"


@contextmanager
def refusals() -> Iterator[None]:
    """Remember what is refused in here, instead of failing."""
    try:
        yield
    except EvdashError as error:
        st.session_state[KEY] = str(error)


def resume(shelf: Shelf, folder: StudyFolder, retry: bool = False) -> None:
    """Go on with a study, or remember why it cannot be lined up."""
    with refusals():
        shelf.resume(folder, retry, visitor())


def show_refusal() -> None:
    """Tell once what was refused."""
    if said := st.session_state.pop(KEY, ""):
        st.warning(plain(said), icon=":material/hourglass_top:")
