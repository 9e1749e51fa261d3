"""The one-line drawing and its hour; moving the hour redraws nothing else."""

import streamlit as st

from evdash.charts.feeder import feeder_figure
from evdash.charts.feeder_moment import feeder_alt, feeder_table, lines_table
from evdash.charts.style import spans
from evdash.charts.voltage_map import MapWay
from evdash.metrics.feeder import tightest
from evdash.ui.apart import apart
from evdash.ui.feeder.findings import WAYS, moment_at
from evdash.ui.feeder.words import moment_lines, tightest_rows
from evdash.ui.parts import chart, small_table, table_below, view
from evdash.ui.session import Session
from evdash.ui.words import wording

MOST_LIMITS = 5
DRAWING_HELP = (
    "Colour: voltage; the limits are marked on the bar. Square: the source, where the feeder is "
    "supplied; diamond: the charging station. Lines: the wider, the nearer to their rating, which "
    "the number says in %; dotted red: over it in either model. The halo marks the tightest limit. "
    "Red crosses: outside limits in the linearised model; red rings: outside in AC power flow."
)


def drawing(session: Session) -> None:
    """The drawing in its own fragment."""
    apart(_drawing, key="feeder_drawing")(session)


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
        hour = _hour(session, words)
        moment = moment_at(session, hour, way)
        chart(
            session,
            "feeder",
            lambda: feeder_figure(moment),
            feeder_alt(moment),
            detail=(hour, way, moment.ac is not None),
        )
    with right, st.container(key="feeder_moment"):
        when = "executed" if hour < ahead.now else "planned"
        st.markdown(f"#### {words[hour]} · {when}")
        for line in moment_lines(moment, wording(session.run.trace, ahead)):
            st.markdown(line)
        if limits := tightest(session.run.trace, hour, MOST_LIMITS):
            small_table(tightest_rows(limits), height=240)
        table_below("feeder", lambda: feeder_table(moment), "Nodes as a table")
        table_below("lines", lambda: lines_table(moment), "Lines as a table")


def _hour(session: Session, words: list[str]) -> int:
    """The interval to draw: the one carried out last, until somebody moves it.

    After each step it is another widget, so that no value of before the step comes late.
    """
    now = session.run.trace.now
    hour: int = st.select_slider(
        "Hour",
        list(range(len(words))),
        value=max(0, now - 1),
        format_func=words.__getitem__,
        key=f"feeder_hour:{now}:{len(words)}",
        persist_state="session",
        help="Arrow keys move it, too. After every step it shows the interval just decided.",
    )
    return hour
