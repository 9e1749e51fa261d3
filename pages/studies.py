"""Studies: many days, from a question to its picture."""

import streamlit as st

from evdash.ui import page
from evdash.ui.session import current
from evdash.ui.studies import board
from evdash.ui.studies.ask import ask
from evdash.ui.studies.mine import current_shelf

page.by_way_of_app("pages/studies.py")
session = current()
shelf = current_shelf()
left, right = st.columns([1, 2.1], gap="medium")
with left:
    ask(session, shelf)
with right:
    board.show(shelf)
