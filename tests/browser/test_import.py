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
