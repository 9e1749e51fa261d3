"""A table of sessions uploaded, its columns confirmed, in a real browser."""

from pathlib import Path

from playwright.sync_api import Browser

from tests.browser.conftest import visiting

SESSIONS = "id,start,end,kwh\na,2019-03-01 06:00,2019-03-01 16:00,9\nb,2019-03-02 07:00,,5\n"


def test_sessions_are_uploaded_confirmed_and_undone(
    browser: Browser, server: str, tmp_path: Path
) -> None:
    file = tmp_path / "mine.csv"
    file.write_text(SESSIONS, encoding="utf-8")
    with visiting(browser) as page:
        page.goto(f"{server}/scenario")
        page.locator("input[type=file]").set_input_files(file, timeout=60_000)
        page.get_by_role("button", name="Take the sessions in").click(timeout=60_000)
        page.get_by_text("2 sessions over 2 days from 2019-03-01").wait_for(timeout=60_000)
        page.get_by_role("button", name="Undo").click()
        page.get_by_text("This is the present run's scenario").wait_for(timeout=60_000)


def test_a_known_network_and_prices_by_time_are_taken_in(
    browser: Browser, server: str, tmp_path: Path
) -> None:
    file = tmp_path / "dayahead.csv"
    rows = [f"2024-05-06 {hour:02d}:00,{hour}" for hour in range(24)]
    file.write_text("\n".join(["time,price_mwh", *rows, ""]), encoding="utf-8")
    with visiting(browser) as page:
        page.goto(f"{server}/scenario")
        page.get_by_role("combobox", name="a known network").click()
        page.get_by_role("option", name="case33bw").click()
        page.get_by_role("button", name="Take the network in").click()
        page.get_by_text("case33bw replaced the feeder; the station stands at 23.").wait_for()
        page.locator("input[type=file]").set_input_files(file)
        page.get_by_role("button", name="Take the values in").click()
        page.get_by_text("dayahead.csv replaced price_per_kwh.").wait_for()
        page.get_by_text("The scenario begins at 2024-05-06 00:00.").wait_for()
        page.get_by_role("button", name="Begin a new day on it").click()
        page.get_by_text("A new day has begun on").wait_for()


def test_a_workbook_of_the_templates_is_had_taken_in_and_undone(
    browser: Browser, server: str, tmp_path: Path
) -> None:
    with visiting(browser) as page:
        page.goto(f"{server}/scenario")
        page.get_by_role("button", name="Templates").click()
        with page.expect_download() as download:
            page.get_by_role("button", name="scenario.xlsx").click()
        file = tmp_path / "filled.xlsx"
        download.value.save_as(file)
        page.keyboard.press("Escape")
        page.locator("input[type=file]").set_input_files(file)
        page.get_by_text("filled.xlsx replaced scenario.toml").wait_for()
        page.get_by_role("button", name="Undo").click()
        page.get_by_text("This is the present run's scenario").wait_for()
