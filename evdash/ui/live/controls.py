"""The sidebar: everything a person may change, always showing what is in force.

Widgets never own the truth. What was typed is compared with what was last shown; a
difference is an edit, and afterwards every widget shows the scenario again. That also holds
where a script run was aborted half-way: the difference is then found by the next one. The truth
is each widget's default, too: a browser that gets two script runs at once forgets what the first
had set, and would show, and hand in, the lowest number there is.
"""

from collections.abc import MutableMapping
from typing import Any

import streamlit as st

from evdash.domain.outlook import Outlook
from evdash.ui.apart import one_click
from evdash.ui.curves import CURVES, curve_prices, curve_title
from evdash.ui.session import PRESET, Session, bundled, bundled_names
from evdash.ui.settings import (
    NETWORK_NAMES,
    Control,
    all_controls,
    arrival_controls,
    bounds,
    charger_control,
    edit_log,
    help_text,
    option_controls,
    price_field,
    setting_labels,
)
from evdash.ui.words import clock, plain

CURVE, NETWORK = "price_curve", "network"
OWN = ""
"""Stands among the presets for a scenario of the user's own."""
NETWORK_HELP = (
    "The model of the feeder whose limits the schedule keeps. Linearised DistFlow, as in the "
    "paper, leaves out losses and so allows too much where the feeder is loaded; full AC power "
    "flow counts them."
)
PRICE_COLUMN = "Price, $/kWh"


def take_edits(session: Session) -> None:
    """Apply what was typed since the widgets were last shown, then show the truth again."""
    typed = {key: st.session_state[key] for key in session.shown if key in st.session_state}
    new = {
        key: value
        for key, value in typed.items()
        if value is not None and value != session.shown[key]
    }
    if PRESET in new and new[PRESET] != OWN:
        session.open(bundled_names()[new[PRESET]])
        new = {}
    if NETWORK in new:
        session.rewire(new.pop(NETWORK))
    if CURVE in new:
        take_curve(session, new.pop(CURVE))
    settings = {c.key: c for c in all_controls(session.run.trace.scenario) if c.key in new}
    if settings:
        labels = setting_labels(session.run.trace.scenario)
        title = ", ".join(f"{plain(labels[key])} {new[key]:g}" for key in settings)
        session.edit(title, {key: new[key] for key in settings})
    show_truth(session, st.session_state)


def take_curve(session: Session, curve: str) -> None:
    """Put the prices of a bundled scenario in force from now on."""
    session.edit(curve_title(curve), {}, curve_prices(session.run.trace, curve))


def show_truth(session: Session, state: MutableMapping[Any, Any]) -> None:
    """Set every widget to what is in force, unless it shows it already."""
    truth: dict[str, object] = {c.key: c.value for c in all_controls(session.run.trace.scenario)}
    truth[PRESET] = session.run.folder.name if session.run.folder else OWN
    truth[NETWORK] = session.run.trace.inputs.network
    truth[CURVE] = session.once("curve", lambda: curve_in_force(session))
    for key, value in truth.items():
        if key not in state or state[key] != value:
            state[key] = value
        session.shown[key] = value
    for key in set(session.shown) - set(truth):
        del session.shown[key]


def curve_in_force(session: Session) -> str | None:
    """The bundled price curve in force from now on, if it is one."""
    trace = session.run.trace
    prices = tuple(trace.scenario.price_per_kwh.tolist())
    for name in CURVES:
        if curve_prices(trace, name) == prices:
            return name
    return None


def sidebar(session: Session, outlook: Outlook) -> None:
    """All controls, and what was changed since when."""
    scenario = session.run.trace.scenario
    with st.sidebar, st.container(gap="xsmall"):
        names = {name: bundled(folder).name for name, folder in bundled_names().items()}
        if session.run.folder is None:
            # told apart from a preset of the same name: a browser answers with what it shows
            names = {OWN: f"{session.run.opened.name} (your own)"} | names
        st.selectbox(
            "Preset",
            list(names),
            format_func=names.__getitem__,
            key=PRESET,
            help="A day that is ready to be stepped. Another one begins anew; Undo brings back "
            "this one with all its hours.",
        )
        _pair(arrival_controls(scenario))
        _number(charger_control(scenario))
        for name, price, rate in option_controls(scenario):
            _pair([price, rate], prefix=f"{plain(name)} ")
        st.segmented_control(
            "Energy price",
            list(CURVES),
            default=session.shown[CURVE],
            key=CURVE,
            help=help_text(price_field()),
            width="stretch",
        )
        st.segmented_control(
            "Limits kept in",
            list(NETWORK_NAMES),
            format_func=NETWORK_NAMES.__getitem__,
            default=session.shown[NETWORK],
            key=NETWORK,
            help=NETWORK_HELP,
            width="stretch",
        )
        box = st.popover(
            "Edit prices by the hour",
            icon=":material/edit:",
            width="stretch",
            key="prices_by_hour",
            on_change="rerun",
        )
        if box.open:
            with box:
                price_editor(session, outlook)
        _in_force(session, outlook)


def _pair(controls: list[Control], prefix: str = "") -> None:
    if controls:
        for column, one in zip(st.columns(2, gap="xsmall"), controls, strict=True):
            with column:
                _number(one, prefix)


def _number(control: Control, prefix: str = "") -> None:
    st.number_input(
        prefix + control.label,
        min_value=control.low,
        max_value=control.high,
        value=control.value,
        step=control.step,
        format="%d" if control.is_count else "%g",
        key=control.key,
        help=control.help,
    )


def price_editor(session: Session, outlook: Outlook) -> None:
    """Energy prices still to come as a table; an edit counts at once.

    The editor keeps only differences to the table it was given, so that stays the same
    until prices change elsewhere, or an edit is refused, and then the editor begins anew.
    """
    # half a second that the first page is not to wait for
    import pandas as pd  # noqa: PLC0415

    trace = session.run.trace
    first = 0 if trace.is_over else trace.now
    prices = tuple(trace.scenario.price_per_kwh[first:].tolist())
    if prices != session.price_latest:
        session.price_base = session.price_latest = prices
        session.price_revision += 1
    times = [clock(moment, outlook) for moment in outlook.times[first:-1]]
    st.caption("Applies to the next run." if trace.is_over else "Hours already decided are fixed.")
    low, high = bounds(price_field())
    table = st.data_editor(
        pd.DataFrame({"From": times, PRICE_COLUMN: session.price_base}),
        key=f"prices:{session.price_revision}",
        hide_index=True,
        disabled=["From"],
        height=420,
        column_config={
            PRICE_COLUMN: st.column_config.NumberColumn(
                help=help_text(price_field()),
                min_value=low,
                max_value=high,
                format="%.4f",
                required=True,
            )
        },
        alt="Energy price of every interval still to come, editable",
    )
    edited = tuple(float(price) for price in table[PRICE_COLUMN])
    if edited != session.price_latest:
        session.price_latest = edited
        past = tuple(trace.scenario.price_per_kwh[:first].tolist())
        session.edit("the edited energy prices", {}, (*past, *edited))
        st.rerun()


def _in_force(session: Session, outlook: Outlook) -> None:
    run = session.run
    log = session.once("log", lambda: edit_log(run.trace, run.opened, outlook))
    if log:
        st.caption("**Changed from the preset**  \n" + "  \n".join(log))
        st.button(
            "Restore the preset's settings",
            on_click=one_click(session.restore),
            key="restore",
            type="tertiary",
            icon=":material/undo:",
            help="From now on; what is already decided stays.",
        )
