"""The clock, and the buttons that move the run: the same on every page that shows a run."""

import streamlit as st

from evdash.ui.apart import one_click
from evdash.ui.handon.popover import hand_on
from evdash.ui.parts import view
from evdash.ui.session import Session
from evdash.ui.settings import settings_told
from evdash.ui.words import counted


def toolbar(session: Session) -> None:
    """The clock; step, run, play, back, reset; on paper, which run this is."""
    trace, ahead = session.run.trace, view(session)
    with st.container(key="on_paper"):
        st.markdown(session.once("on_paper", lambda: settings_told(trace)))
    with st.container(key="toolbar", horizontal=True, vertical_alignment="center", gap="xsmall"):
        with st.container(key="clock", width=116):
            st.markdown(f"{ahead.clock:%H:%M}")
        step_button(session)
        _modes(session)
        st.button(
            "Back",
            on_click=one_click(session.back),
            key="back",
            icon=":material/skip_previous:",
            disabled=not trace.steps,
            help="Undo the last step, and changes made since.",
        )
        st.button(
            "Undo",
            on_click=one_click(session.undo),
            key="undo",
            icon=":material/undo:",
            disabled=not session.can_undo,
            help="Take back the last change, whatever it was: a step, a setting, a reset.",
        )
        st.button(
            "Reset",
            on_click=one_click(session.reset),
            key="reset",
            icon=":material/restart_alt:",
            disabled=not trace.steps,
            help="Back to the start of the day, with the settings as they are now.",
        )
        hand_on(session)
        date = f"{ahead.clock:%d %b} · " if ahead.crosses_midnight else ""
        st.caption(
            f"{date}{trace.now} of {counted(ahead.n_intervals, 'interval')}",
            text_alignment="right",
            help=f"{ahead.clock:%A, %d %B}: {trace.now} of "
            f"{counted(ahead.n_intervals, 'interval')} decided. {LINK_HELP}",
        )
    if session.keeper.said:
        st.caption(f":orange[:material/link_off: {session.keeper.said}]")


LINK_HELP = (
    "The run is kept after every change. This page's address brings it back, also on another day "
    "or after the server was started anew."
)


def step_button(session: Session, key: str = "step") -> None:
    """Decide the next interval."""
    trace = session.run.trace
    minutes = trace.scenario.interval_minutes
    st.button(
        f"Step {'1 h' if minutes == 60 else f'{minutes} min'}",
        on_click=one_click(session.step),
        key=key,
        type="primary",
        icon=":material/skip_next:",
        disabled=trace.is_over or session.mode == "finishing",
    )


def _modes(session: Session) -> None:
    """Buttons that set a run going, and stop it."""
    over, mode = session.run.trace.is_over, session.mode
    finishing, playing = mode == "finishing", mode == "playing"
    st.button(
        "Stop" if finishing else "Run to end",
        on_click=one_click(session.set_mode),
        args=("idle" if finishing else "finishing",),
        key="finish",
        icon=":material/stop:" if finishing else ":material/fast_forward:",
        disabled=over,
    )
    st.button(
        "Pause" if playing else "Play",
        on_click=one_click(session.set_mode),
        args=("idle" if playing else "playing",),
        key="play",
        icon=":material/pause:" if playing else ":material/play_arrow:",
        disabled=over or finishing,
    )
