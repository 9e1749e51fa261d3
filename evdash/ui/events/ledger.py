"""The ledger on the page: what happened, whose promise suffered, and every promise in a table."""

import streamlit as st

from evdash.metrics.ledger import ledger as entries_of
from evdash.ui.events.words import (
    effect_told,
    events_told,
    ledger_rows,
    story_told,
    summary_told,
)
from evdash.ui.parts import table, view
from evdash.ui.session import Session
from evdash.ui.words import clock

MOST_STORIES = 8
LEDGER_HELP = (
    "Every promise made: energy by a time. Kept, short (something happened by which it cannot be "
    "kept), or cut short by its own driver. Where not all can be kept, as little energy as "
    "possible is missing, then for as few vehicles, then at the least cost."
)


def notice(session: Session) -> None:
    """While a promise is short: that nobody new is admitted, and until when."""
    trace, ahead = session.run.trace, view(session)
    if trace.is_over or not trace.state.is_short:
        return
    short = [c for c in (*trace.state.contracts, *trace.state.waiting) if c.is_short]
    last = max(c.request.deadline_interval for c in short)
    with st.container(key="promises_short"):
        st.warning(
            f"**Nobody new is admitted** while a promise already made cannot be kept: until "
            f"{clock(ahead.times[last], ahead)} at the latest.",
            icon=":material/warning:",
        )


def ledger(session: Session) -> None:
    """What happened and every promise, opened at will; what went wrong is told at once."""
    trace, ahead = session.run.trace, view(session)
    entries = session.once("ledger", lambda: entries_of(trace))
    with st.container(key="ledger"):
        st.markdown(
            f"#### The ledger of promises\n{summary_told(entries).capitalize()}.",
            help=LEDGER_HELP,
        )
        for happening in trace.happenings:
            at = clock(ahead.times[happening.interval], ahead)
            told = f"{events_told(happening.events, ahead)}. {effect_told(happening)}"
            st.markdown(f"**{at}** {told}")
        changed = [entry for entry in entries if entry.changes]
        for entry in changed[:MOST_STORIES]:
            st.markdown(f"- {story_told(entry, ahead)}")
        if len(changed) > MOST_STORIES:
            st.caption(f"and {len(changed) - MOST_STORIES} more in the table")
        box = st.expander(
            "Every promise in a table", key="table_ledger", type="compact", on_change="rerun"
        )
        if box.open:
            with box:
                table(ledger_rows(entries, ahead), "The ledger of all promises")
