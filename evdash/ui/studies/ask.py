"""Asking: a ready-made question or axes of one's own, what it will take, and the start."""

import re
from collections.abc import Sequence

import streamlit as st
from annotated_types import Ge, Le

from evdash.domain.digest import digest
from evdash.domain.scenario import Scenario
from evdash.domain.study import Axis, Seeds, Study, StudyRuns
from evdash.errors import Fault, InputError
from evdash.files.nested import read_toml
from evdash.files.wording import shown
from evdash.policies.registry import choices, described
from evdash.studies.background import spare_cores
from evdash.studies.estimate import seconds_needed
from evdash.studies.folder import StudyFolder, study_text
from evdash.studies.keys import STUDY_KEYS
from evdash.studies.questions import QUESTIONS, sure
from evdash.studies.reading import lay_out, parse_study
from evdash.studies.shelf import Shelf
from evdash.ui.apart import apart
from evdash.ui.scenario.editor import present_scenario
from evdash.ui.session import Session
from evdash.ui.settings import NETWORK_NAMES
from evdash.ui.studies.refusal import refusals, show_refusal
from evdash.ui.studies.words import duration
from evdash.ui.typed import ask_number, refuse
from evdash.ui.visitors import visitor
from evdash.ui.words import counted, plain

OWN = "own"
OFTEN = (
    "station.chargers",
    "station.node",
    "station.max_kw",
    "arrivals.vehicles_per_day",
    "feeder.load_scale",
    "feeder.source_voltage_pu",
    "price.spread",
    "price.factor",
    "tariff.factor",
    "voltage.band_pu",
)
CHOSEN = "study_chosen"
LOOK_SECONDS = 1.0
LONG_SECONDS = 3600.0
COMMA_WITHIN = re.compile(r"\d+,\d+")
FILE_HELP = (
    "A study is one small file: what is varied, over how many days, what is told of them. Edited "
    "here, it is what will be run; saved, it runs on the command line: "
    "`python -m evdash study FILE.toml --out DIR`."
)


def ask(session: Session, shelf: Shelf) -> None:
    """The question, its settings, what it will take, and the button that starts it."""
    scenario = present_scenario(session)
    titles = {name: question.title for name, question in QUESTIONS.items()}
    titles[OWN] = "My own axes"
    name = st.selectbox(
        "Question",
        list(titles),
        format_func=titles.__getitem__,
        key="question",
        persist_state="session",
        help="What is varied, and what is told of it. All that follows can be changed.",
    )
    told = "Vary what you like." if name == OWN else QUESTIONS[name].told
    st.caption(f"{told} The day is the present run's: **{plain(scenario.name)}**.")
    try:
        study = _edited(_settings(name, scenario))
        runs = lay_out(study, scenario)
    except InputError as error:
        _faults(error.faults)
        runs = None
    _start(shelf, runs)


def _settings(name: str, scenario: Scenario) -> Study:
    """The question's study with what a person changed about it; raises InputError."""
    study = _own(scenario) if name == OWN else QUESTIONS[name].study(scenario)
    wrong: list[Fault] = []
    axes = [_values(name, n, axis, wrong) for n, axis in enumerate(study.axis)]
    left, right = st.columns(2)
    changes: dict[str, object] = {"axis": tuple(axes)}
    if study.seeds is not None:
        with left:
            days = ask_number(
                "Days at every point",
                study.seeds.count,
                f"study_days_{name}",
                (Ge(1), Le(1000)),
                "Each is a draw of its own of who arrives, the same ones at every point.",
                whole=True,
            )
        wrong += [days] if isinstance(days, Fault) else []
        changes["seeds"] = study.seeds if isinstance(days, Fault) else Seeds(count=days)
    networks = right.multiselect(
        "Network models",
        list(NETWORK_NAMES),
        list(study.networks),
        format_func=NETWORK_NAMES.__getitem__,
        key=f"study_networks_{name}",
        help="Whose limits are kept: linearised DistFlow, as in the paper, or full AC power flow. "
        "With both, every point is run under each.",
    )
    policies = st.multiselect(
        "Who decides",
        list(choices()),
        list(study.policies),
        format_func=lambda rule: described(rule).title,
        key=f"study_policies_{name}",
        help="The rules by which vehicles are admitted and charged. With several, each decides "
        "the very same days.",
    )
    wrong += [
        Fault(place, "nothing", "should have at least one")
        for place, chosen in (("Network models", networks), ("Who decides", policies))
        if not chosen
    ]
    if wrong:
        raise InputError(wrong)
    return study.model_copy(
        update=changes | {"networks": tuple(networks), "policies": tuple(policies)}
    )


def _values(name: str, number: int, axis: Axis, wrong: list[Fault]) -> Axis:
    """An axis with its values as they stand in a text field; cases and all nodes stay.

    What is wrong with them goes to `wrong`.
    """
    if axis.case or isinstance(axis.values, str):
        return axis
    text = st.text_input(
        f"{plain(axis.title)}: values, separated by commas",
        ", ".join(f"{value}" for value in axis.values),
        key=f"study_values_{name}_{number}_{axis.key}",
        help=f"The days are run once for each of these values of {plain(axis.title)}.",
    )
    try:
        return axis.model_copy(update={"values": read_values(text)})
    except ValueError as error:
        fault = Fault(f"{axis.title}: values", shown(text), str(error))
        wrong.append(fault)
        refuse(fault)
        return axis


