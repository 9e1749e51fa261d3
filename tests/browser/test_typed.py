"""What really reaches us of a number typed or pasted into a browser, and clicks right after it."""

import io
import zipfile
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from tests.browser.conftest import visiting
from tests.browser.live import LivePage, at_rest

READ = {".19": 0.19, "1e-1": 0.1, " 0.5 ": 0.5}
REFUSED = ("4,5", "0,3", "1.234,5", "1,234", "5 kW")


def paste(page: Page, text: str) -> None:
    page.evaluate("text => navigator.clipboard.writeText(text)", text)
    page.keyboard.press("Control+v")
    page.wait_for_timeout(300)  # the grid asks for what is there, and is answered later


def type_over(live: LivePage, text: str) -> None:
    """Type over the cell that is chosen, as fast as a person; the grid loses keys of a robot."""
    live.page.keyboard.type(text, delay=60)
    live.page.wait_for_timeout(200)
    live.page.keyboard.press("Enter")
    live.settled()


def cell(live: LivePage, grid: Locator, share: float, row: int) -> None:
    """Choose a cell of a table by its column, as a share of the width, and its row from 0."""
    grid.scroll_into_view_if_needed()
    box = at_rest(grid)
    live.page.mouse.click(box["x"] + box["width"] * share, box["y"] + 35 * (row + 1.5))
    live.page.wait_for_timeout(200)


@pytest.mark.parametrize("how", ["typed", "pasted"])
def test_a_field_reads_or_refuses_what_is_put_into_it(live: LivePage, how: str) -> None:
    page = live.page
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    bar, price = page.get_by_test_id("stSidebar"), "C1 price, $/kWh"
    expect(page.get_by_test_id("stNumberInput")).to_have_count(0)
    for text in (*READ, *REFUSED):
        live.type(price, "0.35")
        field = live.field(price)
        field.press("Control+a")
        if how == "typed":
            field.press_sequentially(text)
        else:
            paste(page, text)
        field.press("Enter")
        live.settled()
        if text in READ:
            expect(field).to_have_value(f"{READ[text]:g}")
        else:
            expect(field).to_have_value(text)
            expect(bar).to_contain_text(f"Found '{text}'; should be a number")
            expect(bar).to_contain_text(f"{price} stays 0.35.")
    live.type("Chargers", "1.5")
    expect(bar).to_contain_text("Found '1.5'; should be a whole number. Chargers stays 12.")


def test_a_cell_of_prices_reads_or_refuses_also_once_it_is_closed(live: LivePage) -> None:
    page = live.page
    page.set_viewport_size({"width": 1920, "height": 1200})
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    opener = page.get_by_role("button", name="Edit prices by the hour")
    opener.click()
    grid = page.locator("[data-testid=stPopoverBody] canvas").first
    bar = page.get_by_test_id("stSidebar")
    for row, text in enumerate((*READ, *REFUSED[:3])):
        cell(live, grid, 0.75, row)
        if row % 2:
            paste(page, text)
            page.keyboard.press("Tab")  # where the cell was open already
            live.settled()
        else:
            type_over(live, text)
        expect(bar).to_contain_text(f"Found '{text}'" if text in REFUSED else "energy price of")
    live.sentence.click()
    expect(page.get_by_test_id("stPopoverBody")).to_have_count(0)
    live.settled()
    expect(bar).to_contain_text("energy price of 3 intervals")
    expect(bar).to_contain_text("Found '4,5'; should be a number, with a point and no commas: 4.5.")
    expect(bar).to_contain_text("The price from 03:00 stays")
    opener.click()
    live.settled()
    cell(live, page.locator("[data-testid=stPopoverBody] canvas").first, 0.75, 3)
    type_over(live, "0.45")
    expect(bar).not_to_contain_text("Found '4,5'")
    expect(bar).to_contain_text("energy price of 4 intervals")


def test_a_step_right_after_typing_and_after_typing_what_is_wrong(live: LivePage) -> None:
    live.field("Chargers").fill("3")
    live.press("step").shows(1)
    expect(live.page.get_by_test_id("stSidebar")).to_contain_text("12 → 3")
    live.field("Chargers").fill("3,5")
    live.press("step").shows(1)
    expect(live.page.get_by_text("Not done")).to_be_visible()
    expect(live.field("Chargers")).to_have_value("3,5")
    live.press("step").shows(2)


def test_a_download_right_after_typing_is_what_is_shown(browser: Browser, server: str) -> None:
    with visiting(browser) as page:
        page.goto(f"{server}/scenario")
        live = LivePage(page, server)
        field = page.get_by_role("textbox", name="How many vehicles can charge")
        field.wait_for()
        live.settled()
        for count in ("7", "8"):
            field.fill(count)
            with page.expect_download() as waiting:
                page.locator(".st-key-download_scenario button").first.click()
            archive = zipfile.ZipFile(io.BytesIO(waiting.value.path().read_bytes()))
            text = archive.read("summer-weekday/scenario.toml").decode()
            assert f"chargers = {count}\n" in text
            live.settled()


def test_cells_of_the_scenario_stand_as_typed_and_are_its_faults(
    browser: Browser, server: str
) -> None:
    with visiting(browser) as page:
        page.context.grant_permissions(["clipboard-read", "clipboard-write"])
        page.goto(f"{server}/scenario")
        live = LivePage(page, server)
        page.get_by_test_id("stDataFrame").last.wait_for()
        live.settled()
        options = page.get_by_test_id("stDataFrame").last.locator("canvas").first
        cell(live, options, 0.4, 0)
        type_over(live, ".19")
        expect(page.get_by_text("1 difference to the present run")).to_be_visible()
        cell(live, options, 0.4, 1)
        paste(page, "0,3")
        page.keyboard.press("Tab")
        live.settled()
        expect(page.get_by_text("1 fault.")).to_be_visible()
        with page.expect_download() as waiting:
            page.locator(".st-key-download_scenario button").first.click()
        archive = zipfile.ZipFile(io.BytesIO(waiting.value.path().read_bytes()))
        text = archive.read("summer-weekday/scenario.toml").decode()
        assert "price_per_kwh = 0.19" in text
        assert 'price_per_kwh = "0,3"' in text


def test_the_button_of_a_form_acts_on_what_is_typed(
    browser: Browser, server: str, tmp_path: Path
) -> None:
    file = tmp_path / "mine.csv"
    rows = [f"{day},2019-03-{day:02d} 06:00,2019-03-{day:02d} 16:00,9" for day in range(1, 9)]
    file.write_text("\n".join(["id,start,end,kwh", *rows, ""]), encoding="utf-8")
    with visiting(browser) as page:
        page.goto(f"{server}/scenario")
        live = LivePage(page, server)
        page.locator("input[type=file]").set_input_files(file)
        take = page.get_by_role("button", name="Take the sessions in")
        take.wait_for()
        days = page.get_by_role("textbox", name="Days")
        live.settled()
        days.fill("2,5")
        take.click()
        expect(page.get_by_text("Nothing was taken in; your work is as it was.")).to_be_visible()
        expect(days).to_have_value("2,5")
        live.settled()
        days.fill("2")
        take.click()
        expect(page.get_by_text("2 sessions over 2 days from 2019-03-01")).to_be_visible()
