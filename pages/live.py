"""Live: step a day, hour by hour, and change it on the way."""

from functools import partial

import streamlit as st

from evdash.ui import apart, drive, limits, page, parts
from evdash.ui.events import ledger, panel
from evdash.ui.live import controls, decision, head, panels, prompts, voltages
from evdash.ui.session import current
from evdash.ui.toolbar import toolbar

page.by_way_of_app("pages/live.py")
session = current()
apart.take_typed(partial(controls.take_edits, session))
voltages.ask(session)
controls.sidebar(session, parts.view(session))
with st.container(key="live"):
    toolbar(session)
    head.headline(session)
    exceeded, progress = st.container(key="exceeded"), st.container()
    head.answer(session)
    ledger.notice(session)
    prompts.case_panel(session)
    head.key_figures(session)
    prompts.prompts_row(session)
    prompts.outcome(session)
left, right = st.columns([2, 1], gap="medium")
with left:
    panels.schedule(session)
with right:
    decision.decision(session)
panel.panel(session)
left, right = st.columns(2, gap="medium")
with left:
    panels.admissions(session)
with right:
    panels.load(session)
voltages.voltages(session)
with exceeded:
    limits.headline(session)
ledger.ledger(session)
with progress:
    drive.finish(session)
drive.heartbeat(session)
