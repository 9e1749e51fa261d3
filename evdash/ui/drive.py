"""What moves a run on without a click: run to end, play, and results that come later."""

import streamlit as st

from evdash.ui.apart import apart
from evdash.ui.referee import referee
from evdash.ui.session import Session

PLAY_SECONDS = 1.0
PLAY_SHARE = 0.7
"""The script itself calls the heartbeat, too: only after so much of a second is it time to step."""
POLL_SECONDS = 0.4


def finish(session: Session) -> None:
    """Step to the end, telling how far it is. Any click stops it between two steps."""
    if session.mode != "finishing":
        return
    with st.container(key="progress"):
        bar = st.progress(0.0, "Running to the end …")
    while session.mode == "finishing":
        session.step()
        trace = session.run.trace
        share = trace.now / trace.scenario.intervals
        bar.progress(share, f"{trace.scenario.time_of(trace.now):%H:%M} …")
    st.rerun()


def heartbeat(session: Session) -> None:
    """While playing, a step a second; while the AC check is under way, a look for its results.

    The fragment is there even if nothing is waited for: a browser's timer may ring once more.
    """
    known = len(referee.findings(session.run.trace))
    waiting = known < len(session.run.trace.steps)
    seconds = PLAY_SECONDS if session.mode == "playing" else POLL_SECONDS if waiting else None
    apart(_beat, seconds)(session, waiting=waiting)


def _beat(session: Session, *, waiting: bool) -> None:
    steps = session.run.trace.steps
    if session.mode == "playing":
        if session.seconds_since_step() >= PLAY_SHARE * PLAY_SECONDS:
            session.step()
            st.rerun()
    elif waiting and len(referee.findings(session.run.trace)) == len(steps):
        st.rerun()
