"""The feeder over the whole day: voltages, headroom, the two models, violations."""

import streamlit as st

from evdash.charts.ac_gap import ac_gap_alt, ac_gap_figure, ac_gap_table
from evdash.charts.headroom import headroom_alt, headroom_figure, headroom_table
from evdash.charts.voltage_map import MapWay, map_figure
from evdash.charts.voltages import voltages_alt, voltages_table
from evdash.metrics.feeder import day_breaches, gaps, violations
from evdash.ui.apart import apart
from evdash.ui.feeder.findings import WAYS, ac_points, ac_voltages, layout_in
from evdash.ui.feeder.words import (
    element_names,
    gap_line,
    headline,
    verdict,
    violation_rows,
)
from evdash.ui.parts import chart, table, table_below, view
from evdash.ui.reasons import told_binding, told_worths
from evdash.ui.session import Session
from evdash.ui.telling import told_below
from evdash.ui.words import unchecked_lines


def head(session: Session) -> None:
    """The day in a sentence."""
    with st.container(key="sentence"):
        st.markdown(headline(view(session), session.run.trace.scenario))


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
    names = element_names(ahead)
    st.markdown("#### Room for charging, and what limits it", help=HEADROOM_HELP)
    chart(
        session,
        "headroom",
        lambda: headroom_figure(ahead, names),
        headroom_alt(ahead, names),
    )
    table_below("headroom", lambda: headroom_table(ahead, names))
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
    points = ac_points(session)
    linear = session.once("linear", lambda: violations(day_breaches(trace, ahead)))
    ac = session.once(
        "ac_violations",
        lambda: violations(breach for t in sorted(points) for breach in points[t].breaches),
        detail=len(points),
    )
    st.markdown("#### Limits exceeded", help=EXCEEDED_HELP)
    waiting = len(trace.steps) - len(points)
    unchecked = unchecked_lines(points)
    for line in unchecked:
        st.markdown(line)
    begun = bool(trace.steps)
    for line in verdict(linear, ac, waiting=waiting, unchecked=bool(unchecked), begun=begun):
        st.markdown(line)
    for title, is_own in (("Because of charging", False), ("The feeder's own", True)):
        rows = [
            row
            for found, model in ((linear, "linearised"), (ac, "AC"))
            for row in violation_rows(
                (one for one in found if (one.cause == "feeder") == is_own), model, ahead
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
