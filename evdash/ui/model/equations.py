"""P1 equation by equation, filled in with one hour, one vehicle and one node of this run."""

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any

import streamlit as st

from evdash.domain.trace import Step
from evdash.metrics.equations import (
    lowest_node,
    node_numbers,
    rating_numbers,
    station_numbers,
    vehicle_numbers,
    vehicles_of,
)
from evdash.resources import IMPORTABLE_FROM
from evdash.ui.model.card import Card, Numbers
from evdash.ui.model.cards import GROUPS
from evdash.ui.parts import view
from evdash.ui.session import Session
from evdash.ui.words import clock, plain

NOT_BEGUN = (
    "No interval has been decided yet, so there are no numbers to put into the equations. "
    "Press **Step** or **Run to end** above."
)


def equations(session: Session) -> None:
    """The pickers, and below them every equation in its group."""
    steps = session.run.trace.steps
    if not steps:
        st.info(NOT_BEGUN, icon=":material/function:")
    numbers = _picked(session) if steps else None
    for title, cards in GROUPS.items():
        st.markdown(f"#### {title}")
        across = 2 if len(cards) % 2 == 0 else 3
        for first in range(0, len(cards), across):
            columns = st.columns(across, gap="small")
            for column, card in zip(columns, cards[first : first + across], strict=False):
                with column:
                    _card(card, numbers)
    st.caption(
        "(4a) and (4b) limit injections in general; no such limits are given but ratings, which "
        "are (2). Δt, the length of an interval in hours, is missing in the paper's objective."
    )


def _picked(session: Session) -> Numbers:
    step = _step(session)
    columns = st.columns(2)
    with columns[0]:
        vehicle = _vehicle(step)
    with columns[1]:
        node = _node(step)
    return Numbers(
        step=step,
        node=node_numbers(step, node),
        rating=rating_numbers(step),
        station=station_numbers(step),
        vehicle=vehicle_numbers(step, vehicle) if vehicle else None,
    )


def _step(session: Session) -> Step:
    steps, ahead = session.run.trace.steps, view(session)
    hours = [clock(ahead.times[step.interval], ahead) for step in steps]
    if st.session_state.get("model_hour") not in hours:
        st.session_state["model_hour"] = hours[_busiest(steps)]
    hour = st.select_slider(
        "Interval that begins at",
        hours if len(hours) > 1 else [*hours, "…"],
        key="model_hour",
        disabled=len(hours) == 1,
        persist_state="session",
        help="Of those decided so far; at first the one with most vehicles charging.",
    )
    return steps[hours.index(hour)] if hour in hours else steps[-1]


def _busiest(steps: tuple[Step, ...]) -> int:
    return max(range(len(steps)), key=lambda t: (int(steps[t].plan.charging[0]), -t))


def _vehicle(step: Step) -> str | None:
    everyone = [request.vehicle for request in vehicles_of(step)]
    if not everyone:
        st.caption("Nobody is under contract or asking in this interval.")
        return None
    served = step.plan.vehicles
    running = served[int(step.plan.power_kw[:, 0].argmax())] if served else ""
    if st.session_state.get("model_vehicle") not in everyone:
        st.session_state["model_vehicle"] = running if running in everyone else everyone[0]
    contracts = {contract.vehicle for contract in step.before.contracts}
    refused = {refusal.vehicle for refusal in step.plan.refused}

    def told(vehicle: str) -> str:
        kind = "under contract" if vehicle in contracts else "new, admitted"
        return f"{vehicle} ({'new, refused' if vehicle in refused else kind})"

    picked: str = st.selectbox(
        "Vehicle",
        everyone,
        format_func=told,
        key="model_vehicle",
        persist_state="session",
        help="Everyone who was decided on in this interval.",
    )
    return picked


def _node(step: Step) -> str:
    scenario = step.inputs.scenario
    nodes = [n.node for n in scenario.nodes if n.node != scenario.feeder.source_node]
    lowest = lowest_node(step)
    key = "model_node"
    if st.session_state.get(key) not in nodes:
        st.session_state[key] = lowest

    def told(node: str) -> str:
        notes = [
            *(["lowest voltage"] if node == lowest else []),
            *(["the station's"] if node == scenario.station.node else []),
        ]
        return f"{node} ({', '.join(notes)})" if notes else node

    picked: str = st.selectbox(
        "Node",
        nodes,
        format_func=told,
        key=key,
        persist_state="session",
        help="Whose power and voltage stand in the equations of the feeder.",
    )
    return picked


def _card(card: Card, numbers: Numbers | None) -> None:
    with st.container(border=True, height="stretch"):
        with st.container(horizontal=True, vertical_alignment="center"):
            st.markdown(f"**{card.paper} {card.title}**")
            with st.popover(
                card.code.__name__, icon=":material/code:", type="tertiary", width="content"
            ):
                _code(card.code)
        st.latex(card.formula)
        if numbers is not None:
            tex, said = card.fill(numbers)
            if tex:
                st.latex(tex)
            st.markdown(said)


def _code(function: Callable[..., Any]) -> None:
    """Where a function stands, what it says of itself, and its text."""
    file = inspect.getsourcefile(function)
    where = Path(file).relative_to(IMPORTABLE_FROM).as_posix() if file else function.__module__
    st.markdown(f"`{where}` · `{function.__name__}`")
    st.caption(plain(inspect.getdoc(function) or ""))
    st.code(inspect.getsource(function), language="python")
