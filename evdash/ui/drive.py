"""What moves a run on without a click: run to end, play, and results that come later."""

import streamlit as st

from evdash.ui.referee import referee
from evdash.ui.session import Session

PLAY_SECONDS = 1.0
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
    """While playing, a step a second; while the AC check is under way, a look for its results."""
    if session.mode == "playing":
        st.fragment(_play, run_every=PLAY_SECONDS)(session, session.run.trace.now)
    elif len(referee.findings(session.run.trace)) < len(session.run.trace.steps):
        known = len(referee.findings(session.run.trace))
        st.fragment(_poll, run_every=POLL_SECONDS)(session, known)


def _play(session: Session, drawn: int) -> None:
    """Step when the timer rings; the call that only sets the timer up does nothing."""
    if _first_call(f"play:{drawn}") or session.mode != "playing":
        return
    session.step()
    st.rerun()


def _poll(session: Session, known: int) -> None:
    findings = referee.findings(session.run.trace)
    if len(findings) > known and len(findings) == len(session.run.trace.steps):
        st.rerun()


def _first_call(name: str) -> bool:
    """Whether the script itself calls, not the timer of a fragment."""
    context = st.runtime.scriptrunner.get_script_run_ctx()
    return context is None or not context.fragment_ids_this_run
