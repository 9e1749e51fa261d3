"""Numbers typed into a page: fields and cells of text, read by one strict reader.

Streamlit's own fields and columns of numbers reinterpret in the browser: `4,5` becomes 45, a cell
`.19` becomes 19, and the text is gone before we could say so.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import streamlit as st

from evdash.errors import Fault
from evdash.files.numbers import number_text, read_number
from evdash.files.wording import beyond, shown
from evdash.ui.words import plain

Row = Mapping[str, str]


def read_within(
    place: str, text: str, marks: Iterable[object], *, whole: bool = False
) -> int | float | Fault:
    """The number a text stands for, in bounds as `marks` declare them; or what is wrong with it."""
    try:
        number = read_number(text, whole=whole)
    except ValueError as error:
        return Fault(place, shown(text), str(error))
    wrong = beyond(number, marks)
    return Fault(place, shown(text), wrong) if wrong else number


def ask_number(
    label: str,
    value: float | None,
    key: str,
    marks: Iterable[object],
    help_text: str,
    *,
    whole: bool = False,
    blank: bool = False,
    placeholder: str | None = None,
    width: int | str = "stretch",
) -> Any:
    """A field of its own for a number, and what it holds: the number, or a Fault told below it.

    Where `blank` says that nothing need be given, None for nothing.
    """
    with st.container(width=width, gap="xxsmall"):  # type: ignore[arg-type]
        text = st.text_input(
            label,
            "" if value is None else number_text(value),
            key=key,
            placeholder=placeholder,
            help=help_text,
        )
        if blank and not text.strip():
            return None
        number = read_within(label, text, marks, whole=whole)
        if isinstance(number, Fault):
            refuse(number)
    return number


def refuse(fault: Fault, instead: str = "") -> None:
    """Say of what was typed that it is not read, and what holds instead."""
    told = f":red[Found {plain(fault.found)}; {plain(fault.allowed)}.] {plain(instead)}"
    st.markdown(f":small[{told}]")


def number_column(label: str, help_text: str, **options: Any) -> Any:
    """A column of numbers in a table that is edited as text."""
    return st.column_config.TextColumn(label, help=help_text, alignment="right", **options)


def rows_as_typed(
    base: Sequence[Row], state: Mapping[str, Any], columns: Sequence[str]
) -> tuple[dict[str, str], ...]:
    """Rows of a table editor that was given `base`, by its state: cells of text as typed."""
    rows = [dict(row) for row in base]
    for place, cells in state.get("edited_rows", {}).items():
        rows[int(place)] |= {name: _cell(cell) for name, cell in cells.items() if name in columns}
    gone = set(state.get("deleted_rows", ()))
    kept = [row for place, row in enumerate(rows) if place not in gone]
    for cells in state.get("added_rows", ()):
        kept.append({name: _cell(cells.get(name)) for name in columns})
    return tuple(kept)


def _cell(cell: object) -> str:
    return "" if cell is None else str(cell).strip()
