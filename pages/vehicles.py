"""Vehicles: who asked, who charges when, and all about one of them."""

import streamlit as st

from evdash.ui import drive, page
from evdash.ui.session import current
from evdash.ui.toolbar import toolbar
from evdash.ui.vehicles import body

page.by_way_of_app("pages/vehicles.py")
session = current()
toolbar(session)
progress = st.container()
body.body(session)
with progress:
    drive.finish(session)
drive.heartbeat(session)
