"""All that a finished day can be handed on as, beside what each file assumes."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from weakref import WeakKeyDictionary
from zoneinfo import available_timezones

import streamlit as st
from annotated_types import Ge, Le
from streamlit.delta_generator import DeltaGenerator

from evdash.charts.style import spans
from evdash.domain.trace import Trace
from evdash.errors import Fault, InputError
from evdash.files.draft import zipped
from evdash.files.numbers import number_text
from evdash.files.run_export import RunLabel, Verdict
from evdash.files.scenario_folder import scenario_files
from evdash.metrics.ageing import Thermal
from evdash.reports.account import Account, account, edited, transformers
from evdash.reports.html import report_html
from evdash.reports.network import network_json
from evdash.reports.ocpp import DEFAULT_ZONE, clock_note, profiles, profiles_zip
from evdash.reports.ocpp_limits import Current
from evdash.reports.words import EDITED
from evdash.reports.workbook import workbook_bytes
from evdash.ui.apart import apart
from evdash.ui.handon.checking import Checking
from evdash.ui.parts import view
from evdash.ui.session import Session
from evdash.ui.typed import ask_number
from evdash.ui.words import counted, file_stem, plain

KEY = "evdash:handon"
AMBIENT = "evdash:handon_ambient"
POLL_SECONDS = 0.5
SUPPLIES = (None, *(Current(*of) for of in ((1, 230.0), (3, 230.0), (1, 208.0), (1, 240.0))))
"""What outlets are usually connected to."""


@dataclass(frozen=True, slots=True)
class Wishes:
    """What is assumed in the files, as chosen beside them."""

    thermal: Thermal
    transformer: str
    zone: str
    current: Current | None
    interval: int


wished: WeakKeyDictionary[Checking, Wishes] = WeakKeyDictionary()
"""What was chosen last beside the files of a day."""


def body(session: Session) -> None:
    """All that a finished day can be handed on as, once it has been checked."""
    st.markdown("#### Hand this day on")
    if not session.run.trace.is_over:
        _finish_first(session)
        return
    check = _check_of(session.run.trace)
    waiting = not check.is_over
    apart(_body, POLL_SECONDS if waiting else None)(session, check, waiting=waiting)


def _finish_first(session: Session) -> None:
    trace = session.run.trace
    left = trace.scenario.intervals - trace.now
    st.markdown(
        f"A whole day is handed on, and {counted(left, 'interval')} of this one "
        f"{'is' if left == 1 else 'are'} still to be decided."
    )
    st.button(
        "Run to end first",
        key="handon_finish",
        type="primary",
        icon=":material/fast_forward:",
        on_click=session.set_mode,
        args=("finishing",),
    )


def _check_of(trace: Trace) -> Checking:
    """The check of this day, begun where there is none yet; another day's is let go."""
    check: Checking | None = st.session_state.get(KEY)
    if check is None or check.trace is not trace:
        if check is not None:
            check.cancel()
        check = Checking(trace)
        st.session_state[KEY] = check
    return check


def _body(session: Session, check: Checking, *, waiting: bool) -> None:
    with session.rest.broken():
        _stand(session, check, waiting=waiting)


def _stand(session: Session, check: Checking, *, waiting: bool) -> None:
    if waiting and check.is_over:
        st.rerun()  # so that nobody looks for its results any more
    elif check.verdict is not None:
        _files(session, check, check.verdict)
    elif waiting:
        _progress(check)
    else:
        st.warning(f"The day was not checked. {check.failure}", icon=":material/warning:")
        if st.button("Check again", key="handon_again"):
            del st.session_state[KEY]
            st.rerun()


def _progress(check: Checking) -> None:
    said = (
        "Waiting for somebody else's day …"
        if check.is_waiting
        else f"Checking every interval by AC power flow: {check.done:,} of {check.total:,} …"
    )
    st.progress(check.done / max(1, check.total), said)
    if st.button("Cancel", key="handon_cancel", icon=":material/stop:"):
        check.cancel()


