"""Scenario and Compare in a real browser: edit, hand out and take in again, pin and compare."""

import io
import re
import zipfile
from collections.abc import Callable

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.conftest import serving, visiting
from tests.browser.live import SETTLED, LivePage


def settle(page: Page) -> None:
    for _ in range(3):
        page.wait_for_selector(SETTLED)
        page.wait_for_timeout(200)


def go(page: Page, group: str, title: str) -> None:
    page.get_by_test_id("stTopNavSection").filter(has_text=group).first.click()
    page.locator("a").filter(has_text=title).last.click()
    settle(page)


def press(page: Page, key: str) -> None:
    page.locator(f".st-key-{key} button").first.click()
    settle(page)


def fill(page: Page, label: str, value: str) -> None:
    field = page.get_by_role("textbox", name=label)
    field.fill(value)
    field.press("Enter")
    settle(page)


def downloaded(page: Page) -> bytes:
    with page.expect_download() as waiting:
        page.locator(".st-key-download_scenario button").first.click()
    return waiting.value.path().read_bytes()


def test_a_scenario_handed_out_and_taken_in_again_is_the_same(live: LivePage) -> None:
    page = live.page
    go(page, "Plan", "Scenario")
    fill(page, "How many vehicles can charge", "7")
    first = downloaded(page)
    text = zipfile.ZipFile(io.BytesIO(first)).read("summer-weekday/scenario.toml").decode()
    assert "chargers = 7" in text
    page.locator(".st-key-scenario_from").get_by_role("combobox").click()
    page.get_by_role("option", name="Voltage limited").click()
    press(page, "take_scenario")
    expect(page.get_by_role("textbox", name="How many vehicles can charge")).to_have_value("140")
    upload = {"name": "mine.zip", "mimeType": "application/zip", "buffer": first}
    page.locator(".st-key-scenario_upload input[type=file]").set_input_files(upload)
    page.get_by_text("mine.zip replaced the whole scenario").wait_for()
    settle(page)
    expect(page.get_by_role("textbox", name="How many vehicles can charge")).to_have_value("7")
    assert downloaded(page) == first
    press(page, "apply_scenario")
    page.get_by_text("A new day has begun on Summer weekday").wait_for()
    go(page, "Learn", "Live")
    expect(page.get_by_label("Chargers", exact=True)).to_have_value("7")


def test_a_wrong_table_is_told_by_row_and_mended_in_place(live: LivePage) -> None:
    page = live.page
    go(page, "Plan", "Scenario")
    content = b"interval,price_per_kwh,load_pu\n" + b"\n".join(
        f"{t},{'free' if t == 3 else 0.05},0.5".encode() for t in range(24)
    )
    upload = {"name": "profile.csv", "mimeType": "text/csv", "buffer": content}
    page.locator(".st-key-scenario_upload input[type=file]").set_input_files(upload)
    page.get_by_text("1 fault").wait_for()
    settle(page)
    expect(page.get_by_text("profile.csv, row 5, column price_per_kwh").first).to_be_attached()
    page.get_by_role("tab", name="Prices and loads").click()
    settle(page)
    grid = page.get_by_test_id("stDataFrame").last.locator("canvas").first
    grid.scroll_into_view_if_needed()
    box = grid.bounding_box()
    assert box is not None
    # the fourth row below the header, its column of prices
    page.mouse.dblclick(box["x"] + box["width"] * 0.4, box["y"] + 35 * 4.5)
    cell = page.locator("#portal textarea, #portal input, input.gdg-input").first
    cell.fill("0.07")
    cell.press("Enter")
    settle(page)
    expect(page.get_by_text("1 fault")).to_have_count(0)
    expect(page.locator(".st-key-apply_scenario button").first).to_be_enabled()


def test_two_runs_are_pinned_and_compared(live: LivePage) -> None:
    page = live.page
    live.press("finish")
    expect(live.sentence).to_contain_text("51 of 99 PEVs admitted")
    go(page, "Plan", "Compare")
    press(page, "pin")
    go(page, "Learn", "Live")
    live.settled().press("reset")
    live.type("Chargers", "6")
    go(page, "Plan", "Compare")
    page.get_by_text("come to different hours").wait_for()
    name = page.get_by_role("textbox", name="Name for the present run")
    name.fill("Half the chargers")
    name.press("Enter")
    settle(page)
    press(page, "pin")
    press(page, "finish_all")
    expect(page.get_by_text("come to different hours")).to_have_count(0)
    settle(page)
    figures = page.locator(".st-key-compare_figures")
    expect(figures).to_contain_text("Half the chargers")
    expect(figures.locator("tr", has_text="Admitted")).to_contain_text("−")
    expect(page.get_by_text("station.chargers").first).to_be_visible()
    for chart in ("load", "admissions", "voltage"):
        expect(page.locator(f".st-key-chart_compare_{chart} .js-plotly-plot")).to_have_count(1)
    page.get_by_role("radio", name="Headroom").click()
    settle(page)
    page.reload()
    figures.wait_for()
    settle(page)
    expect(figures).to_contain_text("Half the chargers")
    expect(figures.locator("tr", has_text="Admitted")).to_contain_text("−")
    main = page.locator("[data-testid=stMain]")
    assert main.evaluate("e => e.scrollWidth - e.clientWidth") == 0


def see_scenario(page: Page) -> None:
    expect(page.get_by_role("textbox", name="How many vehicles can charge")).to_have_value("140")


def see_compare(page: Page) -> None:
    expect(page.get_by_text("Hold one run against another")).to_be_visible()


def see_studies(page: Page) -> None:
    expect(page.locator(".st-key-question").get_by_role("combobox").first).to_be_visible()
    expect(page.locator(".st-key-start_study button").first).to_be_enabled()


COLD = [("scenario", see_scenario), ("compare", see_compare), ("studies", see_studies)]


@pytest.mark.parametrize(("path", "see"), COLD)
def test_a_cold_deep_link_finds_its_page(
    browser: Browser, path: str, see: Callable[[Page], None]
) -> None:
    with serving() as fresh, visiting(browser) as page:
        page.goto(f"{fresh}/{path}?preset=voltage-limited")
        page.locator(".st-key-scenario_tabs, .st-key-pin, .st-key-question").first.wait_for()
        settle(page)
        see(page)
        assert re.search(rf"/{path}\b", page.url)
