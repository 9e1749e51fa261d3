"""One run through all pages, as a lecturer goes: every page shows what the last one left."""

import re

from playwright.sync_api import Browser, Page, expect

from tests.browser.conftest import serving, visiting
from tests.browser.live import LivePage, at_rest
from tests.browser.test_feeder import move_hour
from tests.browser.test_plan import downloaded, go, press, settle

ADMITTED = re.compile(r"(\d+) of (\d+) PEVs admitted")


def test_one_run_through_all_pages(browser: Browser) -> None:
    with serving() as address, visiting(browser) as page:
        live = LivePage(page, address).open()
        expect(live.sentence).to_contain_text("The day is about to begin")
        live.page.get_by_role("radio", name="Spike").click()
        live.settled()
        live.type("Chargers", "9").type("C1 price, $/kWh", "0.4").type("Arrival seed", "7")
        live.step_to(3)
        page.reload()  # in mid-run: the address brings it back
        live.shows(3).settled()
        expect(live.field("Chargers")).to_have_value("9")
        expect(live.field("C1 price, $/kWh")).to_have_value("0.4")
        expect(live.field("Arrival seed")).to_have_value("7")
        live.step_to(5)
        live.press("finish").shows(0)
        expect(live.sentence).to_contain_text(ADMITTED)
        found = ADMITTED.search(live.sentence.inner_text())
        assert found is not None
        admitted, asked = (int(number) for number in found.groups())
        assert 0 < admitted < asked
        _vehicles(page, asked - admitted, asked)
        _feeder(page)
        _compare(live, admitted)
        _scenario(page)


def _vehicles(page: Page, refused: int, asked: int) -> None:
    go(page, "Learn", "Vehicles")
    page.get_by_role("radio", name="Refused").click()
    expect(page.get_by_text(re.compile(rf"^{refused} of {asked} vehicles"))).to_be_visible()
    settle(page)
    page.get_by_role("tab", name="Table").click()
    settle(page)
    box = at_rest(page.get_by_label(re.compile("Vehicles listed")).locator("canvas").first)
    page.mouse.click(box["x"] + 16, box["y"] + 52)
    detail = page.locator(".st-key-vehicle_detail")
    expect(detail).to_contain_text("Answer: no")
    expect(detail).to_contain_text("Refused because")


def _feeder(page: Page) -> None:
    go(page, "Learn", "Feeder")
    moment = page.locator(".st-key-feeder_moment")
    expect(moment).to_contain_text("executed")
    before = moment.get_by_role("heading").first.inner_text()
    move_hour(page, "ArrowLeft", 2)
    expect(moment.get_by_role("heading").first).not_to_have_text(before)


def _compare(live: LivePage, admitted: int) -> None:
    page = live.page
    go(page, "Plan", "Compare")
    press(page, "pin")
    go(page, "Learn", "Live")
    live.settled().press("reset")
    live.type("Chargers", "3").press("finish").shows(0)
    go(page, "Plan", "Compare")
    row = page.locator(".st-key-compare_figures").locator("tr", has_text="Admitted")
    expect(row).to_contain_text(f"{admitted}")
    expect(row).to_contain_text("−")
    expect(page.get_by_text("station.chargers").first).to_be_visible()


def _scenario(page: Page) -> None:
    go(page, "Plan", "Scenario")
    chargers = page.get_by_role("textbox", name="How many vehicles can charge")
    expect(chargers).to_have_value("3")
    first = downloaded(page)
    upload = {"name": "mine.zip", "mimeType": "application/zip", "buffer": first}
    page.locator(".st-key-scenario_upload input[type=file]").set_input_files(upload)
    page.get_by_text("mine.zip replaced the whole scenario").wait_for()
    settle(page)
    assert downloaded(page) == first
