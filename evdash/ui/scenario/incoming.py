"""Files of one's own that must be converted: networks, workbooks, and tables of sessions, whose
columns the user confirms before they are taken in."""

from datetime import date

import streamlit as st

from evdash.errors import InputError
from evdash.files.draft import Draft
from evdash.imports.clock import Reading
from evdash.imports.feeder import feeder_of_net, with_network
from evdash.imports.pandapower_json import decoded_json, is_pandapower, read_net
from evdash.imports.session_columns import FIELDS, REQUIRED, proposed
from evdash.imports.session_rows import HOURS, SessionRules
from evdash.imports.sessions import MOST_DAYS, with_sessions
from evdash.imports.tables import ForeignTable, read_foreign
from evdash.ui.scenario.editor import Editor, Said
from evdash.ui.words import counted, plain

NONE = ""


def is_network(name: str, content: bytes) -> bool:
    """Whether a file is a pandapower network; InputError where it is JSON by name only."""
    return name.lower().endswith(".json") and is_pandapower(decoded_json(name, content))


def with_uploaded_network(
    draft: Draft, name: str, content: bytes
) -> tuple[Draft, str, tuple[str, ...]]:
    """The draft on an uploaded network, what that did, and how it was converted."""
    imported = feeder_of_net(*read_net(name, content))
    changed, told = with_network(draft, imported)
    return changed, f"{plain(name)} replaced the feeder.", (*imported.notices, *told)


def sessions_form(editor: Editor) -> None:
    """Which column of the waiting table means what; nothing is taken in before it is confirmed."""
    table = editor.waiting
    if table is None:
        return
    with st.container(border=True):
        st.markdown(
            f"**{plain(table.name)}** has {counted(len(table.rows), 'row')} and looks like "
            "recorded sessions. Confirm what its columns mean; nothing is taken in before."
        )
        st.dataframe(list(table.rows[:5]), hide_index=True, alt="The first rows of the table")
        rules = _rules(table)
        with st.container(horizontal=True):
            st.button(
                "Take the sessions in",
                on_click=_confirm,
                args=(editor, table, rules),
                key="confirm_sessions",
                type="primary",
                icon=":material/check:",
                help="They replace the vehicles and set start and intervals; Undo brings "
                "everything back. docs/importing.md says every rule.",
            )
            st.button("Leave it", on_click=_leave, args=(editor,), key="leave_sessions")


def _rules(table: ForeignTable) -> SessionRules:
    guess = proposed(table.columns)
    columns: dict[str, str] = {}
    for place, (field, told) in enumerate(FIELDS.items()):
        if place % 5 == 0:
            row = st.columns(5)
        choices = [NONE, *table.columns]
        with row[place % 5]:
            columns[field] = st.selectbox(
                f"{field}{' (needed)' if field in REQUIRED else ''}",
                choices,
                index=choices.index(guess.get(field, NONE)),
                format_func=lambda column: column or "–",
                key=f"sessions:{table.name}:{field}",
                help=told,
            )
    zone, order, unit, first, days = st.columns(5)
    day_first = {"": None, "day first": True, "month first": False}
    with zone:
        named = st.text_input("Time zone", key="sessions:zone", help="Such as Europe/Berlin")
    with order:
        chosen = st.selectbox("Dates like 3/4/2019", list(day_first), key="sessions:order")
    with unit:
        duration = st.selectbox("Unit of durations", list(HOURS), key="sessions:unit")
    with first:
        day: date | None = st.date_input("First day, blank for all", None, key="sessions:first")
    with days:
        count = st.number_input("Days, blank for all", 1, MOST_DAYS, None, key="sessions:days")
    return SessionRules(
        columns=columns,
        reading=Reading(named.strip() or None, day_first[chosen]),
        duration_unit=duration,
        first_day=day,
        days=count,
    )


def _confirm(editor: Editor, table: ForeignTable, rules: SessionRules) -> None:
    try:
        changed, told = with_sessions(editor.draft, table, rules)
    except InputError as error:
        title = "The sessions were not taken in; your work is as it was."
        editor.said = Said(title, error.faults)
        return
    editor.waiting = None
    editor.take(changed, Said(f"{plain(table.name)} replaced the vehicles.", notes=told))


def _leave(editor: Editor) -> None:
    editor.waiting = None
    editor.said = None


def waiting_table(name: str, content: bytes) -> ForeignTable:
    """A table whose columns are to be confirmed; InputError where there is none."""
    return read_foreign(name, content)
