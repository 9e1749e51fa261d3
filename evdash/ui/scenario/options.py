"""Price options and who chooses them, and the share of arrivals by clock hour."""

from typing import Any

import streamlit as st

from evdash.domain.arrivals import ArrivalStatistics
from evdash.domain.scenario import PriceOption
from evdash.files.draft import Rows
from evdash.files.wording import allowed_words
from evdash.ui.scenario.editor import Editor
from evdash.ui.scenario.fields import as_typed, label_of, text_of
from evdash.ui.scenario.tables import grid
from evdash.ui.typed import number_column

SHARE = "share"
HOUR, HOURLY = "clock hour", "share of arrivals"


def statistics_path(editor: Editor) -> tuple[str, ...]:
    """Where the statistics of arrivals stand: the generator's own, or a list's forecast."""
    return ("arrivals", "forecast") if editor.draft.is_recorded else ("arrivals",)


def options(editor: Editor) -> None:
    """Price options as a table, with the share of drivers where statistics are known."""
    listed = editor.get(("option",))
    path = (*statistics_path(editor), "option_share")
    shares = editor.get(path)
    if not isinstance(listed, list) or not all(isinstance(option, dict) for option in listed):
        st.warning("The price options cannot be shown as a table; see **As text**.")
        return
    names = list(PriceOption.model_fields)
    rows = [{name: text_of(option.get(name)) for name in names} for option in listed]
    if isinstance(shares, dict):
        rows = [row | {SHARE: text_of(shares.get(row["name"]))} for row in rows]

    def lay(typed: Rows) -> None:
        kept = [row for row in typed if any(row.values())]
        told = [{name: _typed(name, row[name]) for name in names if row[name]} for row in kept]
        editor.set(("option",), told)
        if isinstance(shares, dict):
            known = {row["name"]: as_typed(row[SHARE]) for row in kept if row["name"]}
            editor.set(path, {name: share for name, share in known.items() if share is not None})

    columns = [*names, SHARE] if isinstance(shares, dict) else names
    grid(editor, "options", tuple(rows), columns, lay, columns=_columns())


def _typed(name: str, text: str) -> object:
    return text if name == "name" else as_typed(text)


def _columns() -> dict[str, Any]:
    fields = PriceOption.model_fields
    share = ArrivalStatistics.model_fields["option_share"]
    columns: dict[str, Any] = {
        name: number_column(name, f"{label_of(field)}. Allowed: {allowed_words(field)}.")
        for name, field in fields.items()
        if name != "name"
    }
    columns["name"] = st.column_config.TextColumn(
        "name", help=label_of(fields["name"]), width="small"
    )
    columns[SHARE] = number_column(SHARE, label_of(share))
    return columns


def hourly_share(editor: Editor) -> None:
    """The share of arrivals in each of the 24 clock hours."""
    path = (*statistics_path(editor), "hourly_share")
    shares = editor.get(path)
    field = ArrivalStatistics.model_fields["hourly_share"]
    if not isinstance(shares, list) or len(shares) != 24:
        st.warning("hourly_share is not a list of 24 numbers; see **As text**.")
        return
    st.caption(label_of(field))
    rows = [
        {HOUR: f"{hour:02d}:00–{(hour + 1) % 24:02d}:00", HOURLY: text_of(share)}
        for hour, share in enumerate(shares)
    ]

    def lay(typed: Rows) -> None:
        editor.set(path, [as_typed(row[HOURLY] or "0") for row in typed])

    columns = {HOURLY: number_column(HOURLY, label_of(field))}
    grid(editor, "hourly_share", tuple(rows), [HOUR, HOURLY], lay, columns=columns, fixed=[HOUR])
