"""Scenario: everything a day is made of, to edit, take in and hand out."""

import streamlit as st

from evdash.ui import apart, page
from evdash.ui.scenario import form, outcome, sources
from evdash.ui.scenario.editor import current_editor
from evdash.ui.session import current

page.by_way_of_app("pages/scenario.py")
session = current()
editor = current_editor(session)
apart.take_typed(editor.take_typed)
sources.sources(session, editor)
head = st.container()
form.form(editor)
with head:
    outcome.outcome(session, editor)
