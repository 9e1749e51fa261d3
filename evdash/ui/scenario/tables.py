"""Tables of a scenario in data editors, laid over the draft as they are edited."""

import math
from typing import Any, get_args

import pandas as pd
import streamlit as st
from pydantic.fields import FieldInfo

from evdash.files.draft import RECORDS, Row, Rows, table_text, template_text
from evdash.files.wording import allowed_words
from evdash.ui.scenario.editor import MOST_ROWS, Editor
from evdash.ui.scenario.fields import label_of

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
    key = f"table:{file}:{editor.revision}"
    if key not in st.session_state or file not in editor.bases:
        editor.bases[file] = rows
    base = editor.bases[file]
    fields = RECORDS[file].model_fields
    kinds = {
        column: _kind(field, [row[column] for row in base]) for column, field in fields.items()
    }
    edited = st.data_editor(
        frame_of(base, kinds),
        key=key,
        num_rows="dynamic",
        hide_index=False,
        placeholder="",
        height=min(HEIGHT_PX, 35 * (len(base) + 2) + 3),
        column_config={"_index": st.column_config.NumberColumn("Row", width="small")}
        | {column: _config(column, field, kinds[column]) for column, field in fields.items()},
        alt=f"Rows of {file}, editable",
    )
    found = rows_of(edited, kinds)
    if found == rows_of(frame_of(base, kinds), kinds):  # untouched: keep it as it was written
        found = base
    if found != editor.draft.tables.get(file, ()):
        editor.set_rows(file, found)


def _kind(field: FieldInfo, cells: list[str]) -> type:
    """What a column's cells are edited as: numbers where all of them are, else text."""
    kinds = set(get_args(field.annotation)) | {field.annotation}
    kind = int if int in kinds else float if float in kinds else str
    return kind if kind is str or all(_reads_as(kind, cell) for cell in cells if cell) else str


def _reads_as(kind: type, cell: str) -> bool:
    try:
        value = kind(cell)
    except ValueError:
        return False
    return math.isfinite(value) and abs(value) < 2**53


def frame_of(rows: Rows, kinds: dict[str, type]) -> pd.DataFrame:
    """Rows as a data frame whose index is the row's number in the file."""
    columns = {
        name: pd.Series(
            [kind(row[name]) if row[name] else None for row in rows],
            dtype={int: "Int64", float: "float64", str: "object"}[kind],
        )
        for name, kind in kinds.items()
    }
    frame = pd.DataFrame(columns)
    frame.index = pd.RangeIndex(FIRST_ROW, FIRST_ROW + len(rows))
    return frame


def rows_of(frame: pd.DataFrame, kinds: dict[str, type]) -> Rows:
    """A data frame as rows of text; rows that are blank all over are left out."""
    rows: list[Row] = []
    for line in frame.to_dict("records"):
        row = {name: _cell(line[name], kind) for name, kind in kinds.items()}
        if any(row.values()):
            rows.append(row)
    return tuple(rows)


def _cell(value: Any, kind: type) -> str:
    if value is None or pd.isna(value):
        return ""
    return str(value).strip() if kind is str else repr(kind(value))


def _config(column: str, field: FieldInfo, kind: type) -> Any:
    allowed = allowed_words(field)
    told = f"{label_of(field)}. {f'Allowed: {allowed}.' if allowed else ''}"
    kinds = get_args(field.annotation)
    if kind is str and kinds and all(isinstance(choice, str) for choice in kinds):
        return st.column_config.SelectboxColumn(column, help=told, options=list(kinds))
    if kind is str:
        return st.column_config.TextColumn(column, help=told)
    form = "%d" if kind is int else "%g"
    return st.column_config.NumberColumn(column, help=told, format=form)


def _downloads(editor: Editor, file: str) -> None:
    with st.container(horizontal=True, gap="xsmall"):
        st.download_button(
            f"{file} as it is here",
            lambda: table_text(file, editor.draft.tables.get(file, ())),
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
