"""What a draft can begin from: the present run, a preset, files of one's own."""

import re
from collections.abc import Mapping
from io import BytesIO

import streamlit as st
from streamlit.runtime.uploaded_file_manager import UploadedFile

from evdash.errors import Fault, InputError
from evdash.files.draft import (
    RECORDS,
    Draft,
    draft_of,
    read_draft,
    read_rows,
    read_settings,
    recorded,
    table_for,
)
from evdash.files.folder import read_zip
from evdash.files.scenario_folder import SETTINGS
from evdash.files.tables import decode
from evdash.imports.scenario_book import (
    SETTINGS_SHEET,
    SHEETS,
    ScenarioBook,
    read_book,
    with_book,
)
from evdash.imports.tables import read_foreign_sheets
from evdash.imports.workbook import is_workbook, sheet_names
from evdash.ui import gate
from evdash.ui.apart import one_click
from evdash.ui.scenario.editor import Editor, Said, present_scenario
from evdash.ui.scenario.feeder_form import (
    feeder_form,
    is_network,
    read_network,
    shipped_choice,
)
from evdash.ui.scenario.table_form import table_form
from evdash.ui.scenario.templates import templates
from evdash.ui.scenario.waiting import WaitingNetwork, WaitingTable
from evdash.ui.session import Session, bundled, bundled_names
from evdash.ui.words import counted, plain

FROM = "scenario_from"
UPLOAD = "scenario_upload"
MOST_MB = 10
UPLOAD_HELP = (
    "A .zip of a scenario folder replaces everything; a single nodes.csv, lines.csv, profile.csv, "
    "fleet.csv, arrivals.csv, "
    "events.csv or scenario.toml replaces that file only, an .xlsx the sheets it has. A pandapower "
    ".json is a feeder; other tables (.json, .csv, .xlsx) are recorded sessions, prices or loads. "
    "Both wait until you confirm what they are. At most 10 MB a file, 40 MB at a time; what was "
    "taken in or refused makes room."
)


def sources(session: Session, editor: Editor) -> None:
    """Begin from a scenario that is there, or take files in."""
    left, right = st.columns([2, 3], gap="medium")
    with left, st.container(horizontal=True, vertical_alignment="bottom"):
        names = {"": "The present run's"}
        names |= {name: bundled(folder).name for name, folder in bundled_names().items()}
        st.selectbox(
            "Begin from",
            list(names),
            format_func=names.__getitem__,
            key=FROM,
            width=260,
            help="Take it puts all of this scenario into the form below; Undo brings back what was "
            "there. The run goes on as it is until a new day is begun.",
        )
        st.button(
            "Take it",
            on_click=one_click(_take),
            args=(session, editor),
            key="take_scenario",
            icon=":material/input:",
            help="Replaces what is below; Undo brings it back.",
        )
        st.button(
            "Undo",
            on_click=one_click(editor.undo),
            key="undo_scenario",
            icon=":material/undo:",
            disabled=not editor.can_undo,
            help="Back to before the last file or scenario was taken in.",
        )
        shipped_choice(editor)
    with right:
        _uploader(editor)
        templates()
    feeder_form(editor)
    table_form(editor)


def _uploader(editor: Editor) -> None:
    """Where files come in: an empty one each time some have, as no file is kept any longer."""
    with st.container(key=UPLOAD):
        st.file_uploader(
            "Or bring your own files",
            type=["zip", "csv", "toml", "json", "xlsx"],
            accept_multiple_files=True,
            key=f"{UPLOAD}:{editor.uploads}",
            on_change=_uploaded,
            args=(editor,),
            max_upload_size=MOST_MB,
            help=UPLOAD_HELP,
        )
        if editor.not_kept:
            st.warning(editor.not_kept, icon=":material/upload_file:")


