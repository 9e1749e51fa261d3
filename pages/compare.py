"""Compare: runs pinned under a name, held against each other."""

import streamlit as st

from evdash.ui import page
from evdash.ui.compare import board, overlays
from evdash.ui.compare.pins import current_pins, held_together
from evdash.ui.race.panel import race_panel
from evdash.ui.session import current

page.by_way_of_app("pages/compare.py")
session = current()
pins = current_pins(session)
held = held_together(session, pins)
left, right = st.columns([3, 1], gap="medium", vertical_alignment="top")
with left:
    board.pin_present(session, pins)
with right:
    base = overlays.reference(held)
board.pinned(session, pins)
board.how_far(held, pins)
progress = st.container()
overlays.comparison(held, base)
race_panel(session)
with progress:
    board.run_on(session, pins)
