"""The charts of a day: who charges when, who was admitted, load and price."""

import streamlit as st

from evdash.charts.admissions import admissions_alt, admissions_figure, admissions_table
from evdash.charts.load import load_alt, load_table, normalised_figure, units_figure
from evdash.charts.schedule import schedule_alt, schedule_figure, schedule_table
from evdash.ui.glossary import meaning
from evdash.ui.parts import chart, table_below, view
from evdash.ui.session import Session
from evdash.ui.words import counted


def schedule(session: Session) -> None:
    """Who charges when."""
    trace, ahead = session.run.trace, view(session)
    with st.container(key="schedule"):
        st.markdown("#### Charging schedule", help=SCHEDULE_HELP)
        chart(
            session,
            "schedule",
            lambda: schedule_figure(trace, ahead),
            schedule_alt(trace, ahead),
        )
        table_below("schedule", lambda: schedule_table(trace, ahead))


SCHEDULE_HELP = (
    "One row a vehicle under contract. Outlined: from arrival to the promised return. Solid: "
    "charged; hatched: planned; the thicker, the higher the power. At the end: its price option "
    "and how much of what was promised it has. Red, with !: not all of it came, or can come."
)


def admissions(session: Session) -> None:
    """Who asked, was admitted, was refused."""
    trace, ahead = session.run.trace, view(session)
    st.markdown("#### Admitted and refused")
    chart(
        session,
        "admissions",
        lambda: admissions_figure(trace, ahead),
        admissions_alt(trace, ahead),
    )
    late = len(trace.inputs.requests[ahead.n_intervals]) if trace.is_over else 0
    if late:
        st.caption(f"{counted(late, 'more vehicle')} came once the last interval had begun.")
    table_below("admissions", lambda: admissions_table(trace, ahead))


def load(session: Session) -> None:
    """Station load against headroom, feeder load and price."""
    ahead = view(session)
    with st.container(horizontal=True, vertical_alignment="center", key="load_head"):
        st.markdown("#### Load and price", help=LOAD_HELP, width="content")
        in_units = st.toggle(
            "in kW and \\$/kWh",
            key="in_units",
            persist_state="session",
            help="Off: everything as a share, to compare shapes. On: power on the left axis, "
            "price on the right one.",
        )
    draw = units_figure if in_units else normalised_figure
    chart(session, "load", lambda: draw(ahead), load_alt(ahead), detail=in_units)
    table_below("load", lambda: load_table(ahead))


LOAD_HELP = (
    "As shares: station load and headroom of the rating nearest to the station, feeder load of "
    f"its peak, price of its highest. Headroom: {meaning('Headroom')}"
)
