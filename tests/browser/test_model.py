"""The Model page in a real browser: equations filled in, the study run and cancelled."""

import re

from playwright.sync_api import Browser, Page, expect

from tests.browser.conftest import serving, visiting
from tests.browser.live import SETTLED


def settle(page: Page) -> None:
    for _ in range(3):
        page.wait_for_selector(SETTLED)
        page.wait_for_timeout(200)


def open_tab(page: Page, name: str) -> None:
    page.get_by_role("tab", name=name).click()
    settle(page)


def test_a_cold_link_to_the_equations_and_this_runs_numbers_in_them(browser: Browser) -> None:
    with serving() as fresh, visiting(browser) as page:
        page.goto(f"{fresh}/model?preset=summer-weekday")
        page.get_by_text("No interval has been decided yet").wait_for()
        settle(page)
        formulas = page.locator(".katex-display")
        alone = formulas.count()
        assert alone == 15
        page.locator(".st-key-finish button").first.click()
        page.get_by_text("24 of 24").first.wait_for()
        settle(page)
        assert formulas.count() > alone
        assert page.locator(".katex-error").count() == 0
        expect(page.get_by_text("kW for it").first).to_be_visible()
        page.get_by_role("button", name=re.compile("energy_owed")).first.click()
        expect(page.get_by_text("evdash/scheduling/equations.py").first).to_be_visible()
        page.keyboard.press("Escape")
        for name in ("Assumptions", "The paper's figures", "Glossary"):
            open_tab(page, name)
        expect(page.get_by_text("Plug-in electric vehicle")).to_be_visible()
        main = page.locator("[data-testid=stMain]")
        assert main.evaluate("e => e.scrollWidth - e.clientWidth") == 0


def test_the_hundred_days_are_run_on_request_and_cancelled(browser: Browser, server: str) -> None:
    with visiting(browser) as page:
        page.goto(f"{server}/model")
        page.get_by_role("tab", name="A hundred days").wait_for()
        open_tab(page, "A hundred days")
        button = page.locator(".st-key-run_study button").first
        button.click()
        page.get_by_text(re.compile(r"Day [2-9] of 100")).wait_for()
        button.click()
        settle(page)
        expect(button).to_contain_text("Go on")
        expect(page.locator("table tr", has_text="Here")).to_have_count(1)