def read_values(text: str) -> tuple[object, ...]:
    """Values as typed: each a number where it reads as one, or else text.

    ValueError where a comma stands between two digits: `0,3` may be one value, and may be two.
    """
    if glued := COMMA_WITHIN.search(text):
        one, two = glued[0].replace(",", "."), glued[0].replace(",", ", ")
        rule = f"should be {one} with a point if that is one value, {two} with a blank if several"
        raise ValueError(rule)
    values: list[object] = []
    for part in (part.strip() for part in text.split(",")):
        if part:
            try:
                read = read_toml(f"value = {part}")
            except ValueError:
                read = {}
            values.append(read["value"] if list(read) == ["value"] else part)
    return tuple(values)


def _own(scenario: Scenario) -> Study:
    """Up to two axes put together by hand."""
    keys = [*OFTEN, *_ratings(scenario)]
    axes = []
    for n, first in enumerate((OFTEN[0], "")):
        key = st.selectbox(
            "Vary" if n == 0 else "And",
            keys if n == 0 else ["", *keys],
            index=keys.index(first) if first else 0,
            format_func=lambda key: key or "nothing else",
            key=f"own_key_{n}",
            accept_new_options=True,
            help="A key of the scenario, as on the Scenario page's file, or one of "
            + ", ".join(known.form for known in STUDY_KEYS.values())
            + ". Any other key can be typed.",
        )
        if key:
            value = "all" if key == "station.node" else (_present(scenario, key),)
            axes.append(Axis(key=key, values=value))
    return sure(scenario).model_copy(
        update={"name": "My own study", "axis": tuple(axes), "seeds": _few(scenario)}
    )


def _few(scenario: Scenario) -> Seeds | None:
    return Seeds(count=10) if sure(scenario).seeds is not None else None


def _ratings(scenario: Scenario) -> dict[str, float | None]:
    """The ratings of lines by key, kVA; lines by the names that tell them apart."""
    names = {scenario.file_name(line.element): line.rating_kva for line in scenario.lines}
    return {f"line.{name.removeprefix('line:')}.rating_kva": kva for name, kva in names.items()}


def _present(scenario: Scenario, key: str) -> object:
    """What a key is now, or 1 where it has no value of its own."""
    table, _, field = key.partition(".")
    if table == "line":
        return _ratings(scenario).get(key) or 500
    value = getattr(getattr(scenario, table, None), field, None)
    return 0.03 if key == "voltage.band_pu" else 1 if value is None else value


def _edited(study: Study) -> Study:
    """The study as its file says, which may be edited; raises InputError."""
    text = study_text(study)
    with st.expander("The study as a file", key="study_file", type="compact"):
        edited = st.text_area(
            "Study file",
            text,
            height=260,
            key=f"study_text_{digest(text).hex()}",
            help=FILE_HELP,
            label_visibility="collapsed",
        )
    return study if edited == text else parse_study(edited)


def _faults(faults: Sequence[Fault]) -> None:
    lines = [f"- {plain(str(fault))}" for fault in faults[:12]]
    more = f"\n- and {len(faults) - 12} more" if len(faults) > 12 else ""
    st.error("This cannot be run yet.\n\n" + "\n".join(lines) + more, icon=":material/error:")


def _start(shelf: Shelf, runs: StudyRuns | None) -> None:
    """What it will take, and the start; one study at a time for everybody."""
    live = shelf.live()
    if runs is not None:
        seconds = seconds_needed(runs, spare_cores())
        days = len({run.key for run in runs.runs})
        long = " That is long; fewer days or values may answer it, too." * (seconds > LONG_SECONDS)
        st.markdown(
            f"**{counted(days, 'run')}, about {duration(seconds)}** on this computer.{long}"
        )
    pressed = st.button(
        "Start",
        key="start_study",
        type="primary",
        icon=":material/play_arrow:",
        disabled=runs is None or live is not None,
        help="It runs beside this page: go on elsewhere, close the tab, come back by this page's "
        "address. Others who use this server come first.",
    )
    # not in a callback, whose arguments would be those of the page as it was before the press
    if pressed and runs is not None and live is None:
        with refusals():
            folder = shelf.start(runs, visitor())
            st.session_state[CHOSEN] = folder.path.name
        st.rerun()
    show_refusal()
    if live is not None:
        st.caption("One study at a time: the next can start once yours has ended or is cancelled.")
        apart(_until_ended, LOOK_SECONDS, key="study_ends")(shelf, live)


def _until_ended(shelf: Shelf, live: StudyFolder) -> None:
    """Draw the page anew once a study has ended, whichever is looked at, and even if it ended
    while the page was being drawn."""
    now = shelf.live()
    if now is None or now.path != live.path:
        st.rerun()
