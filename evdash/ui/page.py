"""What every page begins with: the page's settings, look, and the way in by a deep link."""

import gc
from functools import lru_cache
from pathlib import Path

import streamlit as st

ICON = Path(__file__).with_name("icon.svg")
STYLE = """
<style>
[data-testid="stMainBlockContainer"] { padding: 2.4rem 1.6rem 2rem; }
[data-testid="stHeader"] { height: 2.4rem; min-height: 2.4rem; }
[data-testid="stSidebarHeader"] { height: 2.2rem; margin-bottom: 0; }
[data-testid="stSidebarUserContent"] { padding-bottom: 1rem; }
.st-key-clock p { font-size: 2.5rem; line-height: 1; font-weight: 700; margin: 0;
  font-variant-numeric: tabular-nums; }
.st-key-sentence p { font-size: 1.3rem; line-height: 1.4; }
.st-key-figures [data-testid="stMetricValue"] { font-variant-numeric: tabular-nums; }
</style>
"""


def begin() -> None:
    """Settings and look of the page; the first Streamlit calls of a run."""
    st.set_page_config(page_title="evdash", page_icon=ICON, layout="wide")
    st.html(STYLE)
    freeze()


@lru_cache(maxsize=1)
def freeze() -> None:
    """Take what the imports brought along out of the garbage collector's way, once."""
    gc.freeze()
