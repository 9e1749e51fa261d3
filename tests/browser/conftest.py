"""A real server, a real Chromium, and pages that must not complain."""

import shutil
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Browser, Page, expect, sync_playwright

from benchmarks.crowd import server as server_of
from tests.browser.live import LivePage

ROOT = Path(__file__).parents[2]
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("chrome")
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
]
PATIENCE_MS = 120_000
"""For whatever a page has to show, on a machine with much else to do: no test fails on time."""
expect.set_options(timeout=PATIENCE_MS)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if "tests/browser" in item.path.as_posix():
            item.add_marker(pytest.mark.browser)


@contextmanager
def serving(
    store: str | None = None, app: Path = ROOT / "app.py", options: Sequence[str] = ()
) -> Iterator[str]:
    """A fresh server's address; it is gone afterwards, and so are its runs but in `store`."""
    with ExitStack() as stack:
        place = Path(store or stack.enter_context(TemporaryDirectory()))
        yield stack.enter_context(server_of.serving(place, *options, app=app)).address


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    if CHROMIUM is None:
        pytest.skip("no Chromium found: install the package `chromium`")
    with sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield found
        found.close()


@pytest.fixture(scope="session")
def server() -> Iterator[str]:
    with serving() as address:
        yield address


def _foreign(url: str) -> list[str]:
    """A complaint where a page asks anything of anybody but this machine."""
    place = urlsplit(url)
    at_home = place.scheme in {"data", "blob", "about"} or place.hostname in {
        "127.0.0.1",
        "localhost",
    }
    return [] if at_home else [f"the page asked {url}"]


@contextmanager
def visiting(browser: Browser, scheme: str = "light") -> Iterator[Page]:
    """A new visitor's page; afterwards it must have had nothing to complain about."""
    context = browser.new_context(viewport={"width": 1366, "height": 768}, color_scheme=scheme)  # type: ignore[arg-type]
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on(
        "console",
        lambda message: (
            complaints.append(f"{message.text} {message.location.get('url')}")
            if message.type == "error"
            else None
        ),
    )
    page.on("request", lambda asked: complaints.extend(_foreign(asked.url)))
    yield page
    assert page.locator("[data-testid=stException]").count() == 0
    assert complaints == []
    context.close()


@pytest.fixture
def live(browser: Browser, server: str) -> Iterator[LivePage]:
    with visiting(browser) as page:
        yield LivePage(page, server).open()
