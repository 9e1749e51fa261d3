"""The feeder over the whole day: voltages, headroom, the two models, violations."""

import streamlit as st

from evdash.charts.ac_gap import ac_gap_alt, ac_gap_figure, ac_gap_table
from evdash.charts.headroom import headroom_alt, headroom_figure, headroom_table
from evdash.charts.voltage_map import MapWay, map_figure
from evdash.charts.voltages import voltages_alt, voltages_table
from evdash.metrics.feeder import gaps
from evdash.metrics.verdict_words import sentences
from evdash.ui.apart import apart
from evdash.ui.feeder.findings import AC_PATIENCE_SECONDS, WAYS, ac_points, ac_voltages, layout_in
from evdash.ui.feeder.words import (
    gap_line,
    headline,
    violation_rows,
)
from evdash.ui.limits import help_out, verdicts
from evdash.ui.parts import chart, table, table_below, view
from evdash.ui.reasons import told_binding, told_worths
from evdash.ui.session import Session
from evdash.ui.telling import told_below
from evdash.ui.words import marked, wording


def head(session: Session) -> None:
    """The day in a sentence."""
    with st.container(key="sentence"):
        trace, ac = session.run.trace, ac_voltages(ac_points(session))
        st.markdown(headline(view(session), ac, trace.scenario))


def voltage_map(session: Session) -> None:
    """Every node in every interval."""
    apart(_voltage_map, key="feeder_map")(session)


def _voltage_map(session: Session) -> None:
    ahead, ac = view(session), ac_voltages(ac_points(session))
    with st.container(horizontal=True, vertical_alignment="center", key="map_head"):
        st.markdown("#### Voltages, node by hour", help=MAP_HELP, width="content")
        way: MapWay = st.segmented_control(
            "What the map shows",
            list(WAYS),
            default="with",
            required=True,
            format_func=WAYS.__getitem__,
            key="map_way",
            label_visibility="collapsed",
            persist_state="session",
        )
    order = layout_in(session).order
    chart(
        session,
        "voltage_map",
        lambda: map_figure(ahead, ac, order, way),
        voltages_alt(ahead),
        detail=(way, len(ac)),
    )
    table_below("voltage_map", lambda: voltages_table(ahead, ac))


MAP_HELP = (
    "A line a node, branch by branch from the source outward; a column an interval. Contours "
    "follow the limits where voltages cross them, dotted ones where they come within 0.005 pu. "
    "Crosses: outside limits in the linearised model; rings: in AC power flow."
)


def headroom(session: Session) -> None:
    """Room for charging and the element that leaves no more."""
    ahead = view(session)
    st.markdown("#### Room for charging, and what limits it", help=HEADROOM_HELP)
    chart(
        session,
        "headroom",
        lambda: headroom_figure(ahead),
        headroom_alt(ahead),
    )
    table_below("headroom", lambda: headroom_table(ahead))
    trace = session.run.trace
    if trace.steps:
        told_below("binding", "What binds, and when", trace, told_binding)
    if trace.is_over:
        told_below("worth", "What would more have been worth?", trace, told_worths)


HEADROOM_HELP = (
    "Headroom: the most the station may draw in an interval so that no limit of the feeder is "
    "exceeded. The look of a bar names the element that is reached first."
)


def two_models(session: Session) -> None:
    """Linearised against AC voltages."""
    ahead, ac = view(session), ac_voltages(ac_points(session))
    found = session.once("gaps", lambda: gaps(ahead, ac), detail=len(ac))
    st.markdown("#### Linearised against AC", help=MODELS_HELP)
    st.markdown(gap_line(found, ahead))
    chart(
        session,
        "ac_gap",
        lambda: ac_gap_figure(ahead, found),
        ac_gap_alt(ahead, found),
        detail=len(ac),
    )
    table_below("ac_gap", lambda: ac_gap_table(ahead, found))


MODELS_HELP = (
    "The optimiser works with a linearised model of the feeder, as in the paper, or with full AC "
    "if so chosen on the Live page. AC power flow knows losses and is the judge of both."
)


def limits_exceeded(session: Session) -> None:
    """Violations, those of the station and those of the feeder told apart."""
    trace, ahead = session.run.trace, view(session)
    models = verdicts(session, AC_PATIENCE_SECONDS)
    st.markdown("#### Limits exceeded", help=EXCEEDED_HELP)
    for one in sentences(models, wording(trace, ahead)):
        st.markdown(marked(one))
    help_out(session, models)
    for title, by_charging in (("Because of charging", True), ("The feeder's own", False)):
        rows = [
            row
            for model in models
            for row in violation_rows(
                model.by_charging if by_charging else model.by_feeder, model.network, ahead
            )
        ]
        if rows:
            st.markdown(f"##### {title}")
            table(rows, f"Limits exceeded. {title}: depth, duration and time of each")


EXCEEDED_HELP = (
    "Executed intervals, and in the linearised model also those still planned. The station is the "
    "cause where a limit would hold without it; it never is where charging relieves the limit or "
    "cannot reach it."
)
