"""The one-line drawing and its hour; moving the hour redraws nothing else."""

import streamlit as st

from evdash.charts.feeder import feeder_figure
from evdash.charts.feeder_moment import feeder_alt, feeder_table, lines_table
from evdash.charts.style import spans
from evdash.charts.voltage_map import MapWay
from evdash.metrics.feeder import tightest
from evdash.ui.feeder.findings import WAYS, moment_at
from evdash.ui.feeder.words import moment_lines, tightest_rows
from evdash.ui.parts import chart, small_table, table_below, view
from evdash.ui.session import Session

MOST_LIMITS = 5
HOUR, HOUR_NOW = "feeder_hour", "evdash:feeder_now"
DRAWING_HELP = (
    "Colour: voltage; the limits are marked on the bar. Square: the source, where the feeder is "
    "supplied; diamond: the charging station. Lines: the wider, the nearer to their rating, which "
    "the number says in %. The halo marks the tightest limit. Red crosses: outside limits in the "
    "linearised model; red rings: outside in AC power flow."
)


def drawing(session: Session) -> None:
    """The drawing in its own fragment."""
    follow_clock(session)
    st.fragment(_drawing, key="feeder_drawing")(session)


def follow_clock(session: Session) -> None:
    """Show the interval carried out last whenever the run has moved on."""
    trace = session.run.trace
    state = (trace.now, trace.scenario.intervals)
    if st.session_state.get(HOUR_NOW) != state or HOUR not in st.session_state:
        st.session_state[HOUR_NOW] = state
        st.session_state[HOUR] = max(0, trace.now - 1)


def _drawing(session: Session) -> None:
    ahead = view(session)
    words = spans(ahead)
    left, right = st.columns([2.2, 1], gap="medium")
    with left:
        with st.container(horizontal=True, vertical_alignment="center", key="feeder_head"):
            st.markdown("#### The feeder", help=DRAWING_HELP, width="content")
            way: MapWay = st.segmented_control(
                "What to show",
                list(WAYS),
                default="with",
                required=True,
                format_func=WAYS.__getitem__,
                key="feeder_way",
                label_visibility="collapsed",
                persist_state="session",
            )
        hour = st.select_slider(
            "Hour",
            list(range(ahead.n_intervals)),
            format_func=words.__getitem__,
            key=HOUR,
            persist_state="session",
            help="Arrow keys move it, too. After every step it shows the interval just decided.",
        )
        moment = moment_at(session, hour, way)
        chart(
            session,
            "feeder",
            lambda: feeder_figure(moment),
            feeder_alt(moment),
            detail=(hour, way, moment.ac_pu is not None),
        )
    with right, st.container(key="feeder_moment"):
        when = "executed" if hour < ahead.now else "planned"
        st.markdown(f"#### {words[hour]} · {when}")
        for line in moment_lines(moment):
            st.markdown(line)
        if limits := tightest(session.run.trace, hour, MOST_LIMITS):
            small_table(tightest_rows(limits), height=240)
        table_below("feeder", lambda: feeder_table(moment), "Nodes as a table")
        table_below("lines", lambda: lines_table(moment), "Lines as a table")
