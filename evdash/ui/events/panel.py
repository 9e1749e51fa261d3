"""Let something happen now: choose it, read what it would break and what would help, apply it."""

import streamlit as st
from annotated_types import Ge, Le

from evdash.domain.events import Event
from evdash.domain.fields import LARGE
from evdash.domain.outlook import Outlook
from evdash.domain.trace import Trace
from evdash.errors import Fault, InputError
from evdash.horizon.happen import happen
from evdash.horizon.relief import relief
from evdash.policies.registry import described
from evdash.ui.apart import one_click
from evdash.ui.events.choices import CHOICES, Choice, checked, contracts, elements, event_of
from evdash.ui.events.words import (
    contract_told,
    effect_told,
    events_told,
    remedies_told,
    short_rows,
)
from evdash.ui.parts import small_table, view
from evdash.ui.session import Session
from evdash.ui.typed import ask_number
from evdash.ui.words import clock, plain

PREVIEW = "evdash_event"
TABLE_PX = 260
BEYOND_LIMITS = (
    "Whoever decides keeps no limit. What an event leaves of every promise is worked out within "
    "the limits all the same, so that promises may go short for these alone."
)
NOBODY = {
    "vehicle": "No vehicle is under contract now.",
    "element": "Nothing on this feeder has a rating that could change.",
    "count": "No charger is working.",
}
"""Why a choice cannot be made, by what it is about."""


def panel(session: Session) -> None:
    """Something happens, closed until somebody wants it to."""
    trace = session.run.trace
    if trace.is_over:
        return
    box = st.expander(
        "Something happens: a charger fails, a vehicle leaves early, …",
        key="events",
        type="compact",
        icon=":material/bolt:",
        on_change="rerun",
    )
    if box.open:
        with box:
            if not described(trace.policy).keeps_limits:
                st.caption(f":orange[{BEYOND_LIMITS}]")
            _chooser(session, view(session))
            _happened(trace, view(session))
            _preview(session, view(session))


def _chooser(session: Session, ahead: Outlook) -> None:
    """What happens, to whom, how much."""
    trace = session.run.trace
    with st.container(horizontal=True, vertical_alignment="bottom", gap="small"):
        kind = st.selectbox(
            f"At {clock(ahead.clock, ahead)}",
            list(CHOICES),
            format_func=lambda one: CHOICES[one].label,
            key="event_kind",
            width=330,
            help="What happens at this hour. Nothing is changed before you have seen what it would "
            "do and applied it.",
        )
        said = _said(trace, ahead, CHOICES[kind])
        asked = st.button(
            "What would it do?", key="event_ask", icon=":material/search:", disabled=said is None
        )
    st.caption(CHOICES[kind].help)
    if said is None:
        st.info(NOBODY[CHOICES[kind].fields[0]], icon=":material/info:")
    elif asked:
        _ask(trace, kind, said)


def _happened(trace: Trace, ahead: Outlook) -> None:
    """What has been let happen in this interval, so that it is not done twice."""
    for happening in trace.happenings:
        if happening.interval == trace.now:
            told = f"{events_told(happening.events, ahead)}. {effect_told(happening)}"
            st.markdown(f":material/check: Has happened at {clock(ahead.clock, ahead)}: {told}")


def _ask(trace: Trace, kind: str, said: dict[str, object]) -> None:
    """Remember what is to be looked at, or say what is wrong with it."""
    st.session_state.pop(PREVIEW, None)
    if refused := tuple(field for field in said.values() if isinstance(field, Fault)):
        _tell(refused)
        return
    try:
        st.session_state[PREVIEW] = checked(trace, event_of(trace, kind, said))
    except (InputError, ValueError) as error:
        wrong = error.faults if isinstance(error, InputError) else ()
        _tell(wrong or (Fault("event", f"{error}", "should be possible"),))


def _tell(faults: tuple[Fault, ...]) -> None:
    told = "\n".join(f"- found {plain(f.found)}; {plain(f.allowed)}" for f in faults)
    st.error(f"**That cannot happen.**\n{told}", icon=":material/error:")


def _said(trace: Trace, ahead: Outlook, choice: Choice) -> dict[str, object] | None:
    """The fields of a choice as filled in; None where there is nothing it could happen to."""
    about, *_ = choice.fields
    if about == "vehicle":
        return _of_a_vehicle(trace, ahead, choice)
    if about == "element":
        return _element(trace)
    if about == "count":
        return _count(trace, choice)
    change = ask_number(
        "Change, %",
        20,
        "event_percent",
        (Ge(-100), Le(900)),
        "Of every value in the hours chosen: 20 makes it a fifth more, -100 nothing.",
        width=120,
    )
    return {"percent": change} | _span(ahead)


