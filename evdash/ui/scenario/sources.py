"""What a draft can begin from: the present run, a preset, files of one's own."""

import re
from collections.abc import Mapping
from io import BytesIO

import streamlit as st

from evdash.errors import Fault, InputError
from evdash.files.draft import (
    RECORDS,
    Draft,
    draft_of,
    read_draft,
    read_rows,
    read_settings,
    table_for,
)
from evdash.files.folder import read_zip
from evdash.files.scenario_folder import SETTINGS
from evdash.files.tables import decode
from evdash.imports.session_columns import REQUIRED, proposed
from evdash.imports.workbook import (
    SETTINGS_SHEET,
    SHEETS,
    in_sheets,
    is_workbook,
    read_sheets,
    scenario_parts,
)
from evdash.ui.scenario.editor import Editor, Said, present_scenario
from evdash.ui.scenario.incoming import (
    is_network,
    sessions_form,
    waiting_table,
    with_uploaded_network,
)
from evdash.ui.session import Session, bundled, bundled_names
from evdash.ui.words import counted, plain

FROM = "scenario_from"
MOST_MB = 10
UPLOAD_HELP = (
    "A .zip of a scenario folder replaces everything; a single nodes.csv, lines.csv, profile.csv, "
    "fleet.csv, arrivals.csv, "
    "events.csv or scenario.toml replaces that file only, an .xlsx the sheets it has. A pandapower "
    ".json replaces the feeder; recorded sessions (.json, .csv, .xlsx) replace the vehicles once "
    "their columns are confirmed. Files stay on this computer."
)


def sources(session: Session, editor: Editor) -> None:
    """Begin from a scenario that is there, or take files in."""
    left, right = st.columns([2, 3], gap="medium")
    with left, st.container(horizontal=True, vertical_alignment="bottom"):
        names = {"": "The present run's"}
        names |= {name: bundled(folder).name for name, folder in bundled_names().items()}
        st.selectbox("Begin from", list(names), format_func=names.__getitem__, key=FROM, width=260)
        st.button(
            "Take it",
            on_click=_take,
            args=(session, editor),
            key="take_scenario",
            icon=":material/input:",
            help="Replaces what is below; Undo brings it back.",
        )
        st.button(
            "Undo",
            on_click=editor.undo,
            key="undo_scenario",
            icon=":material/undo:",
            disabled=not editor.can_undo,
            help="Back to before the last file or scenario was taken in.",
        )
    with right:
        files = st.file_uploader(
            "Or bring your own files",
            type=["zip", "csv", "toml", "json", "xlsx"],
            accept_multiple_files=True,
            key="scenario_upload",
            max_upload_size=MOST_MB,
            help=UPLOAD_HELP,
        )
        new = [file for file in files if file.file_id not in editor.uploaded]
        if new:
            editor.uploaded |= {file.file_id for file in new}
            receive(editor, {file.name: file.getvalue() for file in new})
    sessions_form(editor)


def _take(session: Session, editor: Editor) -> None:
    name = st.session_state[FROM]
    scenario = bundled(bundled_names()[name]) if name else present_scenario(session)
    editor.take(draft_of(scenario), Said(f"Begun from {plain(scenario.name)}."))


def receive(editor: Editor, files: Mapping[str, bytes]) -> None:
    """Take uploaded files in, or say of every one of them why it cannot be."""
    draft, faults, told = editor.draft, [], []
    notes: tuple[str, ...] = ()
    for name, content in files.items():
        try:
            if is_network(name, content):
                draft, what, notes = with_uploaded_network(draft, name, content)
            elif may_be_sessions(name, content):
                editor.waiting = waiting_table(name, content)
                continue
            else:
                draft, what = taken_in(draft, name, content)
        except InputError as error:
            faults += list(error.faults)
        else:
            told.append(what)
    if faults:
        editor.said = Said("Nothing was taken in; your work is as it was.", tuple(faults))
    elif told:
        editor.take(draft, Said(" ".join(told), notes=notes))


def may_be_sessions(name: str, content: bytes) -> bool:
    """Whether a file is a table that is none of a scenario's, as sessions are."""
    if name.lower().endswith(".json"):
        return True
    if is_workbook(name):
        return not (set(SHEETS) | {SETTINGS_SHEET}) & set(read_sheets(name, content))
    if not name.lower().endswith(".csv") or table_for(name, content) is not None:
        return False
    text, unreadable = decode(name, content)
    columns = re.split("[,;\t]", text.partition("\n")[0])
    return not unreadable and set(REQUIRED) <= set(proposed([c.strip() for c in columns]))


def taken_in(draft: Draft, name: str, content: bytes) -> tuple[Draft, str]:
    """The draft with one more file, and what that did; raises InputError if it has no place."""
    if name.lower().endswith(".zip"):
        whole = read_draft(read_zip(BytesIO(content), name))
        return whole, f"{plain(name)} replaced the whole scenario."
    if is_workbook(name):
        return with_sheets(draft, name, content)
    if name.lower().endswith(".toml"):
        settings, faults = read_settings(content)
        if faults:
            raise InputError(faults)
        return draft.with_settings(settings), f"{plain(name)} replaced {SETTINGS}."
    file = table_for(name, content)
    if file is None:
        allowed = f"should be named {', '.join(RECORDS)}, or have the columns of one of them"
        raise InputError([Fault(name, "a table that is none of a scenario's", allowed)])
    rows, faults = read_rows(file, content)
    if faults:
        raise InputError([Fault(f"{name}: {f.place}", f.found, f.allowed) for f in faults])
    return draft.with_table(
        file, rows
    ), f"{plain(name)} replaced {file}: {counted(len(rows), 'row')}."


def with_sheets(draft: Draft, name: str, content: bytes) -> tuple[Draft, str]:
    """The draft with the tables and settings a workbook has."""
    files = scenario_parts(name, content)
    faults: list[Fault] = []
    for file, text in files.items():
        if file == SETTINGS:
            settings, found = read_settings(text)
            draft = draft.with_settings(settings)
        else:
            rows, found = read_rows(file, text)
            draft = draft.with_table(file, rows)
        faults += in_sheets(name, found)
    if faults:
        raise InputError(faults)
    return draft, f"{plain(name)} replaced {', '.join(files)}."
