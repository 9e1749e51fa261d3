"""Templates to download: small, complete, and valid as they are."""

from collections.abc import Callable
from functools import partial

import streamlit as st

from evdash.files.draft import zipped
from evdash.imports.templates import TABLES, template_files, template_table, template_workbook

XLSX = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"


def templates() -> None:
    """What files of one's own may look like, each to be written over and taken in again."""
    with st.popover("Templates", icon=":material/description:", help="Files to fill in"):
        st.caption(
            "Each is complete and runs as it is. Units and what is allowed stand beside it, in the "
            "workbook's sheet README and in the notes of its heads."
        )
        _download("A scenario as a workbook", "scenario.xlsx", template_workbook, XLSX)
        _download("Everything as a .zip", "templates.zip", _everything, "application/zip")
        for name, told in TABLES.items():
            words = told.partition(",")[0]
            _download(f"{words[0].upper()}{words[1:]}", name, partial(template_table, name))


def _everything() -> bytes:
    return zipped(template_files(), "templates")


def _download(label: str, name: str, make: Callable[[], bytes], mime: str = "text/csv") -> None:
    st.download_button(
        f"{label}: {name}",
        make,
        name,
        mime,
        key=f"template:{name}",
        icon=":material/download:",
        on_click="ignore",
        type="tertiary",
    )
