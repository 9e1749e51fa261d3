"""The sidebar: everything a person may change, always showing what is in force.

Widgets never own the truth. What was typed is compared with what was last shown; a
difference is an edit, and afterwards every widget shows the scenario again. That also holds
where a script run was aborted half-way: the difference is then found by the next one. The truth
is each widget's default, too: a browser that gets two script runs at once forgets what the first
had set, and would show, and hand in, blanks.
"""

from collections.abc import Mapping, MutableMapping
from typing import Any

import streamlit as st

from evdash.domain.outlook import Outlook
from evdash.errors import Fault
from evdash.files.numbers import number_text
from evdash.files.wording import beyond
from evdash.policies.race import SLOW
from evdash.policies.registry import choices
from evdash.ui.apart import one_click
from evdash.ui.curves import CURVES, curve_prices, curve_title
from evdash.ui.live.prices import price_editor, refused_prices, take_prices
from evdash.ui.session import PRESET, Session, bundled, bundled_names
from evdash.ui.settings import (
    NETWORK_NAMES,
    Control,
    all_controls,
    arrival_controls,
    charger_control,
    edit_log,
    help_text,
    option_controls,
    price_field,
    setting_labels,
)
from evdash.ui.typed import refuse
from evdash.ui.words import plain

CURVE, NETWORK, DECIDER = "price_curve", "network", "decider"
OWN = ""
"""Stands among the presets for a scenario of the user's own."""
NETWORK_HELP = (
    "The model of the feeder whose limits the schedule keeps. Linearised DistFlow, as in the "
    "paper, leaves out losses and so allows too much where the feeder is loaded; full AC power "
    "flow counts them."
)
DECIDER_HELP = (
    "Who says yes or no and plans the charging: the paper's problem P1, another policy, or one "
    "that an installed package offers. Another one decides the day from its start, with the "
    "settings as they are now; Undo brings back the hours decided before. Compare races them all."
)


def take_edits(session: Session) -> bool:
    """Apply what was typed since the widgets were last shown, then show the truth again.

    Whether all of it could be applied. A text that is no number, or none that is allowed, stays in
    its field, and what was in force stays so.
    """
    state = st.session_state
    new = {
        key: state[key]
        for key in session.shown
        if key in state and state[key] is not None and state[key] != session.shown[key]
    }
    before = session.run
    taken = take_prices(session)
    if PRESET in new and new[PRESET] != OWN:
        session.refused.clear()
        session.price_refused.clear()
        session.open(bundled_names()[new[PRESET]])
        new = {}
    if NETWORK in new:
        session.rewire(new.pop(NETWORK))
    if DECIDER in new:
        session.hand_to(new.pop(DECIDER))
    if CURVE in new:
        take_curve(session, new.pop(CURVE))
    taken = _take_numbers(session, new) and taken
    answered = session.run is not before and session.run.answer is not None
    show_truth(session, state)
    return taken and not answered


def _take_numbers(session: Session, new: Mapping[str, object]) -> bool:
    scenario = session.run.trace.scenario
    read = {c.key: c.read(str(new[c.key])) for c in all_controls(scenario) if c.key in new}
    for key in read:
        session.refused.pop(key, None)
    wrong = [key for key, number in read.items() if isinstance(number, Fault)]
    session.refused |= {key: str(new[key]) for key in wrong}
    truth = {c.key: c.value for c in all_controls(scenario)}
    settings = {
        key: number
        for key, number in read.items()
        if not isinstance(number, Fault) and number != truth[key]
    }
    if settings:
        labels = setting_labels(scenario)
        title = ", ".join(f"{plain(labels[key])} {number:g}" for key, number in settings.items())
        session.edit(title, settings)
    return not wrong


def take_curve(session: Session, curve: str) -> None:
    """Put the prices of a bundled scenario in force from now on."""
    session.edit(curve_title(curve), {}, curve_prices(session.run.trace, curve))


def show_truth(session: Session, state: MutableMapping[Any, Any]) -> None:
    """Set every widget to what is in force, unless it shows it already."""
    controls = all_controls(session.run.trace.scenario)
    truth: dict[str, object] = {
        c.key: session.refused.get(c.key, number_text(c.value)) for c in controls
    }
    truth[PRESET] = session.run.folder.name if session.run.folder else OWN
    truth[NETWORK] = session.run.trace.inputs.network
    truth[DECIDER] = session.run.trace.policy
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
        _pair(session, arrival_controls(scenario))
        _number(session, charger_control(scenario))
        _refusal(session, charger_control(scenario))
        for name, price, rate in option_controls(scenario):
            _pair(session, [price, rate], prefix=f"{plain(name)} ")
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
        refused_prices(session, outlook)
        _decider(session)
        _in_force(session, outlook)


def _decider(session: Session) -> None:
    """Who decides; one who is not there any more stands as it is called."""
    rules = {name: rule.title for name, rule in choices().items() if name not in SLOW}
    names = rules | {name: name for name in [session.run.trace.policy] if name not in rules}
    st.selectbox(
        "Who decides",
        list(names),
        format_func=names.__getitem__,
        key=DECIDER,
        help=DECIDER_HELP,
    )


def _pair(session: Session, controls: list[Control], prefix: str = "") -> None:
    if controls:
        for column, one in zip(st.columns(2, gap="xsmall"), controls, strict=True):
            with column:
                _number(session, one, prefix)
        for one in controls:
            _refusal(session, one, prefix)


def _number(session: Session, control: Control, prefix: str = "") -> None:
    """A field of text; for counts with a step down and up, which look as if they were in it."""
    key = control.key
    with st.container(key=f"typed-{key.replace('.', '-')}"):
        st.text_input(
            prefix + control.label,
            str(session.shown[key]),
            key=key,
            help=f"{control.help}{'' if control.is_count else ' With a point for decimals.'}",
        )
        if control.is_count:
            with st.container(key=f"steps-{key.replace('.', '-')}", horizontal=True, gap=None):
                for by, sign in ((-1, "−"), (1, "\\+")):
                    st.button(
                        sign,
                        on_click=one_click(_nudge),
                        args=(session, key, by),
                        key=f"{key}:{by:+d}",
                        type="tertiary",
                        disabled=bool(beyond(control.value + by, control.marks)),
                        help=f"{'One more' if by > 0 else 'One less'}: {control.label}.",
                    )


def _nudge(session: Session, key: str, by: int) -> None:
    now = next(c.value for c in all_controls(session.run.trace.scenario) if c.key == key)
    st.session_state[key] = number_text(now + by)
    take_edits(session)


def _refusal(session: Session, control: Control, prefix: str = "") -> None:
    """What is wrong with what was typed, beside what is in force."""
    text = session.refused.get(control.key)
    wrong = None if text is None else control.read(text)
    if isinstance(wrong, Fault):
        held = f"{prefix}{control.label} stays {number_text(control.value)}."
        refuse(wrong, held)


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
