"""What the page shows before anybody has asked."""

import streamlit as st

from evdash.errors import legible
from evdash.metrics.ledger import broken_promises, ledger
from evdash.metrics.service import totals
from evdash.ui.parts import view
from evdash.ui.session import Session
from evdash.ui.story import broken_told
from evdash.ui.toolbar import step_button
from evdash.ui.words import clock, counted, plain


def headline(session: Session) -> None:
    """Who has asked and what became of them, in a sentence."""
    trace, ahead = session.run.trace, view(session)
    if not trace.steps:
        return
    sums = session.once("totals", lambda: totals(trace))
    charging = int(trace.steps[-1].plan.charging[0])
    now = "" if trace.is_over else f", {charging} charging"
    when = "in all" if trace.is_over else f"until {clock(ahead.clock, ahead)}"
    short = broken_told(broken_promises(ledger(trace)), trace.now)
    broken = f", :red[{short}]" if short else ""
    with st.container(key="sentence"):
        st.markdown(
            f"**{counted(sums.arrived, 'vehicle')} asked {when}:** "
            f"{sums.admitted:,} admitted, {sums.refused:,} refused{now}, "
            f"{sums.charged:,} charged in full{broken}."
        )


def welcome(session: Session, waited_for: str) -> None:
    """The page before the first step: what will be seen here, and the way on."""
    with st.container(border=True, key="vehicles_start"):
        st.markdown("#### Nobody has asked for a charge yet")
        if waited_for:
            name = plain(legible(waited_for))
            st.markdown(f"**{name}** has not asked yet either; if it does, it is shown here.")
        st.markdown(WELCOME)
        step_button(session, "first_step")


WELCOME = (
    "This page follows single vehicles. Every interval new ones ask for a charge; each gets a "
    "**yes**, which is a contract, or a **no**, at once. Step the day on and you will see here\n"
    "- every vehicle on its own line: when it may charge, when it does, what is planned;\n"
    "- a table to filter, search and sort;\n"
    "- for the one you pick: its contract in plain words, its battery against the promise, its "
    "plan as it was revised, and if it was refused, why and what would have admitted it."
)
