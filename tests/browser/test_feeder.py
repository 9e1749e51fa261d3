"""The Feeder page in a real browser: found by its address, its hour moved, its verdict read."""

import re

from playwright.sync_api import Browser, Page, expect

from tests.browser.conftest import serving, visiting
from tests.browser.live import LivePage
from tests.browser.test_vehicles import press, run_to_end, settled

CHARTS = ("feeder", "voltage_map", "headroom", "ac_gap")


def opened(page: Page, address: str) -> Page:
    page.goto(address)
    page.locator(".st-key-chart_ac_gap .main-svg").first.wait_for()
    settled(page)
    return page


def move_hour(page: Page, key: str, times: int) -> None:
    page.get_by_role("slider").first.focus()
    for _ in range(times):
        page.keyboard.press(key)
        page.wait_for_timeout(50)
    settled(page)


def test_a_cold_link_and_the_hour_moved(browser: Browser) -> None:
    with serving() as fresh, visiting(browser) as page:
        opened(page, f"{fresh}/feeder")
        moment = page.locator(".st-key-feeder_moment")
        expect(moment).to_contain_text("00:00–01:00 · planned")
        move_hour(page, "ArrowRight", 18)
        expect(moment).to_contain_text("18:00–19:00 · planned")
        expect(moment).to_contain_text("633–634")
        press(page, "step")
        expect(moment).to_contain_text("00:00–01:00 · executed")
        expect(moment).to_contain_text("By AC power flow")
        for name in CHARTS:
            expect(page.locator(f".st-key-chart_{name} .js-plotly-plot")).to_have_count(1)
        for text in ("One-line drawing", "Voltages of", "Bars of the room", "Lowest voltage by"):
            expect(page.get_by_label(re.compile(text)).first).to_be_attached()


def test_what_charging_breaks_in_ac_is_never_hidden(browser: Browser, server: str) -> None:
    with visiting(browser, "dark") as page:
        opened(page, f"{server}/feeder?preset=voltage-limited")
        run_to_end(page)
        page.get_by_text("By AC power flow, charging exceeds 8 limits").first.wait_for()
        settled(page)
        expect(page.get_by_text("Because of charging", exact=True)).to_be_visible()
        move_hour(page, "ArrowLeft", 6)
        expect(page.locator(".st-key-feeder_moment")).to_contain_text(
            "the lowest voltage allowed at node 652"
        )
        page.get_by_text("Difference").first.click()
        settled(page)
        drawing = page.locator(".st-key-chart_feeder")
        expect(drawing.get_by_text("Carries charging")).to_be_visible()
        for width in (1366, 1920):
            page.set_viewport_size({"width": width, "height": 900})
            settled(page)
            main = page.locator("[data-testid=stMain]")
            assert main.evaluate("e => e.scrollWidth - e.clientWidth") == 0


def test_the_run_is_the_live_pages(live: LivePage) -> None:
    page = live.step_to(3).page
    page.get_by_text("Learn", exact=True).first.click()
    page.locator("[data-testid=stTopNavDropdownLink]").filter(has_text="Feeder").click()
    page.locator(".st-key-chart_ac_gap .main-svg").first.wait_for()
    settled(page)
    expect(page.locator(".st-key-clock")).to_have_text("03:00")
    expect(page.locator(".st-key-feeder_moment")).to_contain_text("02:00–03:00 · executed")
