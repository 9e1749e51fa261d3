"""Tables of a scenario in data editors, laid over the draft as they are edited."""

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, get_args

import pandas as pd
import streamlit as st
from pydantic.fields import FieldInfo

from evdash.files.draft import RECORDS, Rows, table_text, template_text
from evdash.files.wording import allowed_words
from evdash.ui.scenario.editor import MOST_ROWS, Editor
from evdash.ui.scenario.fields import label_of
from evdash.ui.typed import number_column, rows_as_typed

FIRST_ROW = 2
"""Rows are numbered as in the file, whose first line is the header."""
HEIGHT_PX = 460


def table(editor: Editor, file: str, told: str) -> None:
    """A table of a scenario: editor, what it is for, and downloads."""
    rows = editor.draft.tables.get(file, ())
    st.caption(told)
    if len(rows) > MOST_ROWS:
        st.warning(f"{len(rows):,} rows are too many to edit here; at most {MOST_ROWS:,}.")
    else:
        _edit(editor, file, rows)
    _downloads(editor, file)


def _edit(editor: Editor, file: str, rows: Rows) -> None:
    fields = RECORDS[file].model_fields
    columns = {column: _config(column, field) for column, field in fields.items()}
    columns |= {"_index": st.column_config.Column("Row", width="small")}

    def lay(typed: Rows) -> None:
        editor.set_rows(file, tuple(row for row in typed if any(row.values())))

    grid(editor, file, rows, list(fields), lay, columns=columns, first_row=FIRST_ROW)


def grid(
    editor: Editor,
    name: str,
    rows: Rows,
    names: Sequence[str],
    lay: Callable[[Rows], None],
    *,
    columns: Mapping[str, Any],
    first_row: int | None = None,
    fixed: Collection[str] = (),
) -> None:
    """Rows of text in a data editor, whose rows as typed are handed to `lay`.

    They are numbered from `first_row` on. Where some columns are `fixed`, so is how many there are.
    """
    key = f"table:{name}:{editor.revision}"
    if key not in st.session_state or name not in editor.bases:
        editor.bases[name] = rows
    base = editor.bases[name]
    frame = pd.DataFrame([[row[one] for one in names] for row in base], columns=list(names))
    if first_row is not None:
        frame.index = pd.RangeIndex(first_row, first_row + len(base))
    editor.laid[key] = lambda state: lay(rows_as_typed(base, state, names))
    st.data_editor(
        frame.astype("object"),
        key=key,
        num_rows="fixed" if fixed else "dynamic",
        hide_index=first_row is None,
        placeholder="",
        height=min(HEIGHT_PX, 35 * (len(base) + 2) + 3),
        disabled=list(fixed),
        column_config=dict(columns),
        alt=f"Rows of {name}, editable",
    )
    editor.shown[key] = st.session_state[key]


def _config(column: str, field: FieldInfo) -> Any:
    allowed = allowed_words(field)
    told = f"{label_of(field)}. {f'Allowed: {allowed}.' if allowed else ''}"
    kinds = set(get_args(field.annotation)) or {field.annotation}
    if all(isinstance(choice, str) for choice in kinds):
        return st.column_config.SelectboxColumn(column, help=told, options=list(kinds))
    if kinds & {int, float}:
        return number_column(column, told)
    return st.column_config.TextColumn(column, help=told)


def _downloads(editor: Editor, file: str) -> None:
    with st.container(horizontal=True, gap="xsmall"):
        st.download_button(
            f"{file} as it is here",
            editor.rest.then(lambda: table_text(file, editor.draft.tables.get(file, ()))),
            file,
            "text/csv",
            key=f"download:{file}",
            icon=":material/download:",
            on_click="ignore",
            type="tertiary",
        )
        st.download_button(
            "A template to fill in",
            template_text(file),
            file,
            "text/csv",
            key=f"template:{file}",
            icon=":material/description:",
            on_click="ignore",
            type="tertiary",
            help="The columns, and one row as an example.",
        )
