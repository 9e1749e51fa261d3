"""The settings and the look of every page. Imports little: this reaches the browser first."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import streamlit as st

from evdash.charts.drawn import Drawn

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
.st-key-outcome { gap: .4rem; }
/* A count is stepped by two buttons inside its field, on the right. */
[class*="st-key-typed-"] { position: relative; }
[data-testid="stLayoutWrapper"]:has(> [class*="st-key-steps-"]) { position: absolute;
  right: .25rem; bottom: 0; width: auto; }
[class*="st-key-steps-"] button { min-height: 2.5rem; padding: 0 .45rem; }
.st-key-prompts button { min-height: 2rem; padding: .1rem .6rem; }
.st-key-figures [data-testid="stMetricLabel"] { min-height: 1.2rem; }
.st-key-schedule, .st-key-decision { gap: .4rem; }
.st-key-table_requests { margin-top: .4rem; }
.st-key-schedule h4, .st-key-decision h4 { padding: 0 0 .6rem; font-size: 1.2rem; }
.st-key-handon_body { width: min(40rem, 88vw); gap: .6rem; }
[data-testid="stMarkdownContainer"] table { width: 100%; font-size: .9rem; margin: 0; }
[data-testid="stMarkdownContainer"] :is(th, td) { padding: .22rem .45rem;
  white-space: nowrap; }
.st-key-outcome table { margin-bottom: 1rem; }
.st-key-figures [data-testid="stMetricValue"] { font-variant-numeric: tabular-nums; }
.st-key-fetch, [data-testid="stLayoutWrapper"]:has(> .st-key-fetch) { display: none; }
@media screen { [data-testid="stLayoutWrapper"]:has(> .st-key-on_paper) { display: none; } }
/* Beside an open sidebar a small window has no room for two columns of charts. */
@media screen and (max-width: 1100px) {
  [data-testid="stMain"] [data-testid="stColumn"] { min-width: 100%; }
}
/* Text of charts in the grey called INK has the colour of the page's own, in either theme. */
.stPlotlyChart svg text[style*="fill: rgb(125, 125, 126)"] { fill: currentColor !important; }
@media print {
  [data-testid="stSidebar"], [data-testid="stHeader"], .modebar-container,
  .st-key-toolbar button, .st-key-prompts, .st-key-why, .st-key-signed_in,
  [data-testid="stExpander"],
  [data-testid="stElementToolbar"], [data-testid="stTooltipIcon"], [role="tooltip"],
  [data-testid="stTooltipContent"] { display: none !important; }
  [data-testid="stApp"], [data-testid="stMain"], [data-testid="stAppViewContainer"] {
    position: static !important; overflow: visible !important; height: auto !important; }
  [data-testid="stMainBlockContainer"] { padding: 0 !important; zoom: .85; }
  [data-testid="stLayoutWrapper"]:has(> [data-testid="stVerticalBlock"][overflow="auto"]),
  [data-testid="stVerticalBlock"][overflow="auto"] {
    height: auto !important; max-height: none !important; overflow: visible !important;
    margin-bottom: 3rem; }
  [data-testid="stPlotlyChart"], .st-key-figures, tr { break-inside: avoid; }
  h4 { break-after: avoid; }
  [data-testid="stHorizontalBlock"]:has(> [data-testid="stColumn"]) {
    display: flex !important; flex-flow: row nowrap !important; }
  [data-testid="stHorizontalBlock"] > [data-testid="stColumn"] { min-width: 0 !important; }
}
/* Charts keep their width on paper; side by side they need this much. Printers shrink it to A4. */
@page { size: A3 landscape; margin: 12mm; }
</style>
"""


def begin() -> None:
    """Settings and look of the page; the first Streamlit calls of a run."""
    st.set_page_config(page_title="evdash", page_icon=ICON, layout="wide")
    st.html(STYLE)


@contextmanager
def while_fetching() -> Iterator[None]:
    """Have the browser fetch what draws charts, the largest thing it needs, meanwhile.

    For that it is given a chart that is never seen and soon gone again. A server that was just
    started imports the rest of the app at the same time.
    """
    with st.container(key="fetch"):
        place = st.empty()
    if FETCHED not in st.session_state:
        place.plotly_chart(Drawn({"data": [], "layout": {"font": {}}}))
    yield
    if FETCHED not in st.session_state:
        place.empty()
    st.session_state[FETCHED] = True


FETCHED = "evdash:fetched"
