"""A part that asks for its own run just after a page's has ended, most of which is still unsent.

The page of these tests has the server's event loop wait until its own run is over, and only then
take up what the part asks: what a machine with too much to do makes happen now and then.
"""

import asyncio
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from benchmarks.crowd.server import ROOT, serving
from benchmarks.crowd.visitor import Visitor

APP = """
import threading
import streamlit as st
from streamlit.proto.BackMsg_pb2 import BackMsg
from streamlit.runtime import Runtime
from streamlit.runtime.scriptrunner import get_script_run_ctx

if __name__ == "__main__":
    from evdash.ui.apart import apart

    def count():
        st.session_state.n = st.session_state.get("n", 0) + 1

    def part():
        st.text("part")

    def ask(by_timer):
        run, ended = get_script_run_ctx(), threading.current_thread()
        session = Runtime.instance()._session_mgr.get_active_session_info(run.session_id).session
        told = BackMsg()
        told.rerun_script.query_string = run.query_string
        told.rerun_script.page_script_hash = run.page_script_hash
        told.rerun_script.fragment_id = next(iter(session._fragment_storage._fragments))
        told.rerun_script.is_auto_rerun = by_timer

        def when_it_has_ended():
            ended.join()
            session.handle_backmsg(told)

        session._event_loop.call_soon_threadsafe(when_it_has_ended)

    drawn = st.session_state.get("n", 0)
    rings = st.button("Count, then the timer rings", on_click=count, key="timer")
    touched = st.button("Count, then the part is touched", on_click=count, key="touch")
    apart(part)()
    if rings or touched:
        ask(by_timer=rings)
    st.text(f"below {drawn}")
    st.text(f"end {drawn}")
else:
    from evdash.ui import unbroken

    unbroken.keep_runs_whole()
    app = st.App(__file__)
"""
PATIENCE_SECONDS = 60.0


async def drawn_after(address: str, key: str) -> list[str]:
    """All texts after a click, as soon as the page has been drawn to its end, or in the end."""
    visitor = Visitor(address)
    await visitor.open()
    await visitor.press(key, wait=False)
    until = time.monotonic() + PATIENCE_SECONDS
    while "end 1" not in visitor.texts() and time.monotonic() < until:
        await asyncio.sleep(0.05)
    await visitor.close()
    return [text for text in visitor.texts() if text.partition(" ")[0] in {"part", "below", "end"}]


@pytest.mark.parametrize("key", ["timer", "touch"])
def test_a_part_that_asks_too_early_leaves_the_page_whole(tmp_path: Path, key: str) -> None:
    app = tmp_path / "app.py"
    app.write_text(APP, encoding="utf-8")
    with serving(tmp_path, app=app) as server, ThreadPoolExecutor(1) as thread:
        shown = thread.submit(asyncio.run, drawn_after(server.address, key)).result()
    assert shown == ["part", "below 1", "end 1"]


def test_the_app_keeps_runs_whole() -> None:
    program = (
        "import app; from evdash.ui import unbroken; from streamlit.runtime.app_session import "
        "AppSession; assert AppSession._create_scriptrunner is unbroken._begin"
    )
    subprocess.run([sys.executable, "-c", program], cwd=ROOT, check=True)
