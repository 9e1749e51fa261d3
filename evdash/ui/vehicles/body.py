"""The Vehicles page from its headline down."""

import streamlit as st

from evdash.ui.session import Session
from evdash.ui.vehicles.detail import detail
from evdash.ui.vehicles.listing import listing
from evdash.ui.vehicles.picked import picked
from evdash.ui.vehicles.start import headline, welcome


def body(session: Session) -> None:
    """All vehicles on the left, one of them on the right; before the first step, a welcome."""
    vehicle = picked()
    if not session.run.trace.steps:
        welcome(session, vehicle)
        return
    headline(session)
    left, right = st.columns([1.25, 1], gap="medium")
    with left:
        listing(session, vehicle)
    with right:
        detail(session, vehicle)
