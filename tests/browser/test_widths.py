"""What the browser tells by itself never meets what a person asks for.

The browser of these tests can send late, as on a crowded machine: time enough for it to tell how
wide charts are between a click and the page drawn for it.
"""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, expect

from tests.browser.conftest import visiting
from tests.browser.live import LivePage

INSTRUMENTS = """
window.lateMs = 0;
window.sent = 0;
window.clocks = [];
const send = WebSocket.prototype.send;
WebSocket.prototype.send = function (message) {
  window.sent += 1;
  if (window.lateMs) { setTimeout(() => send.call(this, message), window.lateMs); }
  else { send.call(this, message); }
};
const every = window.setInterval;
window.setInterval = (act, ms, ...rest) => {
  if (ms === 700) { window.clocks.push(act); }
  return every(act, ms, ...rest);
};
"""
WIDEN = """document.querySelectorAll(".js-plotly-plot").forEach((c) => { c.layout.width += 1; });"""
TELL = "window.clocks.forEach((tick) => tick());"
MORE_THAN_A_TICK_MS = 2_000


@pytest.fixture
def instrumented(browser: Browser, server: str) -> Iterator[LivePage]:
    with visiting(browser) as page:
        page.add_init_script(INSTRUMENTS)
        live = LivePage(page, server).open()
        page.wait_for_timeout(MORE_THAN_A_TICK_MS)
        live.settled()
        yield live


def sent(live: LivePage) -> int:
    return int(live.page.evaluate("window.sent"))


def test_widths_are_told_once_and_again_when_they_change(instrumented: LivePage) -> None:
    live, page = instrumented, instrumented.page
    before = sent(live)
    page.wait_for_timeout(MORE_THAN_A_TICK_MS)
    assert sent(live) == before  # all are known already
    page.set_viewport_size({"width": 1500, "height": 800})
    page.wait_for_function(f"window.sent === {before + 1}")
    live.press("step").shows(1)
    page.wait_for_timeout(MORE_THAN_A_TICK_MS)
    live.settled()
    before = sent(live)
    page.set_viewport_size({"width": 1400, "height": 800})
    page.wait_for_function(f"window.sent === {before + 1}")  # also after a person's touch


def go_to_feeder(live: LivePage) -> str:
    """Open the list of pages, and give the script that clicks on Feeder."""
    live.page.get_by_test_id("stTopNavSection").filter(has_text="Learn").first.click()
    expect(live.page.locator("a").filter(has_text="Feeder").last).to_be_visible()
    return (
        '[...document.querySelectorAll("a")].findLast((a) => /Feeder/.test(a.innerText)).click();'
    )


def has_opened_whole(live: LivePage) -> None:
    moment = live.page.locator(".st-key-feeder_moment")
    expect(moment).to_be_visible()
    live.page.evaluate("window.lateMs = 0")
    live.page.wait_for_timeout(2 * MORE_THAN_A_TICK_MS)  # what was sent late has arrived, too
    live.settled()
    expect(moment).to_be_visible()


def test_a_page_opens_whole_on_a_server_that_answers_late(instrumented: LivePage) -> None:
    click = go_to_feeder(instrumented)
    instrumented.page.evaluate(f"window.lateMs = {MORE_THAN_A_TICK_MS}")
    instrumented.page.evaluate(f"() => {{ {click} {WIDEN} }}")
    has_opened_whole(instrumented)


def test_a_page_opens_whole_where_widths_are_being_told(instrumented: LivePage) -> None:
    click = go_to_feeder(instrumented)
    instrumented.page.evaluate("window.evdashTab.isAsked = false")  # the list was opened long ago
    instrumented.page.wait_for_timeout(MORE_THAN_A_TICK_MS)
    instrumented.page.evaluate(f"() => {{ {WIDEN} {TELL} {click} }}")
    has_opened_whole(instrumented)


@pytest.mark.parametrize("tells_first", [True, False])
def test_a_click_in_the_moment_of_telling_counts(instrumented: LivePage, tells_first: bool) -> None:
    click = 'document.querySelector(".st-key-step button").click();'
    together = TELL + click if tells_first else click + TELL
    instrumented.page.evaluate(f"() => {{ {WIDEN} {together} }}")
    instrumented.shows(1).settled()
    instrumented.page.wait_for_timeout(MORE_THAN_A_TICK_MS)
    instrumented.settled().shows(1)