def _uploaded(editor: Editor) -> None:
    """Take in what has come, or refuse it; either way it is let go then."""
    come = st.session_state[f"{UPLOAD}:{editor.uploads}"]
    if not come:
        return
    editor.take_typed()
    editor.uploads += 1
    files = [file for file in come if isinstance(file, UploadedFile)]
    if files:
        receive(editor, {file.name: file.getvalue() for file in files})
    gate.let_go()
    lost, were = len(come) - len(files), "was" if len(come) - len(files) == 1 else "were"
    told = f"{lost} of {counted(len(come), 'file')} {were} not kept. {gate.refused_here()}"
    editor.not_kept = told if lost else ""


def _take(session: Session, editor: Editor) -> None:
    name = st.session_state[FROM]
    scenario = bundled(bundled_names()[name]) if name else present_scenario(session)
    editor.take(draft_of(scenario), Said(f"Begun from {plain(scenario.name)}."))


def receive(editor: Editor, files: Mapping[str, bytes]) -> None:
    """Take uploaded files in, or say of every one of them why it cannot be.

    Networks and tables of any columns wait to be confirmed, one of each at a time.
    """
    draft = editor.draft
    faults: list[Fault] = []
    told: list[str] = []
    books: list[ScenarioBook] = []
    table: WaitingTable | None = None
    network: WaitingNetwork | None = None
    for name, content in files.items():
        try:
            if is_network(name, content):
                _alone(network, name)
                network = read_network(name, content, editor.next_number())
            elif is_foreign(name, content):
                _alone(table, name)
                table = WaitingTable(read_foreign_sheets(name, content), editor.next_number())
            elif is_workbook(name):
                books.append(read_book(name, content))
                draft, what = with_book(draft, books[-1])
                told += what
            else:
                draft, what = taken_in(draft, name, content)
                told += what
        except InputError as error:
            faults += list(error.faults)
    if faults:
        editor.said = Said("Nothing was taken in; your work is as it was.", tuple(faults))
        return
    editor.waiting, editor.network = table or editor.waiting, network or editor.network
    if told:
        editor.take(draft, Said(plain(" ".join(told))), books)
    elif table or network:
        editor.said = None


def _alone(waiting: object, name: str) -> None:
    """Refuse a second file that waits to be confirmed."""
    if waiting is not None:
        rule = "should come by itself, as it waits to be confirmed"
        raise InputError([Fault(name, "one more file of its kind", rule)])


def is_foreign(name: str, content: bytes) -> bool:
    """Whether a file is a table that is none of a scenario's, as sessions or prices are."""
    if name.lower().endswith(".json"):
        return True
    if is_workbook(name):
        return not (set(SHEETS) | {SETTINGS_SHEET}) & set(sheet_names(name, content))
    if not name.lower().endswith(".csv") or table_for(name, content) is not None:
        return False
    text, unreadable = decode(name, content)
    head, _, rest = text.partition("\n")
    return not unreadable and bool(rest.strip()) and len(re.split("[,;\t]", head)) > 1


def taken_in(draft: Draft, name: str, content: bytes) -> tuple[Draft, tuple[str, ...]]:
    """The draft with one more file, and what that did; raises InputError if it has no place."""
    if name.lower().endswith(".zip"):
        whole = read_draft(read_zip(BytesIO(content), name))
        return whole, (f"{name} replaced the whole scenario.",)
    if name.lower().endswith(".toml"):
        settings, faults = read_settings(content)
        if faults:
            raise InputError(faults)
        return draft.with_settings(settings), (f"{name} replaced {SETTINGS}.",)
    file = table_for(name, content)
    if file is None:
        allowed = f"should be named {', '.join(RECORDS)}, or have the columns of one of them"
        raise InputError([Fault(name, "a table that is none of a scenario's", allowed)])
    rows, faults = read_rows(file, content)
    if faults:
        raise InputError([Fault(f"{name}: {f.place}", f.found, f.allowed) for f in faults])
    told = f"{name} replaced {file}: {counted(len(rows), 'row')}."
    changed = draft.with_table(file, rows)
    more: list[str] = []
    if file == "arrivals.csv":
        changed, more = recorded(changed)
    return changed, (told, *more)
