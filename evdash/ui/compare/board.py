"""What is pinned: pin, rename, open, unpin, and run all of them to the end."""

import streamlit as st

from evdash.ui import run as runs
from evdash.ui.apart import one_click
from evdash.ui.compare.pins import (
    LONGEST_NAME,
    MOST_PINS,
    Held,
    Pin,
    Pins,
    held_together,
    is_alike,
    suggested_name,
)
from evdash.ui.session import Session
from evdash.ui.words import counted, plain

NAME = "pin_name"
INTRODUCTION = (
    "**Hold one run against another.** Pin the present run here, change something on "
    "**Live** or **Scenario**, run that day too, and come back: this page shows what the change "
    "did to admissions, money, load and voltages."
)
ALONE = (
    "One run alone has nothing to be compared with yet. Change something on **Live** or "
    "**Scenario**, or press one of its **What if**, and come back: both runs then stand side by "
    "side."
)


def pin_present(session: Session, pins: Pins) -> None:
    """A name and a button to pin the present run."""
    run = session.run
    pinned = any(is_alike(pin.run.trace, run.trace) for pin in pins.all)
    with st.container(horizontal=True, vertical_alignment="bottom", key="pin_present"):
        st.text_input(
            "Name for the present run",
            placeholder=suggested_name(run),
            max_chars=LONGEST_NAME,
            key=NAME,
            help="Left blank, it is called after its scenario and what was changed.",
            width=420,
        )
        st.button(
            "Pin the present run",
            on_click=one_click(_pin),
            args=(session, pins),
            key="pin",
            type="primary",
            icon=":material/keep:",
            disabled=pinned or pins.is_full,
            help="The run as it stands is kept, whatever you do next.",
        )
        if pinned:
            st.caption("The present run is pinned as it stands.")
        elif pins.is_full:
            st.caption(f"At most {MOST_PINS} runs can be pinned; unpin one first.")


def _pin(session: Session, pins: Pins) -> None:
    pins.add(str(st.session_state.get(NAME) or ""), session.run)
    pins.keep(session)  # before the page is drawn, so that its address leads back here
    st.session_state[NAME] = ""


def pinned(session: Session, pins: Pins) -> None:
    """A line for each pinned run."""
    if not pins.all:
        with st.container(key="compare_intro"):
            st.info(INTRODUCTION, icon=":material/compare_arrows:")
            st.button(
                "Show me: the same day with half the chargers",
                on_click=one_click(_example),
                args=(session, pins),
                key="example",
                icon=":material/play_arrow:",
                help="Pins the present run and runs its day again with half as many chargers.",
            )
    if pins.said:
        st.warning(plain(pins.said), icon=":material/save:")
    for pin in pins.all:
        _line(session, pins, pin)


def _example(session: Session, pins: Pins) -> None:
    pins.add("", session.run)
    pins.keep(session)
    half = session.run.trace.scenario.station.chargers // 2
    again = runs.restarted(session.run)
    session.take(runs.edited(again, "half the chargers", {"station.chargers": half}))
    pins.finishing = True


def _line(session: Session, pins: Pins, pin: Pin) -> None:
    trace = pin.run.trace
    key = f"rename:{pin.number}"
    if st.session_state.get(key) != pin.name:
        st.session_state[key] = pin.name
    row = st.container(horizontal=True, vertical_alignment="center", key=f"pin_{pin.number}")
    with row:
        st.text_input(
            "Name",
            key=key,
            max_chars=LONGEST_NAME,
            on_change=_rename,
            args=(pins, pin.number, key),
            label_visibility="collapsed",
            width=420,
        )
        progress = (
            "day over"
            if trace.is_over
            else f"{trace.now} of {counted(trace.scenario.intervals, 'interval')} decided"
        )
        st.caption(f"{plain(trace.scenario.name)} · {progress}", width=260)
        st.button(
            "Open",
            on_click=one_click(session.take),
            args=(pin.run,),
            key=f"open_{pin.number}",
            icon=":material/open_in_new:",
            disabled=is_alike(trace, session.run.trace),
            help="Make it the present run, shown on all pages. The pin stays.",
        )
        st.button(
            "Unpin",
            on_click=one_click(pins.remove),
            args=(pin.number,),
            key=f"unpin_{pin.number}",
            icon=":material/keep_off:",
            type="tertiary",
        )


def _rename(pins: Pins, number: int, key: str) -> None:
    pins.rename(number, str(st.session_state[key]))


def how_far(held: list[Held], pins: Pins) -> None:
    """Up to when runs are compared, what to do where there is but one, and a button to run all."""
    if pins.all and len(held) == 1:
        st.info(ALONE, icon=":material/compare_arrows:")
    if len({run.whole.now * run.scenario.interval_hours for run in held}) > 1:
        hour = held[0].scenario.time_of(held[0].common.now)
        st.warning(
            f"These runs have come to different hours. They are compared up to **{hour:%H:%M}**, "
            "which all of them have reached.",
            icon=":material/schedule:",
        )
    if any(not run.whole.is_over for run in held):
        st.button(
            "Stop" if pins.finishing else "Run all to the end",
            on_click=one_click(_set_finishing),
            args=(pins, not pins.finishing),
            key="finish_all",
            icon=":material/stop:" if pins.finishing else ":material/fast_forward:",
        )


def _set_finishing(pins: Pins, finishing: bool) -> None:
    pins.finishing = finishing


def _step(session: Session, pins: Pins, pin: Pin) -> None:
    """One more interval of a pin; the present run goes along where it is pinned as it stands."""
    together = is_alike(pin.run.trace, session.run.trace)
    pins.step(pin.number)
    if together:
        session.take(next(p.run for p in pins.all if p.number == pin.number))


def run_on(session: Session, pins: Pins) -> None:
    """Step whatever is not over, telling how far it is; a click stops between two steps."""
    if not pins.finishing:
        return
    bar, before = st.progress(0.0, "Running to the end …"), -1
    while pins.finishing:
        left = [pin for pin in pins.all if not pin.run.trace.is_over]
        held = held_together(session, pins)
        if left:
            _step(session, pins, left[0])
        elif not session.run.trace.is_over:
            session.step()
        else:
            pins.finishing = False
        decided = sum(run.whole.now for run in held)
        if decided == before:  # nobody there can decide what is left
            pins.finishing = False
        before = decided
        bar.progress(decided / sum(run.scenario.intervals for run in held), "Running to the end …")
    st.rerun()
