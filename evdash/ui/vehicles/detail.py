"""One vehicle: its contract, its power and battery, its plan as revised, and why."""

import streamlit as st

from evdash.charts.plan_history import history_alt, history_figure, history_table
from evdash.charts.vehicle import vehicle_alt, vehicle_figure, vehicle_table
from evdash.errors import legible
from evdash.metrics.records import vehicle_records
from evdash.metrics.vehicles import VehicleDay, plan_history, vehicle_day
from evdash.ui.parts import chart, table_below, view
from evdash.ui.reasons import told_revision_at, told_why
from evdash.ui.session import Session
from evdash.ui.telling import refused_in, told_later
from evdash.ui.vehicles.choice import by_name
from evdash.ui.vehicles.picked import pick_typed
from evdash.ui.vehicles.words import change_lines, contract_lines, title
from evdash.ui.words import clock, plain


def detail(session: Session, picked: str) -> None:
    """A box to pick a vehicle from, and all about the one that is picked."""
    trace = session.run.trace
    records = session.once("vehicle_records", lambda: vehicle_records(trace))
    names = sorted((record.vehicle for record in records), key=by_name)
    # for each vehicle another widget, so that no choice of before comes late and undoes this one
    key = f"vehicle_pick:{picked if picked in names else ''}"
    st.session_state[key] = picked if picked in names else None
    st.selectbox(
        "Look at one vehicle",
        names,
        index=None,
        key=key,
        placeholder="Type or pick a name",
        on_change=pick_typed,
        args=(key,),
        help="Or click its row in the table. The address of this page then names it.",
    )
    if picked not in names:
        _nobody(session, picked)
        return
    day = session.once("vehicle_day", lambda: vehicle_day(trace, picked), detail=picked)
    with st.container(key="vehicle_detail"):
        st.markdown(title(day.record))
        for line in contract_lines(day, trace.scenario, view(session)):
            st.markdown(line)
        if not day.is_admitted:
            _why(session, day)
        _power(session, day)
        if day.is_admitted:
            _plans(session, day)


def _nobody(session: Session, picked: str) -> None:
    """What stands here while no vehicle, or none that has asked, is picked."""
    ahead = view(session)
    with st.container(border=True, key="vehicle_none"):
        if picked:
            over = session.run.trace.is_over
            yet = (
                "did not ask on this day"
                if over
                else f"has not asked by {clock(ahead.clock, ahead)}"
            )
            st.markdown(f"**{plain(legible(picked))}** {yet}.")
        st.markdown(NOBODY)


NOBODY = (
    "Pick a vehicle to see\n"
    "- what it asked for, what it was promised by when, and what it pays;\n"
    "- when it charges, and its battery against what the promise needs;\n"
    "- how its plan was revised each time somebody new came;\n"
    "- if it was refused: why, and what would have admitted it."
)


def _power(session: Session, day: VehicleDay) -> None:
    ahead = view(session)
    st.markdown("##### Power and battery", help=POWER_HELP)
    chart(
        session,
        "vehicle",
        lambda: vehicle_figure(day, ahead),
        vehicle_alt(day, ahead),
        detail=day.record.vehicle,
    )
    table_below("vehicle", lambda: vehicle_table(day, ahead))


POWER_HELP = (
    "Above: mean power from the grid in each interval, and the energy price. Below: the battery. "
    "As long as it stays on or above the dashed line, charging at full power up to the promised "
    "time still keeps the promise."
)


def _plans(session: Session, day: VehicleDay) -> None:
    """Its plan each time it was made, and what changed."""
    trace, ahead, vehicle = session.run.trace, view(session), day.record.vehicle
    history = session.once("history", lambda: plan_history(trace, vehicle), detail=vehicle)
    st.markdown("##### The plan, hour after hour", help=PLANS_HELP)
    chart(
        session,
        "history",
        lambda: history_figure(history, day, ahead),
        history_alt(history, ahead),
        detail=vehicle,
    )
    table_below("history", lambda: history_table(history, ahead))
    lines = session.once("changes", lambda: change_lines(trace, vehicle, ahead), detail=vehicle)
    if not lines:
        st.markdown("Its plan has never been changed since it was made.")
        return
    st.markdown("  \n".join(line for _, line in lines))
    _why_changed(session, [interval for interval, _ in lines])


PLANS_HELP = (
    "A line for each time a plan was made, a column for each interval planned. The station makes "
    "its whole plan anew every interval, so energy may move, but never beyond the promised time. "
    "Triangles: more or less power than in the line above. Dots: carried out."
)


def _why(session: Session, day: VehicleDay) -> None:
    """Why it was refused, and what would have admitted it."""
    trace, vehicle = session.run.trace, day.record.vehicle
    st.markdown("##### Why, and what would have admitted it", help=WHY_HELP)
    st.markdown(f"In short: {plain(day.record.why_not)}.")
    told_later("why_refused", refused_in(trace, vehicle), vehicle, lambda: told_why(trace, vehicle))


WHY_HELP = (
    "Found by solving again with one thing changed: the cause, and the least change that would "
    "have admitted this vehicle, all else as it was."
)


def _why_changed(session: Session, intervals: list[int]) -> None:
    """On request: what made the whole station's plan change at one of these moments."""
    trace, ahead = session.run.trace, view(session)
    at = st.selectbox(
        "Why was it changed?",
        intervals,
        index=None,
        format_func=lambda interval: clock(ahead.times[interval], ahead),
        key="why_changed_at",
        placeholder="Pick the time of a change",
        help="Told for all contracts together. Found by solving once more without the newcomers.",
    )
    if at is not None:
        told_later(
            "why_changed",
            trace.steps[at],
            "revision",
            lambda: told_revision_at(trace, at),
        )
