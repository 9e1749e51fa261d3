"""Studies in a real browser: from a question to its picture, while somebody else steps a day."""

import io
import re
import zipfile

import pytest
from playwright.sync_api import Browser, Page, TimeoutError, expect

from tests.browser.conftest import serving, visiting
from tests.browser.live import SETTLED, LivePage

RUNNING = re.compile(r"\d+ of 1,000 runs, about")
PATIENCE_MS = 240_000
TRIES = 6


@pytest.fixture(scope="module")
def own_server():
    """A server whose runs and studies are its own: what runs beside it is known."""
    with serving() as address:
        yield address


def settle(page: Page) -> None:
    for _ in range(3):
        page.wait_for_selector(SETTLED, timeout=PATIENCE_MS)
        page.wait_for_timeout(200)


def ask(page: Page, question: str, days: int) -> None:
    box, option = page.locator(".st-key-question"), page.get_by_role("option", name=question)
    for _ in range(TRIES):  # a page drawn anew just then closes the list again
        box.get_by_role("combobox").first.click()
        try:
            option.first.click(timeout=5_000)
        except TimeoutError:
            page.keyboard.press("Escape")
            settle(page)
        else:
            break
    settle(page)
    expect(box.get_by_role("combobox").first).to_have_value(question, timeout=PATIENCE_MS)
    field = page.get_by_role("textbox", name="Days at every point")
    field.fill(f"{days}")
    field.press("Enter")
    settle(page)


def press(page: Page, key: str) -> None:
    page.locator(f".st-key-{key} button").first.click()
    settle(page)


def opened(page: Page, address: str) -> LivePage:
    page.goto(address)
    page.locator(".st-key-chart_voltages .main-svg").first.wait_for(timeout=PATIENCE_MS)
    settle(page)
    return LivePage(page, address)


def step_through(live: LivePage, hours: range) -> None:
    for hour in hours:
        live.press("step")  # and wait: Streamlit drops a click on a page that is being drawn
        expect(live.page.locator(".st-key-clock")).to_have_text(
            f"{hour:02d}:00", timeout=PATIENCE_MS
        )
        live.settled()


def test_from_question_to_picture(browser: Browser, own_server: str) -> None:
    with visiting(browser) as page:
        page.goto(own_server + "/studies")
        settle(page)
        ask(page, "How many chargers?", 2)
        expect(page.get_by_text("12 runs")).to_be_visible()
        press(page, "start_study")
        page.get_by_text("All 12 runs have ended").wait_for(timeout=PATIENCE_MS)
        settle(page)
        expect(page.locator(".st-key-chart_study_bands .main-svg").first).to_be_visible()
        expect(page.get_by_text(re.compile("Profit is highest at chargers"))).to_be_visible()
        with page.expect_download() as waiting:
            page.locator(".st-key-download_study button").first.click()
        archive = zipfile.ZipFile(io.BytesIO(waiting.value.path().read_bytes()))
        names = set(archive.namelist())
        assert {"study/study.toml", "study/runs.csv", "study/summary.csv"} <= names
        assert archive.read("study/runs.csv").count(b",done,") == 12

        ask(page, "Where to put the station?", 1)
        press(page, "start_study")
        page.get_by_text("All 12 runs have ended").wait_for(timeout=PATIENCE_MS)
        settle(page)
        expect(page.locator(".st-key-chart_study_map .main-svg").first).to_be_visible()
        expect(page.locator(".st-key-chart_study_bars .main-svg").first).to_be_visible()


def test_somebody_else_steps_while_a_study_runs(browser: Browser, own_server: str) -> None:
    """Steps do not wait for a study's runs: a dozen are done long before it ends."""
    with visiting(browser) as asking, visiting(browser) as stepping:
        asking.goto(own_server + "/studies")
        settle(asking)
        ask(asking, "How sure is that profit?", 1000)
        press(asking, "start_study")
        asking.get_by_text(RUNNING).wait_for(timeout=PATIENCE_MS)
        step_through(opened(stepping, own_server), range(1, 13))
        expect(asking.get_by_text(RUNNING)).to_be_visible()
        asking.locator(".st-key-cancel_study button").first.click()
        asking.get_by_text(re.compile(r"Cancelled\. \d+ of 1,000 runs")).wait_for(
            timeout=PATIENCE_MS
        )


def test_a_study_outlives_pages_reloads_and_servers(browser: Browser, tmp_path) -> None:
    store = str(tmp_path)
    with serving(store) as address, visiting(browser) as page:
        page.goto(address + "/studies")
        settle(page)
        ask(page, "How sure is that profit?", 1000)
        press(page, "start_study")
        page.get_by_text(re.compile(r"\d+ of 1,000 runs")).wait_for(timeout=PATIENCE_MS)
        page.get_by_test_id("stTopNavSection").filter(has_text="Learn").first.click()
        page.locator("a").filter(has_text="Live").last.click()
        settle(page)
        assert "studies=" in page.url
        link = page.url.partition("studies=")[2].partition("&")[0]
        page.goto(f"{address}/studies?studies={link}")
        page.get_by_text(re.compile(r"\d+ of 1,000 runs")).wait_for(timeout=PATIENCE_MS)
        expect(page.locator(".st-key-start_study button").first).to_be_disabled()
    with serving(store) as address, visiting(browser) as page:
        page.goto(f"{address}/studies?studies={link}")
        page.get_by_text(RUNNING).wait_for(timeout=PATIENCE_MS)
        settle(page)
        press(page, "cancel_study")
        page.get_by_text(re.compile(r"Cancelled\. \d+ of 1,000 runs are done")).wait_for(
            timeout=PATIENCE_MS
        )
        settle(page)
        expect(page.locator(".st-key-chart_study_days .main-svg").first).to_be_visible()
        press(page, "resume_study")
        page.get_by_text(RUNNING).wait_for(timeout=PATIENCE_MS)
        settle(page)
        press(page, "cancel_study")
        page.get_by_text(re.compile(r"Cancelled\.")).wait_for(timeout=PATIENCE_MS)
