"""Voltages, what the AC power flow found, and the limits by the hour."""

import streamlit as st

from evdash.charts.voltages import (
    base_figure,
    drop_figure,
    voltages_alt,
    voltages_figure,
    voltages_table,
)
from evdash.domain.outlook import Outlook
from evdash.domain.words import element_name
from evdash.metrics.verdict_words import sentences
from evdash.ui.glossary import meaning
from evdash.ui.limits import verdicts
from evdash.ui.parts import chart, small_table, table_below, view
from evdash.ui.referee import referee
from evdash.ui.session import Session
from evdash.ui.words import clock, marked, wording

AC_PATIENCE_SECONDS = 0.06
"""How long a page waits for the AC power flow of its latest step before it goes on without."""


def ask(session: Session) -> None:
    """Have the AC power flow of the latest step begun while the page is being put together."""
    referee.findings(session.run.trace)


def voltages(session: Session) -> None:
    """Nodal voltages with their limits, and what the AC power flow found."""
    ahead = view(session)
    found = referee.findings(session.run.trace, AC_PATIENCE_SECONDS)
    ac = {interval: finding.voltage_pu for interval, finding in found.items()}
    left, right = st.columns([2, 1], gap="medium")
    with left:
        with st.container(horizontal=True, vertical_alignment="center", key="voltages_head"):
            st.markdown("#### Voltages", help=VOLTAGE_HELP, width="content")
            way = st.segmented_control(
                "What to show",
                WAYS,
                default=WAYS[0],
                required=True,
                key="voltage_way",
                label_visibility="collapsed",
                persist_state="session",
            )
        draw = {
            WAYS[0]: lambda: voltages_figure(ahead, ac),
            WAYS[1]: lambda: base_figure(ahead),
            WAYS[2]: lambda: drop_figure(ahead),
        }[way]
        chart(session, "voltages", draw, voltages_alt(ahead), detail=(way, len(ac)))
        table_below("voltages", lambda: voltages_table(ahead, ac))
    with right, st.container(key="ac"):
        _verdict(session)
        _limits(session)


WAYS = ("With charging", "Without", "Difference")
VOLTAGE_HELP = (
    f"pu: {meaning('pu')} The optimiser works with a linearised model of the feeder; the full AC "
    "power flow, which knows losses, checks what was executed."
)


def _verdict(session: Session) -> None:
    st.markdown("#### Limits, and the AC check", help=VOLTAGE_HELP)
    for one in sentences(verdicts(session), wording(session.run.trace, view(session))):
        st.markdown(marked(one))


def _limits(session: Session) -> None:
    ahead = view(session)
    first = 0 if session.run.trace.is_over else ahead.now
    st.markdown("#### Limits by the hour", help=LIMITS_HELP)
    rows = session.once("limits", lambda: limit_rows(ahead, first))
    small_table(rows, height=330)


LIMITS_HELP = (
    "Of all limits of the feeder the tightest in each interval, whether reached or not, and the "
    "room it leaves for charging (headroom). Voltages by the linearised model."
)


def limit_rows(ahead: Outlook, first: int) -> list[dict[str, object]]:
    """Headroom and what sets it, by interval, as rows of a table."""
    return [
        {
            "From": clock(ahead.times[t], ahead),
            "Room, kW": round(float(ahead.headroom_kw[t])) if ahead.binding[t] else None,
            "Limited by": element_name(ahead.binding[t]),
        }
        for t in range(first, ahead.n_intervals)
    ]
