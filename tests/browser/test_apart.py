"""Parts of a page that run by themselves, on a server that is slow to send.

The app of these tests holds up its server's event loop while it draws, so that a part's own run
begins before anything of the page's has been sent: what happens by itself on a busy machine.
"""

from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from tests.browser.conftest import serving, visiting

APP = """
import time
import streamlit as st
from streamlit.runtime import Runtime
from evdash.ui.apart import apart, one_click

def count():
    st.session_state.n = st.session_state.get("n", 0) + 1

def part(name):
    st.text(f"part {name}")

drawn = st.session_state.get("n", 0)
st.button("Count", on_click=one_click(count), key="count")
time.sleep(0.5)
if drawn:
    loop = Runtime.instance()._get_async_objs().eventloop
    loop.call_soon_threadsafe(time.sleep, 0.5)
    time.sleep(0.1)
apart(part, 0.05)("one")
st.text(f"between {drawn}")
apart(part, 0.05)("two")
st.text(f"below {drawn}")
st.text("end")
"""


@pytest.fixture(scope="module")
def slow_server(tmp_path_factory: pytest.TempPathFactory):
    app = Path(tmp_path_factory.mktemp("apart")) / "app.py"
    app.write_text(APP, encoding="utf-8")
    with serving(app=app) as address:
        yield address


def test_parts_keep_their_place_and_clicks_count_once(browser: Browser, slow_server: str) -> None:
    with visiting(browser) as page:
        page.goto(slow_server)
        texts = page.locator("[data-testid=stText]")
        for drawn in range(6):
            shown = ["part one", f"between {drawn}", "part two", f"below {drawn}", "end"]
            expect(texts).to_have_text(shown)
            page.wait_for_timeout(700)  # parts have run again, and more than once
            expect(texts).to_have_text(shown)
            page.locator(".st-key-count button").click()
