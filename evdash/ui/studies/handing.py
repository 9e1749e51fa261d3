"""What a study can be handed on as: its tables, its file, all of it."""

import io
import zipfile
from functools import partial

import streamlit as st

from evdash.studies.folder import DIFFERENCES, RESULTS, RUNS, SUMMARY, StudyFolder
from evdash.studies.tables import Found

LEFT_OUT = ("log.txt", "stop", "stand.json", "running.lock")


def handing(folder: StudyFolder, found: Found) -> None:
    """The downloads."""
    with st.container(horizontal=True, key="study_downloads"):
        for name, label, told in (
            (SUMMARY, "Bands, CSV", "Every metric's 5, 50 and 95 % at every point."),
            (RUNS, "Runs, CSV", "Every run with its figures, or why it failed."),
            (DIFFERENCES, "Differences, CSV", "Every point against the first, in pairs of days."),
            ("study.toml", "Study, TOML", "What was asked; runs again on the command line."),
        ):
            st.download_button(
                label,
                partial(_text, folder, found, name),
                name,
                "application/toml" if name.endswith("toml") else "text/csv",
                key=f"download_{name}",
                icon=":material/download:",
                on_click="ignore",
                help=told,
            )
        st.download_button(
            "Everything, .zip",
            lambda: _zipped(folder, found),
            "study.zip",
            "application/zip",
            key="download_study",
            icon=":material/folder_zip:",
            on_click="ignore",
            help="Study, base scenario, tables and results: unpacked, `python -m evdash study "
            "study/study.toml --out study` goes on with it.",
        )


def _text(folder: StudyFolder, found: Found, name: str) -> str:
    folder.write_tables(found)
    return (folder.path / name).read_text(encoding="utf-8")


def _zipped(folder: StudyFolder, found: Found) -> bytes:
    folder.write_tables(found)
    body = io.BytesIO()
    with zipfile.ZipFile(body, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(folder.path.rglob("*")):
            part = path.relative_to(folder.path)
            passing = path.name in LEFT_OUT or path.name[0] == "." or path.name.startswith(RESULTS)
            if path.is_file() and not passing:
                archive.write(path, f"study/{part.as_posix()}")
        archive.writestr(f"study/{RESULTS}", folder.results.content())
    return body.getvalue()
