"""The Vehicles page in a real browser: found by its address, a vehicle picked, its refusal read."""

import re

from playwright.sync_api import Browser, Page, expect

from tests.browser.conftest import serving, visiting
from tests.browser.live import QUIET_MS, SETTLED, at_rest


def settled(page: Page) -> None:
    for _ in range(2):
        page.wait_for_selector(SETTLED)
        page.wait_for_timeout(QUIET_MS)


def press(page: Page, key: str) -> None:
    page.locator(f".st-key-{key} button").first.click()
    settled(page)


def run_to_end(page: Page) -> None:
    press(page, "finish")
    page.get_by_text("24 of 24").wait_for()
    settled(page)


def test_a_cold_link_to_a_vehicle_leads_to_its_refusal(browser: Browser) -> None:
    with serving() as fresh, visiting(browser) as page:
        page.goto(f"{fresh}/vehicles?vehicle=PEV-048")
        expect(page.get_by_text("Nobody has asked for a charge yet")).to_be_visible()
        settled(page)
        run_to_end(page)
        expect(page.get_by_text("99 vehicles asked in all")).to_be_visible()
        detail = page.locator(".st-key-vehicle_detail")
        expect(detail).to_contain_text("Answer: no")
        expect(detail).to_contain_text("would have")
        expect(detail).to_contain_text("Refused because")
        assert "vehicle=PEV-048" in page.url


def test_a_row_is_clicked_filtered_and_sorted(browser: Browser, server: str) -> None:
    with visiting(browser) as page:
        page.goto(f"{server}/vehicles")
        page.locator(".st-key-first_step button").wait_for()
        run_to_end(page)
        page.get_by_role("radio", name="Refused").click()
        expect(page.get_by_text(re.compile(r"^48 of 99 vehicles"))).to_be_visible()
        page.get_by_role("tab", name="Table").click()
        settled(page)
        box = at_rest(page.get_by_label(re.compile("Vehicles listed")).locator("canvas").first)
        page.mouse.click(box["x"] + 16, box["y"] + 52)
        page.locator(".st-key-vehicle_detail").wait_for()
        settled(page)
        expect(page.locator(".st-key-vehicle_detail")).to_contain_text("refused")
        assert re.search(r"vehicle=PEV-\d+", page.url)
        main = page.locator("[data-testid=stMain]")
        assert main.evaluate("e => e.scrollWidth - e.clientWidth") == 0
        page.get_by_role("radio", name="All", exact=True).click()
        settled(page)
        page.get_by_role("tab", name="Chart").click()
        expect(page.get_by_label(re.compile("Chart of 99 vehicles")).first).to_be_attached()


def test_a_bar_is_clicked(browser: Browser, server: str) -> None:
    with visiting(browser) as page:
        page.goto(f"{server}/vehicles")
        page.locator(".st-key-first_step button").wait_for()
        press(page, "first_step")
        press(page, "step")
        chart = page.locator(".st-key-chart_fleet")
        chart.locator(".barlayer path").first.wait_for()
        line = chart.locator(".ytick text, .yaxislayer-above text").filter(has_text="PEV-003")
        box, plot = line.first.bounding_box(), chart.locator(".nsewdrag").first.bounding_box()
        assert box is not None
        assert plot is not None
        at_two = plot["width"] * 2 / (24 * 1.085)  # the axis has room for words at its end
        page.mouse.click(plot["x"] + at_two, box["y"] + box["height"] / 2)
        expect(page.locator(".st-key-vehicle_detail")).to_contain_text("PEV-003")
        settled(page)
        assert "vehicle=PEV-003" in page.url


def test_dark_mode_and_the_plan_of_a_vehicle(browser: Browser, server: str) -> None:
    with visiting(browser, "dark") as page:
        page.goto(f"{server}/vehicles?vehicle=PEV-021")
        page.locator(".st-key-first_step button").wait_for()
        run_to_end(page)
        detail = page.locator(".st-key-vehicle_detail")
        expect(detail).to_contain_text("charged in full")
        expect(detail.get_by_label(re.compile("Map of the plan of PEV-021"))).to_be_attached()
        detail.get_by_text("As a table").first.click()
        settled(page)
        expect(detail.get_by_label("The numbers of the vehicle chart").first).to_be_attached()
