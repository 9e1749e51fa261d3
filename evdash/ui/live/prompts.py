"""What if: a teacher's prompts, a vehicle added by hand, prepared cases, and print."""

import streamlit as st
from annotated_types import Ge
from pydantic import ValidationError

from evdash.domain.arrivals import Arrival
from evdash.domain.trace import PAPERS
from evdash.errors import Fault, InputError
from evdash.horizon.guests import guest_name
from evdash.ui.apart import one_click
from evdash.ui.cases.case import Case, seen
from evdash.ui.cases.lecture import CASES
from evdash.ui.parts import small_table
from evdash.ui.session import Session, bundled, bundled_names
from evdash.ui.settings import help_text
from evdash.ui.telling import told_later
from evdash.ui.typed import ask_number
from evdash.ui.whatif import prompts
from evdash.ui.words import plain

CASE = "evdash:case"


def prompts_row(session: Session) -> None:
    """Every prompt a click away."""
    with st.container(key="prompts", horizontal=True, vertical_alignment="center", gap="xsmall"):
        st.markdown("**What if**", width="content")
        for prompt in session.once("prompts", lambda: prompts(session.run)):
            st.button(
                plain(prompt.label),
                on_click=one_click(session.press),
                args=(prompt.key,),
                key=f"prompt_{prompt.key}",
                help=f"{prompt.help} See before and after; Undo takes it back.",
                disabled=prompt.change is None or session.mode == "finishing",
            )
        if st.button(
            "Add a PEV now",
            key="add_pev",
            icon=":material/add:",
            disabled=session.run.trace.is_over,
            help="One more vehicle asks for a charge in the coming interval.",
        ):
            add_pev(session)
        if st.button("Cases", key="cases", icon=":material/school:", help=CASES_HELP):
            choose_case(session)


CASES_HELP = "Prepared for the lecture: a question each, what to press, what to see and why."


def outcome(session: Session) -> None:
    """What the last prompt did by the end of the day."""
    prompted = session.prompted
    if prompted is None:
        return
    with st.container(key="outcome", border=True):
        with st.container(horizontal=True, vertical_alignment="center"):
            st.markdown(prompted.told(session.run))
            st.button("Close", on_click=session.dismiss, key="dismiss", type="tertiary")
        with st.spinner("Running both days to their end …"):
            try:
                small_table(prompted.effects, height=320)
            except InputError as error:  # whoever decided is not there any more
                st.error(plain(str(error)))


@st.dialog("Add a PEV now")
def add_pev(session: Session) -> None:
    """Ask what the vehicle wants, and have it come."""
    scenario = session.run.trace.scenario
    fields = Arrival.model_fields
    with st.form("pev", border=False):
        option = st.radio(
            "Price option",
            [option.name for option in scenario.option],
            format_func=plain,
            horizontal=True,
            help=help_text(fields["option"]),
        )
        battery_kwh = ask_number(
            "Battery, kWh",
            60.0,
            "pev_battery",
            fields["battery_kwh"].metadata,
            help_text(fields["battery_kwh"]),
        )
        percents = st.slider(
            "Charge from … to, % of the battery", 0, 100, (30, 80), help=help_text(fields["soc_in"])
        )
        max_kw = ask_number("On-board charger, kW", 11.0, "pev_kw", (Ge(0.1),), MAX_KW_HELP)
        sent = st.form_submit_button("Ask for a charge", type="primary")
    if sent and not any(isinstance(number, Fault) for number in (battery_kwh, max_kw)):
        try:
            guest = Arrival(
                vehicle=guest_name(session.run.trace),
                arrival=scenario.time_of(session.run.trace.now),
                option=option,
                battery_kwh=battery_kwh,
                soc_in=percents[0] / 100,
                soc_out=percents[1] / 100,
                max_kw=max_kw,
            )
        except ValidationError as error:
            st.error("; ".join(plain(f"{e['loc'][0]}: {e['msg']}") for e in error.errors()))
            return
        session.visit(guest)
        if session.run.answer is None:
            st.toast(
                f"{plain(guest.vehicle)} asks for a charge in the coming interval: press Step."
            )
        st.rerun()


MAX_KW_HELP = "The most the vehicle itself can take."


@st.dialog("Prepared cases", width="large")
def choose_case(session: Session) -> None:
    """All cases with their questions; one of them is opened."""
    for number, case in enumerate(CASES):
        with st.container(border=True):
            st.markdown(f"**{case.question}**  \n{case.about}")
            if st.button(
                "Open this case",
                on_click=_open_case,
                args=(session, case),
                key=f"case_{number}",
                type="primary",
            ):
                st.rerun()


def _open_case(session: Session, case: Case) -> None:
    session.open(bundled_names()[case.preset])
    st.session_state[CASE] = case


def case_panel(session: Session) -> None:
    """The case that is being worked through."""
    case: Case | None = st.session_state.get(CASE)
    if case is None:
        return
    with st.container(key="case", border=True, gap="xsmall"):
        with st.container(horizontal=True, vertical_alignment="center"):
            st.markdown(f"#### {case.question}")
            st.button(
                "Close the case",
                on_click=lambda: st.session_state.pop(CASE, None),
                key="close_case",
                type="tertiary",
            )
        st.markdown("\n".join(f"{n}. {press.told}" for n, press in enumerate(case.press, 1)))
        day = bundled_names()[case.preset]
        if session.run.folder != day:
            st.caption(f":orange[Another day is open; this is asked on {bundled(day).name}.]")
        elif session.run.trace.policy != PAPERS:
            st.caption(":orange[Another policy decides; this is asked of the paper's P1.]")
        box = st.expander(
            SEE, type="compact", key=f"case_answer_{CASES.index(case)}", on_change="rerun"
        )
        if box.open:
            with box:
                told_later("case_told", case, "seen", lambda: seen(case))
                st.caption(SEEN_HELP)


SEE = "What to see, and why"
SEEN_HELP = "Worked out from this day with its own seed, everything pressed as told."
