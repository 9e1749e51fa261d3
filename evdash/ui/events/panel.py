"""Let something happen now: choose it, read what it would break and what would help, apply it."""

import streamlit as st

from evdash.domain.events import Event
from evdash.domain.outlook import Outlook
from evdash.domain.trace import Trace
from evdash.errors import Fault, InputError
from evdash.horizon.happen import happen
from evdash.horizon.relief import relief
from evdash.ui.events.choices import CHOICES, Choice, checked, elements, event_of, vehicles
from evdash.ui.events.words import effect_told, events_told, remedies_told, short_rows
from evdash.ui.parts import small_table, view
from evdash.ui.session import Session
from evdash.ui.words import clock, plain

PREVIEW = "evdash_event"
TABLE_PX = 260


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
            _chooser(session, view(session))
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
        )
        said = _said(trace, ahead, CHOICES[kind])
        asked = st.button(
            "What would it do?", key="event_ask", icon=":material/search:", disabled=said is None
        )
    st.caption(CHOICES[kind].help)
    if said is None:
        st.info("No vehicle is under contract now.", icon=":material/info:")
    elif asked:
        _ask(trace, kind, said)


def _ask(trace: Trace, kind: str, said: dict[str, object]) -> None:
    """Remember what is to be looked at, or say what is wrong with it."""
    st.session_state.pop(PREVIEW, None)
    try:
        st.session_state[PREVIEW] = checked(trace, event_of(trace, kind, said))
    except (InputError, ValueError) as error:
        wrong = error.faults if isinstance(error, InputError) else ()
        _tell(wrong or (Fault("event", f"{error}", "should be possible"),))


def _tell(faults: tuple[Fault, ...]) -> None:
    told = "\n".join(f"- found {plain(f.found)}; {plain(f.allowed)}" for f in faults)
    st.error(f"**That cannot happen.**\n{told}", icon=":material/error:")


def _said(trace: Trace, ahead: Outlook, choice: Choice) -> dict[str, object] | None:
    """The fields of a choice as filled in; None where there is no vehicle it could be."""
    said: dict[str, object] = {}
    for field in choice.fields:
        if field == "vehicle":
            there = vehicles(trace)
            if not there:
                return None
            said["vehicle"] = st.selectbox("Vehicle", there, key="event_vehicle", width=140)
        elif field == "count":
            most = trace.scenario.station.chargers if choice.kind == "chargers_fail" else 1000
            label = f"How many of {most}" if choice.kind == "chargers_fail" else "How many"
            most = max(1, most)
            said["count"] = st.number_input(label, 1, most, 1, key="event_count", width=150)
        elif field == "element":
            said["element"], said["kva"] = _element(trace)
        elif field == "percent":
            said["percent"] = st.number_input(
                "Change, %", -100, 900, 20, 5, key="event_percent", width=120
            )
        elif field == "kwh":
            said["kwh"] = st.number_input(
                "More energy, kWh", 0.5, 1000.0, 5.0, 0.5, key="event_kwh", width=150
            )
        elif field != "kva":
            said |= _times(ahead, field)
    return said


def _element(trace: Trace) -> tuple[str | None, float]:
    rated = elements(trace.scenario)
    if not rated:
        st.caption("Nothing on this feeder has a rating.")
        return None, 0.0
    element = st.selectbox(
        "Which", list(rated), format_func=lambda one: rated[one][0], key="event_element", width=320
    )
    kva = st.number_input(
        "New rating, kVA",
        0.0,
        1e9,
        round(0.8 * rated[element][1], 1),
        10.0,
        format="%g",
        key=f"event_kva:{element}",
        width=150,
    )
    return element, kva


def _times(ahead: Outlook, field: str) -> dict[str, object]:
    """One or two times: from when, until when."""

    def when(label: str, intervals: list[int], index: int, key: str) -> int:
        chosen: int = st.selectbox(
            label,
            intervals,
            index,
            format_func=lambda t: clock(ahead.times[t], ahead),
            key=f"event_{key}:{ahead.now}",
            width=120,
        )
        return chosen

    later = list(range(ahead.now + 1, ahead.n_intervals + 1))
    if field == "until":
        return {"until": when("Leaves at", [ahead.now, *later[:-1]], 0, "leaves")}
    if field == "back":
        return {"back": when("Back at", later[:-1] or [ahead.now], 0, "back")}
    first = when("From", [ahead.now, *later[:-1]], 0, "from")
    after = [t for t in later if t > first]
    return {"from": first, "until": when("Until", after, len(after) - 1, f"until:{first}")}


def _preview(session: Session, ahead: Outlook) -> None:
    """What the event asked about would do, and whether it is to happen."""
    event: Event | None = st.session_state.get(PREVIEW)
    trace = session.run.trace
    if event is None or event.interval != trace.now:
        return
    with st.spinner("Working out what it would do …"):
        after = session.once("event", lambda: happen(trace, [event]), detail=event)
    happening = after.happenings[-1]
    told = f"**At {clock(ahead.clock, ahead)}, {events_told(happening.events)}.** "
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
                on_click=_apply,
                args=(session, event, trace, after),
            )
            st.button("Never mind", key="event_drop", on_click=_forget)


def _apply(session: Session, event: Event, before: Trace, after: Trace) -> None:
    session.happen(event, before, after)
    _forget()


def _forget() -> None:
    st.session_state.pop(PREVIEW, None)
