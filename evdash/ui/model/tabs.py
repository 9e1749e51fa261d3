"""The sections of the Model page; only the one that is open is worked out."""

import streamlit as st

from evdash.ui.glossary import GLOSSARY, meaning
from evdash.ui.model import equations, paper, study
from evdash.ui.session import Session
from evdash.ui.words import decided_by, plain

TABS = (
    "Equations with this run's numbers",
    "Assumptions",
    "The paper's figures",
    "A hundred days",
    "Glossary",
)
INTRODUCTION = (
    "In every interval the station solves one optimisation problem, **P1**: which newcomers get a "
    "contract, and who charges when and with how much power, so that profit is highest and no "
    "limit of chargers or feeder is exceeded. Here it is, equation by equation, numbered as in the "
    "paper by Sahani, Singh and Liu."
)


def tabs(session: Session) -> None:
    """All sections."""
    found = st.tabs(TABS, key="model_tabs", on_change="rerun")
    sections = (in_numbers, paper.assumptions, paper.figures, study.study, glossary)
    of_the_run = (in_numbers, paper.figures)
    for tab, section in zip(found, sections, strict=True):
        if tab.open:
            with tab:
                if section in of_the_run and (who := decided_by(session.run.trace.policy)):
                    st.caption(f"This day is {who} and not by P1: the numbers are of its plans.")
                section(session)


def in_numbers(session: Session) -> None:
    """P1 with this run's numbers in it."""
    st.markdown(INTRODUCTION, help=f"{meaning('P1')} {meaning('MILP')}")
    equations.equations(session)


def glossary(_session: Session) -> None:
    """Every word of the field that the app uses."""
    typed = st.text_input(
        "Look for",
        key="glossary_search",
        placeholder="headroom",
        width=320,
        help="Words and their meanings that contain this are shown.",
    )
    wanted = (typed or "").strip().lower()
    found = {
        term: told
        for term, told in GLOSSARY.items()
        if wanted in term.lower() or wanted in told.lower()
    }
    with st.container(key="glossary"):
        if found:
            terms, columns = list(found.items()), st.columns(2, gap="large")
            half = -(-len(terms) // 2)
            for column, part in zip(columns, (terms[:half], terms[half:]), strict=True):
                with column:
                    for term, told in part:
                        st.markdown(f"**{plain(term)}**  \n{plain(told)}")
        else:
            st.caption(f"No word here has “{plain(wanted)}” in it.")
