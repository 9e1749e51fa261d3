"""Live: step a day, hour by hour, and change it on the way."""

import streamlit as st

from evdash.ui import controls, drive, live, page
from evdash.ui.session import current

page.by_way_of_app("pages/live.py")
session = current()
controls.take_edits(session)
controls.sidebar(session, live.view(session))
live.toolbar(session)
live.headline(session)
progress = st.container()
live.answer(session)
live.key_figures(session)
left, right = st.columns([2, 1], gap="medium")
with left:
    live.schedule(session)
with right:
    live.decision(session)
left, right = st.columns(2, gap="medium")
with left:
    live.admissions(session)
with right:
    live.load(session)
live.voltages(session)
with progress:
    drive.finish(session)
drive.heartbeat(session)
