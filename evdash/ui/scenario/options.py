"""Price options and who chooses them, and the share of arrivals by clock hour."""

from typing import Any

import pandas as pd
import streamlit as st

from evdash.domain.scenario import ArrivalStatistics, PriceOption
from evdash.files.wording import allowed_words
from evdash.ui.scenario.editor import Editor
from evdash.ui.scenario.fields import label_of

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
    rows = [{name: option.get(name) for name in names} for option in listed]
    if isinstance(shares, dict):
        rows = [row | {SHARE: shares.get(str(row["name"]))} for row in rows]
    edited = _edited(editor, "options", rows, _columns(), dynamic=True)
    if edited is None:
        return
    kept = [row for row in edited if any(value is not None for value in row.values())]
    editor.set(
        ("option",),
        [{name: row[name] for name in names if row[name] is not None} for row in kept],
    )
    if isinstance(shares, dict):
        known = {str(row["name"]): row[SHARE] for row in kept if row["name"] is not None}
        editor.set(path, {name: share for name, share in known.items() if share is not None})


def _columns() -> dict[str, Any]:
    fields = PriceOption.model_fields
    share = ArrivalStatistics.model_fields["option_share"]
    columns: dict[str, Any] = {
        name: st.column_config.NumberColumn(
            name,
            help=f"{label_of(field)}. Allowed: {allowed_words(field)}.",
            format="%g",
        )
        for name, field in fields.items()
        if name != "name"
    }
    columns["name"] = st.column_config.TextColumn(
        "name", help=label_of(fields["name"]), width="small"
    )
    columns[SHARE] = st.column_config.NumberColumn(SHARE, help=label_of(share), format="%g")
    return columns


def hourly_share(editor: Editor) -> None:
    """The share of arrivals in each of the 24 clock hours."""
    path = (*statistics_path(editor), "hourly_share")
    shares = editor.get(path)
    field = ArrivalStatistics.model_fields["hourly_share"]
    fits = isinstance(shares, list) and len(shares) == 24
    if not fits or not all(isinstance(share, int | float) for share in shares):
        st.warning("hourly_share is not a list of 24 numbers; see **As text**.")
        return
    st.caption(label_of(field))
    rows = [
        {HOUR: f"{hour:02d}:00–{(hour + 1) % 24:02d}:00", HOURLY: float(share)}
        for hour, share in enumerate(shares)
    ]
    column = st.column_config.NumberColumn(HOURLY, help=label_of(field), format="%g", min_value=0)
    edited = _edited(editor, "hourly_share", rows, {HOURLY: column}, dynamic=False)
    if edited is not None:
        editor.set(path, [row[HOURLY] if row[HOURLY] is not None else 0.0 for row in edited])


def _edited(
    editor: Editor,
    name: str,
    rows: list[dict[str, Any]],
    columns: dict[str, Any],
    *,
    dynamic: bool,
) -> list[dict[str, Any]] | None:
    """Rows as edited; None where nothing differs from `rows`."""
    key = f"table:{name}:{editor.revision}"
    if key not in st.session_state or name not in editor.grids:
        editor.grids[name] = rows
    frame = pd.DataFrame(editor.grids[name])
    result = st.data_editor(
        frame,
        key=key,
        num_rows="dynamic" if dynamic else "fixed",
        hide_index=True,
        placeholder="",
        disabled=[HOUR],
        column_config=columns,
        alt=f"{name}, editable",
    )
    found = [
        {name: None if pd.isna(value) else value for name, value in row.items()}
        for row in result.to_dict("records")
    ]
    return None if found == rows else [{str(k): v for k, v in row.items()} for row in found]