def _count(trace: Trace, choice: Choice) -> dict[str, object] | None:
    """How many chargers."""
    most, label = 1000, "How many"
    if choice.kind == "chargers_fail":
        most = trace.scenario.station.chargers
        label = f"How many of {most}"
    if not most:
        return None
    count = ask_number(
        label,
        1,
        "event_count",
        (Ge(1), Le(most)),
        "Chargers from this hour on.",
        whole=True,
        width=150,
    )
    return {"count": count}


def _of_a_vehicle(trace: Trace, ahead: Outlook, choice: Choice) -> dict[str, object] | None:
    """Which vehicle under contract, and how much, until when or from when."""
    there = contracts(trace)
    if not there:
        return None
    vehicle = st.selectbox(
        "Vehicle",
        list(there),
        format_func=lambda name: contract_told(there[name], ahead),
        key="event_vehicle",
        width=340,
        help="Those under contract who do not yet have all they were promised.",
    )
    said: dict[str, object] = {"vehicle": vehicle}
    last = there[vehicle].request.deadline_interval
    later = list(range(ahead.now + 1, last + 1))
    if "kwh" in choice.fields:
        said["kwh"] = ask_number(
            "More energy, kWh",
            5.0,
            "event_kwh",
            (Ge(0.5), Le(1000)),
            "From the grid, beside what was promised; granted as far as every promise leaves room.",
            width=150,
        )
    if "until" in choice.fields:
        said["until"] = _when(ahead, "Leaves at", [ahead.now, *later[:-1]], 0, f"leaves:{vehicle}")
    if "back" in choice.fields:
        back = [t for t in later if t < ahead.n_intervals] or [ahead.now]
        said["back"] = _when(ahead, "Back at", back, 0, f"back:{vehicle}")
    return said


def _element(trace: Trace) -> dict[str, object] | None:
    """Which line, transformer or node, and its new rating."""
    rated = elements(trace.scenario)
    if not rated:
        return None
    element = st.selectbox(
        "Which",
        list(rated),
        format_func=lambda one: rated[one][0],
        key="event_element",
        width=320,
        help="Lines, transformers and nodes that have a rating.",
    )
    kva = ask_number(
        "New rating, kVA",
        round(0.8 * rated[element][1], 1),
        f"event_kva:{element}",
        (Ge(0), Le(LARGE)),
        "The apparent power it may carry from this hour on.",
        width=150,
    )
    return {"element": element, "kva": kva}


def _when(ahead: Outlook, label: str, intervals: list[int], index: int, key: str) -> int:
    """One of several times."""
    chosen: int = st.selectbox(
        label,
        intervals,
        index,
        format_func=lambda t: clock(ahead.times[t], ahead),
        key=f"event_{key}:{ahead.now}",
        width=120,
        help="At the beginning of an interval.",
    )
    return chosen


def _span(ahead: Outlook) -> dict[str, object]:
    """From when, until when."""
    later = list(range(ahead.now + 1, ahead.n_intervals + 1))
    first = _when(ahead, "From", [ahead.now, *later[:-1]], 0, "from")
    after = [t for t in later if t > first]
    return {"from": first, "until": _when(ahead, "Until", after, len(after) - 1, f"until:{first}")}


def _preview(session: Session, ahead: Outlook) -> None:
    """What the event asked about would do, and whether it is to happen."""
    event: Event | None = st.session_state.get(PREVIEW)
    trace = session.run.trace
    if event is None or event.interval != trace.now:
        return
    with st.spinner("Working out what it would do …"):
        after = session.once("event", lambda: happen(trace, [event]), detail=event)
    happening = after.happenings[-1]
    told = f"**At {clock(ahead.clock, ahead)}, {events_told(happening.events, ahead)}.** "
    rows = short_rows(happening, ahead)
    with st.container(key="event_effect"):
        if rows:
            st.warning(told + effect_told(happening), icon=":material/warning:")
            small_table(rows, TABLE_PX)
            with st.spinner("Looking for remedies …"):
                found = session.once("relief", lambda: relief(after), detail=event)
            st.markdown(remedies_told(found, trace.scenario.interval_hours))
        else:
            st.info(told + effect_told(happening), icon=":material/check:")
        with st.container(horizontal=True):
            st.button(
                "Let it happen",
                key="event_apply",
                type="primary",
                icon=":material/bolt:",
                on_click=one_click(_apply),
                args=(session, event, trace, after),
            )
            st.button("Never mind", key="event_drop", on_click=_forget)


def _apply(session: Session, event: Event, before: Trace, after: Trace) -> None:
    session.happen(event, before, after)
    _forget()


def _forget() -> None:
    st.session_state.pop(PREVIEW, None)
