"""What every page begins with: the page's settings, look, and the way in by a deep link."""

import gc
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path

import streamlit as st
from streamlit.navigation.page import Page

from evdash.ui.keeping import LINK
from evdash.ui.session import KEY, PRESET, Session
from evdash.ui.studies import mine

ICON = Path(__file__).with_name("icon.svg")
STYLE = """
<style>
[data-testid="stMainBlockContainer"] { padding: 2.4rem 1.6rem 2rem; }
[data-testid="stHeader"] { height: 2.4rem; min-height: 2.4rem; }
[data-testid="stSidebarHeader"] { height: 2.2rem; margin-bottom: 0; }
[data-testid="stSidebarUserContent"] { padding-bottom: 1rem; }
.st-key-clock { margin-top: -.8rem; }
.st-key-clock p { font-size: 2.5rem; line-height: 2.5rem; font-weight: 700; margin: 0;
  font-variant-numeric: tabular-nums; }
.st-key-sentence p { font-size: 1.2rem; line-height: 1.35; }
.st-key-live { gap: .5rem; }
.st-key-prompts button { min-height: 2rem; padding: .1rem .6rem; }
.st-key-figures [data-testid="stMetricLabel"] { min-height: 1.2rem; }
.st-key-schedule, .st-key-decision { gap: .4rem; }
.st-key-table_requests { margin-top: .4rem; }
.st-key-schedule h4, .st-key-decision h4 { padding: 0 0 .6rem; font-size: 1.2rem; }
.st-key-handon_body { width: min(40rem, 88vw); gap: .6rem; }
[data-testid="stMarkdownContainer"] table { width: 100%; font-size: .9rem; margin: 0; }
[data-testid="stMarkdownContainer"] :is(th, td) { padding: .22rem .45rem;
  white-space: nowrap; }
.st-key-figures [data-testid="stMetricValue"] { font-variant-numeric: tabular-nums; }
/* Beside an open sidebar a small window has no room for two columns of charts. */
@media screen and (max-width: 1100px) {
  [data-testid="stMain"] [data-testid="stColumn"] { min-width: 100%; }
}
/* Text of charts in the grey called INK has the colour of the page's own, in either theme. */
.stPlotlyChart svg text[style*="fill: rgb(125, 125, 126)"] { fill: currentColor !important; }
@media print {
  [data-testid="stSidebar"], [data-testid="stHeader"], .modebar-container,
  .st-key-toolbar button, .st-key-prompts, .st-key-why, [data-testid="stExpander"],
  [data-testid="stElementToolbar"], [data-testid="stTooltipIcon"] { display: none !important; }
  [data-testid="stApp"], [data-testid="stMain"], [data-testid="stAppViewContainer"] {
    position: static !important; overflow: visible !important; height: auto !important; }
  [data-testid="stMainBlockContainer"] { padding: 0 !important; }
  [data-testid="stPlotlyChart"], .st-key-decision, .st-key-figures,
  [data-testid="stHorizontalBlock"] { break-inside: avoid; }
  [data-testid="stHorizontalBlock"]:has(> [data-testid="stColumn"]) {
    display: flex !important; flex-flow: row nowrap !important; }
  [data-testid="stHorizontalBlock"] > [data-testid="stColumn"] { min-width: 0 !important; }
}
/* Charts keep their width on paper; side by side they need this much. Printers shrink it to A4. */
@page { size: A3 landscape; margin: 12mm; }
</style>
"""


BEGUN, GOAL = "evdash:begun", "evdash:goal"


def begin() -> None:
    """Settings and look of the page; the first Streamlit calls of a run."""
    st.session_state[BEGUN] = True
    st.set_page_config(page_title="evdash", page_icon=ICON, layout="wide")
    st.html(STYLE)
    freeze()


def navigation(groups: Mapping[str, Sequence[Page]]) -> Page:
    """The bar of all pages in their groups, and the page to show."""
    return st.navigation({name: pages for name, pages in groups.items() if pages}, position="top")


def keep_address() -> None:
    """Have the address say which run this is, also after a change or a link to another page."""
    mine.keep_address()
    session: Session | None = st.session_state.get(KEY)
    if session is None:
        return  # what the address says is still to be read
    folder = session.run.folder
    truth = {PRESET: folder.name if folder else "", LINK: session.keeper.link}
    for name, value in truth.items():
        if value and st.query_params.get(name) != value:
            st.query_params[name] = value
        elif not value:
            st.query_params.pop(name, None)


def by_way_of_app(page: str) -> None:
    """Make sure that `app.py` comes first; the first line of every page.

    If a server's very first visitor asks for a page other than `/`, Streamlit runs that page's
    file alone. Then the goal is remembered, with the query, and the app goes on to it.
    """
    if BEGUN not in st.session_state:
        st.session_state[GOAL] = page
        st.switch_page("app.py", query_params=st.query_params.to_dict())
    keep_address()


def go_on(shown: str) -> None:
    """Switch to the page remembered by `by_way_of_app`, unless it is the one about to be shown."""
    goal = st.session_state.pop(GOAL, shown)
    if goal != shown:
        st.switch_page(goal, query_params=st.query_params.to_dict())


@lru_cache(maxsize=1)
def freeze() -> None:
    """Take what the imports brought along out of the garbage collector's way, once."""
    gc.freeze()