def _files(session: Session, check: Checking, verdict: Verdict) -> None:
    trace = session.run.trace
    if edited(trace):
        st.warning(EDITED, icon=":material/edit_note:")
    wished[check] = _wishes(session)

    def wishes() -> Wishes:
        return wished[check]  # those of the moment of a click, which may follow upon another wish

    def tell() -> Account:
        return _account(trace, verdict, wishes())

    stem = file_stem(trace.scenario.name)
    scenario = partial(_scenario_zip, trace, stem)

    def ocpp() -> bytes:
        return profiles_zip(trace, wishes().zone, wishes().current)

    files: tuple[tuple[str, str, str, str, Callable[[], bytes]], ...] = (
        ("Report", "report.html", "text/html", REPORT, lambda: report_html(tell()).encode()),
        ("Workbook", "run.xlsx", XLSX, WORKBOOK, lambda: workbook_bytes(tell())),
        ("The run's files", "run.zip", ZIP, RUN, lambda: zipped(dict(tell().files), "run")),
        ("Scenario", "scenario.zip", ZIP, SCENARIO, scenario),
        ("OCPP profiles", "ocpp.zip", ZIP, OCPP, ocpp),
        (
            "pandapower network",
            "pandapower.json",
            "application/json",
            NETWORK,
            lambda: network_json(trace, wishes().interval).encode(),
        ),
    )
    for name, ending, kind, told, make in files:
        left, right = st.columns([1, 2.4], vertical_alignment="center")
        left.download_button(
            name,
            session.rest.then(make),
            f"{stem}-{ending}",
            kind,
            key=f"handon_{ending}",
            icon=":material/download:",
            on_click="ignore",
            width="stretch",
        )
        right.caption(told)


ZIP = "application/zip"
XLSX = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"
REPORT = (
    "One HTML page that needs nothing else, to read, print and keep: what went in, who was "
    "admitted and why not, all charts, what it did to the feeder, what it was made with."
)
WORKBOOK = "Excel, a sheet for every table, with units and notes in its heads."
RUN = "Tidy CSV tables and the scenario; unpacked, `python -m evdash audit run` checks them."
SCENARIO = "The day's inputs; taken in again on the Scenario page, or run on the command line."
OCPP = "The executed schedule, one OCPP 1.6 and 2.0.1 charging profile a vehicle, JSON."
NETWORK = "The feeder with the executed loads, every interval within; for `pandapower.from_json`."


def _wishes(session: Session) -> Wishes:
    """What the files assume, and where to change it."""
    trace, ahead = session.run.trace, view(session)
    words = spans(ahead)
    busiest = int(ahead.station_kw.argmax())
    names = list(transformers(trace.scenario))
    with st.expander("What the files assume", key="handon_assume", type="compact"):
        left, right = st.columns(2)
        transformer = left.selectbox(
            "The station's transformer",
            names,
            key="handon_transformer",
            help="Whose ageing by IEEE C57.91 the report tells; a scenario does not say which of "
            "its rated lines are transformers.",
            placeholder="No line has a rating",
            disabled=not names,
        )
        with right:
            ambient_c = _ambient_c()
        zone = left.selectbox(
            "Time zone of the day, for OCPP",
            sorted(available_timezones()),
            index=sorted(available_timezones()).index(DEFAULT_ZONE),
            key="handon_zone",
            help="The scenario's hours count in it; a charging profile carries them in UTC.",
        )
        interval = right.selectbox(
            "pandapower network loaded as at",
            range(len(words)),
            index=busiest,
            format_func=words.__getitem__,
            key="handon_interval",
            help="Loads, generation and the station as in this interval; it has the others, too.",
        )
        current = _current(trace, zone, left)
    return Wishes(Thermal(ambient_c=ambient_c), transformer or "", zone, current, interval)


def _current(trace: Trace, zone: str, place: DeltaGenerator) -> Current | None:
    """What outlets are connected to, for OCPP limits in A; None for W alone."""
    current = place.selectbox(
        "OCPP limits",
        SUPPLIES,
        format_func=lambda one: f"in W, and in A at {one.text}" if one else "in W",
        key="handon_current",
        help="What an outlet is connected to: as many phases, each at this voltage.",
    )
    try:
        if note := clock_note(trace.scenario, zone):
            st.caption(plain(note))
        if current is not None:
            profiles(trace, zone, current)
    except InputError as error:
        st.warning(plain(str(error)), icon=":material/warning:")
        return None
    return current


def _ambient_c() -> float:
    """The temperature typed, or the last that could be read; °C."""
    number = ask_number(
        "Temperature around it, °C",
        Thermal().ambient_c,
        "handon_ambient",
        (Ge(-50), Le(70)),
        "The same all day, for the transformer's ageing.",
    )
    if isinstance(number, Fault):
        held = float(st.session_state.get(AMBIENT, Thermal().ambient_c))
        st.caption(f"The files go on assuming {number_text(held)} °C.")
        return held
    st.session_state[AMBIENT] = number
    return float(number)


def _account(trace: Trace, verdict: Verdict, wishes: Wishes) -> Account:
    seed = trace.inputs.given.arrivals.seed
    seconds = sum(step.plan.report.seconds for step in trace.steps)
    label = RunLabel(trace.policy, trace.inputs.network, seed, seconds)
    return account(trace, verdict, label, thermal=wishes.thermal, transformer=wishes.transformer)


def _scenario_zip(trace: Trace, stem: str) -> bytes:
    return zipped(dict(scenario_files(trace.inputs.given)), stem)
