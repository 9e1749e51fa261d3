"""How long a person waits: first page of a cold server, and step to settled charts.

    python -m benchmarks.ui_steps [CASE ...]

Drives a real browser against a real server and prints a table in Markdown. A step counts from
the click until the script has ended and every chart's drawing has been quiet for two frames. A
CASE is a preset, or `200x96`: 200 vehicles in quarter hours. The first row is a page of a clock
and a button alone: what the browser and the server take on this machine before there is anything
to show, so that runs on machines of different load can be compared.
"""

import math
import statistics
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from playwright.sync_api import Browser, Page, sync_playwright

from benchmarks.cases import in_quarter_hours
from evdash.files.bundled import DEFAULT
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import start_day
from evdash.store.journal import Journal
from evdash.store.parts import Kept
from evdash.store.runs import Store
from tests.browser.conftest import CHROMIUM, FLAGS, serving
from tests.browser.live import LivePage

STEPS = 24
MANY, BARE = "200x96", "clock and button"
TARGETS = {
    DEFAULT.name: "4 s, p50 ≤ 300 ms, p95 ≤ 450 ms",
    MANY: "p50 ≤ 500 ms",
}
LAST_CHART = ".st-key-chart_voltages .main-svg"
BARE_PAGE = """
import streamlit as st
st.session_state.setdefault("n", 0)
def step(): st.session_state.n += 1
with st.container(key="clock"):
    st.markdown(f"{st.session_state.n:02d}:00")
st.button("Step", on_click=step, key="step")
"""
# The clock shows the new time only once the new run has drawn it; the charts come after it.
SETTLED = """async before => {
  const app = document.querySelector('[data-testid=stApp]');
  const clock = () => document.querySelector('.st-key-clock').innerText.trim();
  const start = performance.now();
  let last = start;
  const watch = new MutationObserver(() => { last = performance.now(); });
  document.querySelector('.st-key-step button').click();
  watch.observe(document.body, {subtree: true, childList: true, attributes: true});
  const idle = () => app.dataset.testScriptState === 'notRunning' && clock() !== before;
  while (!idle() || performance.now() - last < 34) {
    await new Promise(frame => requestAnimationFrame(frame));
    if (performance.now() - start > 20000) { break; }
  }
  watch.disconnect();
  return last - start;
}"""


@contextmanager
def serving_case(case: str) -> Iterator[tuple[str, str, str]]:
    """A fresh server for a case: its address, the way to it, and what is drawn last."""
    with TemporaryDirectory() as folder:
        if case == BARE:
            script = Path(folder) / "bare.py"
            script.write_text(BARE_PAGE, encoding="utf-8")
            with serving(folder, script) as address:
                yield address, "/", ".st-key-step button"
            return
        query = f"run={kept_link(folder)}" if case == MANY else f"preset={case}"
        with serving(folder) as address:
            yield address, f"/?{query}", LAST_CHART


def kept_link(folder: str) -> str:
    """The link of a day of 200 vehicles in 96 quarter hours, put where the server looks."""
    settings = {"arrivals.vehicles_per_day": 200.0, "station.chargers": 60}
    scenario = in_quarter_hours(edit_scenario(read_scenario(DEFAULT), settings))
    journal = Journal(Store(Path(folder)))
    journal.keep(Kept("", scenario, start_day(scenario)))
    journal.store.database.close()
    return journal.link


def first_page_seconds(page: Page, address: str, drawn_last: str) -> float:
    """From the address to the last chart."""
    began = time.perf_counter()
    page.goto(address)
    page.locator(drawn_last).first.wait_for(timeout=60_000)
    return time.perf_counter() - began


def step_milliseconds(live: LivePage) -> list[float]:
    """Each step of a day, from click to settled."""
    waits = []
    for _ in range(STEPS):
        clock = live.page.locator(".st-key-clock").inner_text().strip()
        waits.append(float(live.page.evaluate(SETTLED, clock)))
        live.page.wait_for_timeout(300)  # think time
    return waits


def measure(browser: Browser, case: str) -> None:
    """Print one row: a fresh server for each case; of a long day its last steps, the fullest."""
    with serving_case(case) as (address, path, drawn_last):
        page = browser.new_page(viewport={"width": 1366, "height": 768})
        first = first_page_seconds(page, f"{address}{path}", drawn_last)
        page.wait_for_timeout(6000)  # the AC power flow loads behind the first page
        live = LivePage(page, address)
        if case == MANY:
            page.locator(".st-key-finish button").first.click()
            page.get_by_text("The day is over").first.wait_for(timeout=120_000)
            for _ in range(STEPS):
                live.press("undo")
        waits = sorted(step_milliseconds(live))
        page.close()
    p50, p95 = statistics.median(waits), waits[math.ceil(0.95 * len(waits)) - 1]
    target = TARGETS.get(case, "")
    cells = f"{first:.1f}", f"{p50:.0f}", f"{p95:.0f}", f"{waits[-1]:.0f}", target
    print(f"| {case} | {' | '.join(cells)} |", flush=True)


def main(cases: list[str]) -> None:
    """Measure the cases named, or those that matter most."""
    print("| case | first page of a cold server, s | p50, ms | p95, ms | worst, ms | asked for |")
    print("| --- | --- | --- | --- | --- | --- |")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        for case in cases or [BARE, DEFAULT.name, "voltage-limited", MANY]:
            measure(browser, case)
        browser.close()


if __name__ == "__main__":
    main(sys.argv[1:])
