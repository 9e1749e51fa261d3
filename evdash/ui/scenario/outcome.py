"""Whether the draft will do: every fault at once, or a new day on it, and the way out as a .zip."""

import streamlit as st

from evdash.domain.scenario import Scenario
from evdash.errors import Fault
from evdash.files.differences import scenario_differences
from evdash.files.draft import files_of, zipped
from evdash.files.scenario_folder import scenario_files
from evdash.ui import run as runs
from evdash.ui.parts import table
from evdash.ui.scenario.editor import Editor, Said, present_scenario
from evdash.ui.session import Session
from evdash.ui.words import counted, file_stem, plain

SHOWN_FAULTS = 200


def outcome(session: Session, editor: Editor) -> None:
    """What was said last, the draft's faults or its readiness, and what can be done with it."""
    _said(editor)
    scenario, faults = editor.check()
    if scenario is None:
        st.error(
            f"**{counted(len(faults), 'fault')}.** No day can begin on this scenario before "
            f"{'it is' if len(faults) == 1 else 'they are'} mended; nothing you entered is lost.",
            icon=":material/error:",
        )
        fault_table(faults)
    with st.container(horizontal=True, vertical_alignment="center", key="scenario_actions"):
        _begin(session, editor, scenario)
        _download(editor, scenario)
        _state(session, scenario)


def _said(editor: Editor) -> None:
    if editor.said is None:
        return
    if editor.said.faults:
        st.error(f"**{editor.said.title}**", icon=":material/block:")
        fault_table(editor.said.faults)
    else:
        st.success(editor.said.title, icon=":material/check_circle:")
        if editor.said.notes:
            with st.expander("What was converted, and how", expanded=True):
                st.markdown("\n".join(f"- {plain(note)}" for note in editor.said.notes))


def fault_table(faults: tuple[Fault, ...]) -> None:
    """Faults, each with its place, what was found and what is allowed."""
    rows: list[dict[str, object]] = [
        {"Where": fault.place, "Found": fault.found, "Allowed": fault.allowed}
        for fault in faults[:SHOWN_FAULTS]
    ]
    table(rows, "Every fault: where it stands, what was found, what is allowed")
    if len(faults) > SHOWN_FAULTS:
        st.caption(f"The first {SHOWN_FAULTS} of {len(faults):,} are shown.")


def _begin(session: Session, editor: Editor, scenario: Scenario | None) -> None:
    decided = session.run.trace.now
    lost = (
        f" The present run, {counted(decided, 'interval')} decided, makes room for it; pin it on "
        "Compare first if you want to keep it."
        if decided
        else ""
    )
    if (
        st.button(
            "Begin a new day on it",
            key="apply_scenario",
            type="primary",
            icon=":material/play_arrow:",
            disabled=scenario is None,
            help=f"The day starts at its first interval, on all pages.{lost}",
        )
        and scenario is not None
    ):
        session.take(runs.open_run(None, scenario))
        editor.follow(scenario)
        editor.said = Said(f"A new day has begun on {plain(scenario.name)}. See it on Live.")
        st.rerun()


def _download(editor: Editor, scenario: Scenario | None) -> None:
    def packed() -> bytes:
        now, _ = editor.check()
        return zipped(scenario_files(now) if now else files_of(editor.draft), name)

    name = file_stem(str(editor.draft.settings.get("name", "")))
    st.download_button(
        "Download as .zip",
        editor.rest.then(packed),
        f"{name}.zip",
        "application/zip",
        key="download_scenario",
        icon=":material/download:",
        on_click="ignore",
        help="The whole scenario folder. Taken in again here, or run on the command line, it is "
        "the same scenario." + ("" if scenario else " Its faults go with it."),
    )


def _state(session: Session, scenario: Scenario | None) -> None:
    """In a few words: what is different from the present run, and what beginning would drop."""
    if scenario is None:
        return
    differing = scenario_differences(present_scenario(session), scenario)
    decided = session.run.trace.now
    if not differing:
        st.caption("This is the present run's scenario. Change anything below.")
        return
    with st.popover(f"{counted(len(differing), 'difference')} to the present run"):
        table(
            [
                {"Where": one.place, "Present run": one.before, "Here": one.after}
                for one in differing
            ],
            "What differs from the present run's scenario",
        )
    if decided:
        st.caption(
            f":material/info: A new day drops the {counted(decided, 'interval')} decided so far."
        )
