"""Where a finished day is handed on: a button on every page that shows a run."""

import streamlit as st

from evdash.ui.session import Session


def hand_on(session: Session) -> None:
    """The button on every page and, once opened, all that a finished day can be handed on as."""
    box = st.popover(
        "Hand on",
        key="handon",
        icon=":material/ios_share:",
        help="Report, workbook, the run's files, OCPP profiles, a pandapower network.",
        on_change="rerun",
    )
    if not box.open:
        return
    # what reports are made of takes a second to import, and no first page is to wait for it
    from evdash.ui.handon import files  # noqa: PLC0415

    with box, st.container(key="handon_body"):
        files.body(session)
