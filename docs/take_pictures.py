"""Takes every picture of the app in docs/ anew, light and dark: `python -m docs.take_pictures`.

One visitor's day on the bundled scenario, in Chromium, by the helpers of the browser tests.
"""

from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

from tests.browser.conftest import CHROMIUM, FLAGS, serving
from tests.browser.live import LivePage

DOCS = Path(__file__).parent
WIDTH, WIDE = 1366, 1500
PATIENCE_MS = 600_000
VEHICLE = "PEV-026"


def settle(page: Page) -> None:
    """Wait until nothing is drawn any more."""
    LivePage(page, "").settled()
    page.wait_for_timeout(1500)


def take(page: Page, name: str, width: int, height: int | None = None) -> None:
    """A picture in either theme, of the whole page unless a height is given."""
    for theme in ("light", "dark"):
        page.emulate_media(color_scheme=theme)  # type: ignore[arg-type]
        page.set_viewport_size({"width": width, "height": height or 900})
        settle(page)
        if height is None:
            inner = page.locator("[data-testid=stMainBlockContainer]")
            whole = inner.evaluate("page => page.getBoundingClientRect().height")
            page.set_viewport_size({"width": width, "height": round(whole)})
            settle(page)
        page.mouse.move(width - 2, 2)
        page.wait_for_timeout(500)
        page.screenshot(path=DOCS / f"{name}-{theme}.png")
    page.emulate_media(color_scheme="light")


def go(page: Page, group: str, title: str) -> None:
    """Another page, by the bar at the top."""
    page.get_by_test_id("stTopNavSection").filter(has_text=group).first.click()
    page.locator("a").filter(has_text=title).last.click()
    settle(page)


def live(page: Page) -> None:
    """As far down as the first row of charts."""
    take(page, "live", WIDTH, 1165)


def vehicles(page: Page) -> None:
    """All vehicles, and one of them."""
    go(page, "Learn", "Vehicles")
    box = page.get_by_label("Look at one vehicle", exact=True)
    box.click()
    box.fill(VEHICLE)
    page.get_by_role("option", name=VEHICLE).first.click()
    settle(page)
    take(page, "vehicles", WIDTH)


def feeder(page: Page) -> None:
    """The feeder at the hour just over."""
    go(page, "Learn", "Feeder")
    take(page, "feeder", WIDTH)


def model(page: Page) -> None:
    """The first equations."""
    go(page, "Learn", "Model")
    take(page, "model", WIDTH, 1400)


def scenario(page: Page) -> None:
    """The tables of the feeder."""
    go(page, "Plan", "Scenario")
    page.get_by_role("tab", name="Feeder").click()
    take(page, "scenario", WIDE, 1000)


def compare(page: Page) -> None:
    """The day to its end and pinned, then the same with half the chargers, and a race on that."""
    go(page, "Learn", "Live")
    LivePage(page, "").press("finish")
    page.get_by_text("24 of 24 intervals").wait_for(timeout=PATIENCE_MS)
    go(page, "Plan", "Compare")
    page.get_by_role("button", name="Pin the present run").click()
    settle(page)
    go(page, "Learn", "Live")
    LivePage(page, "").press("reset").type("Chargers", "6").press("finish")
    page.get_by_text("24 of 24 intervals").wait_for(timeout=PATIENCE_MS)
    go(page, "Plan", "Compare")
    take(page, "compare", WIDE, 1000)
    page.get_by_role("button", name="Race", exact=True).click()
    page.locator(".st-key-race_figures").wait_for(timeout=PATIENCE_MS)
    settle(page)
    page.locator(".st-key-race_told").evaluate("told => told.scrollIntoView()")
    page.wait_for_timeout(500)
    take(page, "compare-race", WIDTH, 1245)


def studies(page: Page) -> None:
    """A small study, ended."""
    go(page, "Plan", "Studies")
    field = page.get_by_role("textbox", name="Days at every point")
    field.fill("8")
    field.press("Enter")
    settle(page)
    page.get_by_role("button", name="Start").click()
    page.get_by_text("runs have ended").wait_for(timeout=PATIENCE_MS)
    settle(page)
    take(page, "studies", WIDTH, 877)


PAGES: tuple[Callable[[Page], None], ...] = (
    live,
    vehicles,
    feeder,
    model,
    scenario,
    compare,
    studies,
)


def main() -> None:
    """One page after the other, in the order in which their states build on each other."""
    with serving() as address, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        page = browser.new_page(viewport={"width": WIDTH, "height": 900})
        page.set_default_timeout(PATIENCE_MS)
        LivePage(page, address).open().step_to(21)
        for show in PAGES:
            show(page)
        browser.close()


if __name__ == "__main__":
    main()
