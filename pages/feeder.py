"""Feeder: voltages, loading and limits of the network the station hangs on."""

import streamlit as st

from evdash.ui import drive, page
from evdash.ui.feeder import drawing, panels
from evdash.ui.session import current
from evdash.ui.toolbar import toolbar

page.by_way_of_app("pages/feeder.py")
session = current()
toolbar(session)
panels.head(session)
progress = st.container()
drawing.drawing(session)
left, right = st.columns(2, gap="medium")
with left:
    panels.voltage_map(session)
with right:
    panels.headroom(session)
left, right = st.columns(2, gap="medium")
with left:
    panels.two_models(session)
with right:
    panels.limits_exceeded(session)
with progress:
    drive.finish(session)
drive.heartbeat(session)
