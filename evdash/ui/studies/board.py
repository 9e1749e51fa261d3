"""The right half of the page: the chosen study, how far it is, and what it found."""

import streamlit as st

from evdash.errors import EvdashError
from evdash.studies.shelf import Shelf
from evdash.ui.studies.handing import handing
from evdash.ui.studies.mine import said_of_address
from evdash.ui.studies.pictures import heading, pictures
from evdash.ui.studies.refusal import resume
from evdash.ui.studies.standing import chosen, standing
from evdash.ui.words import plain

INTRODUCTION = (
    "**Ask what one day cannot tell.** Pick a question on the left and press **Start**: many days "
    "are run beside this page, and what they show is drawn here as it comes. You can go on with "
    "the other pages meanwhile, close the tab, and come back by this page's address."
)
OTHER_CODE = (
    "What this study found was made by another version of evdash, and is not mixed with what this "
    "one would find."
)


def show(shelf: Shelf) -> None:
    """The study looked at, or what this page is for."""
    folder = chosen(shelf)
    if folder is None:
        if said := said_of_address():
            st.warning(said, icon=":material/link_off:")
        st.info(INTRODUCTION, icon=":material/query_stats:")
        return
    try:
        heading(shelf.study(folder).study)
        stand = standing(shelf, folder)
        found = shelf.found(folder, stand)
    except EvdashError as error:
        st.error(f"This study cannot be read. {plain(str(error))}", icon=":material/error:")
        return
    if found.results:
        pictures(found, folder.path.name)
        handing(folder, found)
    elif stand is not None and stand.ended and not stand.is_live:
        st.info(OTHER_CODE, icon=":material/history:")
        st.button("Run it again", on_click=resume, args=(shelf, folder), key="again_study")
