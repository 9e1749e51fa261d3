"""The race on the Compare page in a real browser: start, watch, read, and stop."""

from filelock import FileLock
from playwright.sync_api import Page, expect

from evdash.ui.race.racing import QUEUE
from tests.browser.live import LivePage

PATIENCE_MS = 240_000


def choose(page: Page, *left_out: str) -> None:
    """Leave policies out of the race."""
    for title in left_out:
        pill = page.locator(".st-key-race_policies").get_by_role("button", name=title, exact=True)
        pill.click()


def test_policies_race_beside_the_page(live: LivePage) -> None:
    page = live.page
    page.goto(page.url.split("?")[0].rstrip("/") + "/compare")
    start = page.get_by_role("button", name="Race", exact=True)
    start.wait_for(timeout=PATIENCE_MS)
    choose(page, "Oracle", "bid-price", "First come, first served", "Earliest deadline first")
    start.click()
    page.locator(".st-key-race_figures").wait_for(timeout=PATIENCE_MS)
    told = page.locator(".st-key-race_told")
    expect(told).to_contain_text("charging exceeds limits")
    for chart in ("profit", "load"):
        expect(page.locator(f".st-key-chart_race_{chart} .js-plotly-plot")).to_have_count(1)
    figures = page.locator(".st-key-race_figures")
    for head in ("P1, the paper's", "Least laxity first", "Uncoordinated"):
        expect(figures).to_contain_text(head)

    with FileLock(QUEUE):  # as if somebody else's race were on: ours cannot end by itself
        start.click()
        stop = page.get_by_role("button", name="Stop the race")
        page.get_by_text("Its turn comes next").wait_for(timeout=PATIENCE_MS)
        stop.click()
        start.wait_for(timeout=PATIENCE_MS)
    expect(figures).to_be_visible()  # what the last race showed stays
