"""Model: the mathematics with this run's numbers in it, and what the paper reports."""

import streamlit as st

from evdash.ui import drive, page, toolbar
from evdash.ui.model import tabs
from evdash.ui.session import current

page.by_way_of_app("pages/model.py")
session = current()
toolbar.toolbar(session)
progress = st.container()
tabs.tabs(session)
with progress:
    drive.finish(session)
drive.heartbeat(session)
