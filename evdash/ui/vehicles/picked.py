"""Which vehicle is looked at: kept for the session, and in the address, so that it can be sent."""

from collections.abc import Sequence

import streamlit as st

VEHICLE, PICKED = "vehicle", "evdash:vehicle"


def picked() -> str:
    """The vehicle picked, or the one the address names; "" for none."""
    asked = st.query_params.get(VEHICLE, "")
    if asked:
        st.session_state[PICKED] = asked
    name: str = st.session_state.get(PICKED, "")
    return name


def pick(vehicle: str | None) -> None:
    """Look at this vehicle from now on, or at none."""
    st.session_state[PICKED] = vehicle or ""
    if vehicle:
        st.query_params[VEHICLE] = vehicle
    else:
        st.query_params.pop(VEHICLE, None)


def pick_typed(key: str) -> None:
    """Pick what a selectbox now holds."""
    pick(st.session_state[key])


def pick_clicked(key: str, vehicles: Sequence[str]) -> None:
    """Pick the row of a table that was clicked; a click on it again picks nothing anew."""
    rows = st.session_state[key]["selection"]["rows"]
    if rows and rows[0] < len(vehicles):
        pick(vehicles[rows[0]])


def pick_drawn(key: str, vehicles: Sequence[str]) -> None:
    """Pick the line of a chart that was clicked: a point's y counts lines from the top."""
    points = st.session_state[key]["selection"]["points"]
    if points and 0 <= points[0]["y"] < len(vehicles):
        pick(vehicles[int(points[0]["y"])])
