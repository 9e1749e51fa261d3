"""The studies there are, how far the chosen one is, and what can be done about it."""

import streamlit as st

from evdash.studies.folder import StudyFolder
from evdash.studies.shelf import Shelf
from evdash.studies.stand import Stand, read_stand
from evdash.ui.apart import apart
from evdash.ui.studies.ask import CHOSEN, LOOK_SECONDS
from evdash.ui.studies.refusal import resume, show_refusal
from evdash.ui.studies.words import duration
from evdash.ui.words import counted, plain

REDRAW_SHARE = 0.1
"""Pictures are drawn anew each time so much more of a study has landed."""


def chosen(shelf: Shelf) -> StudyFolder | None:
    """The study to look at: the latest, until another is picked."""
    folders = {folder.path.name: folder for folder in shelf.folders()}
    if not folders:
        return None
    if st.session_state.get(CHOSEN) not in folders:
        st.session_state[CHOSEN] = next(iter(folders))
    if len(folders) > 1:
        st.selectbox(
            "Your studies",
            list(folders),
            format_func=lambda name: _title(shelf, folders[name]),
            key=CHOSEN,
            help="Those begun in this tab or reached by its address, the latest first.",
        )
    return folders[st.session_state[CHOSEN]]


def _title(shelf: Shelf, folder: StudyFolder) -> str:
    study = shelf.study(folder).study
    return f"{folder.path.name}. {study.question or study.name}"


def standing(shelf: Shelf, folder: StudyFolder) -> Stand | None:
    """How far it is, by itself for as long as it runs; and the stand the page is drawn by."""
    stand = read_stand(folder)
    live = stand is not None and stand.is_live
    apart(_told, LOOK_SECONDS if live else None, key="study_stand")(shelf, folder, stand)
    return stand


def _told(shelf: Shelf, folder: StudyFolder, drawn: Stand | None) -> None:
    stand = read_stand(folder)
    if stand is None:
        st.button("Run it", on_click=resume, args=(shelf, folder), key="resume_study")
        return
    if drawn is not None and _differs(drawn, stand):
        st.rerun()
    with st.container(horizontal=True, vertical_alignment="center", key="study_bar"):
        share = stand.ended / stand.total if stand.total else 0.0
        if stand.state != "done":
            st.progress(min(1.0, share), text=_sentence(shelf, folder, stand))
        else:
            st.markdown(f":material/check_circle: {_sentence(shelf, folder, stand)}")
        _buttons(shelf, folder, stand)
    show_refusal()
    if stand.said:
        st.error(plain(stand.said), icon=":material/error:")


def _differs(drawn: Stand, now: Stand) -> bool:
    if (drawn.state in ("starting", "waiting")) and now.state in ("starting", "waiting"):
        return False
    further = now.ended - drawn.ended >= max(1.0, REDRAW_SHARE * now.total)
    return now.state != drawn.state or further


def _sentence(shelf: Shelf, folder: StudyFolder, stand: Stand) -> str:
    if stand.state == "starting":
        return "Starting…"
    if stand.state == "waiting":
        ahead = shelf.ahead_of(folder)
        return f"Waiting: {counted(ahead, 'other study', 'other studies')} first." * bool(
            ahead
        ) or ("Waiting for its turn…")
    done = f"{stand.ended:,} of {counted(stand.total, 'run')}"
    failed = f", {stand.failed:,} failed" if stand.failed else ""
    if stand.state == "done":
        return f"All {counted(stand.total, 'run')} have ended{failed}."
    if stand.state == "running":
        left = f", about {duration(stand.seconds_left)} left" if stand.seconds_left else ""
        return f"{done}{failed}{left}"
    told = {
        "stopped": "Cancelled",
        "broken": "Broken off",
        "interrupted": "Interrupted: its process is gone",
    }
    return f"{told[stand.state]}. {done} are done and kept{failed}."


def _buttons(shelf: Shelf, folder: StudyFolder, stand: Stand) -> None:
    if stand.is_live:
        st.button(
            "Cancel",
            on_click=shelf.cancel,
            args=(folder,),
            key="cancel_study",
            icon=":material/stop:",
            help="What is done is kept; Resume goes on from there.",
        )
    elif stand.ended < stand.total or stand.state != "done":
        st.button(
            "Resume",
            on_click=resume,
            args=(shelf, folder),
            key="resume_study",
            icon=":material/play_arrow:",
            disabled=shelf.live() is not None,
            help="Runs what is not done yet, and nothing twice.",
        )
    elif stand.failed:
        st.button(
            "Try failed runs again",
            on_click=resume,
            args=(shelf, folder, True),
            key="retry_study",
            icon=":material/refresh:",
            disabled=shelf.live() is not None,
        )
