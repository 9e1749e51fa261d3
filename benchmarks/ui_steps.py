"""How long a person waits: first page of a cold server, and step to settled charts.

    python -m benchmarks.ui_steps [PRESET ...]

Drives a real browser against a real server and prints a table. A step counts from the click
until the script has ended and every chart's drawing has been quiet for two frames.
"""

import statistics
import sys
import time

from playwright.sync_api import Browser, Page, sync_playwright

from tests.browser.conftest import CHROMIUM, FLAGS, serving
from tests.browser.live import LivePage

STEPS = 24
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


def first_page_seconds(page: Page, address: str) -> float:
    """From the address to the last chart."""
    began = time.perf_counter()
    page.goto(address)
    page.locator(".st-key-chart_voltages .main-svg").first.wait_for(timeout=60_000)
    return time.perf_counter() - began


def step_milliseconds(live: LivePage) -> list[float]:
    """Each step of a day, from click to settled."""
    waits = []
    for _ in range(STEPS):
        clock = live.page.locator(".st-key-clock").inner_text().strip()
        waits.append(float(live.page.evaluate(SETTLED, clock)))
        live.page.wait_for_timeout(300)  # think time
    return waits


def measure(browser: Browser, preset: str) -> None:
    """Print one row: a fresh server for each preset."""
    with serving() as address:
        page = browser.new_page(viewport={"width": 1366, "height": 768})
        first = first_page_seconds(page, f"{address}/?preset={preset}")
        page.wait_for_timeout(6000)  # the AC power flow loads behind the first page
        waits = sorted(step_milliseconds(LivePage(page, address)))
        page.close()
    p50, p95 = statistics.median(waits), waits[int(0.95 * (len(waits) - 1))]
    print(f"{preset:18} {first:12.1f} {p50:10.0f} {p95:10.0f} {waits[-1]:10.0f}")


def main(presets: list[str]) -> None:
    """Measure the presets named, or the two that matter most."""
    print(f"{'preset':18} {'cold page, s':>12} {'p50, ms':>10} {'p95, ms':>10} {'worst, ms':>10}")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        for preset in presets or ["summer-weekday", "voltage-limited"]:
            measure(browser, preset)
        browser.close()


if __name__ == "__main__":
    main(sys.argv[1:])
