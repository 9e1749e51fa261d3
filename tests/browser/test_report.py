"""The report in a real browser, from a file: nothing asked for, nothing amiss, and on paper."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from playwright.sync_api import Browser

from evdash.cli.main import main

DRAWN = "document.querySelectorAll('.chart .main-svg').length"


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("report") / "report.html"
    preset = Path(__file__).parents[2] / "data" / "presets" / "voltage-limited"
    assert main(["export", str(preset), "--report", str(path)]) == 0
    return path


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_opens_from_a_file_and_asks_for_nothing(browser: Browser, report: Path, scheme: str):
    context = browser.new_context(viewport={"width": 1366, "height": 768}, color_scheme=scheme)
    page = context.new_page()
    complaints, asked = [], []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda message: complaints.append(message.text))
    page.on("request", lambda request: asked.append(request.url))
    page.goto(report.as_uri())
    page.wait_for_function(f"{DRAWN} >= 8")
    assert complaints == []
    assert asked == [report.as_uri()]
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    ink = page.evaluate("getComputedStyle(document.querySelector('.chart text')).fill")
    assert ink == {"light": "rgb(31, 36, 48)", "dark": "rgb(232, 234, 240)"}[scheme]
    context.close()


def test_it_prints_whole_charts_in_black_on_white(browser: Browser, report: Path, tmp_path: Path):
    context = browser.new_context(color_scheme="dark")
    page = context.new_page()
    page.goto(report.as_uri())
    page.wait_for_function(f"{DRAWN} >= 8")
    page.locator("summary", has_text="Every node (").click()
    paper = tmp_path / "report.pdf"
    page.pdf(path=paper, prefer_css_page_size=True)
    # on the screen it is as before
    page.wait_for_function(
        "getComputedStyle(document.querySelector('.chart text')).fill == 'rgb(232, 234, 240)'"
    )
    context.close()
    if shutil.which("pdftotext") is None:
        pytest.skip("no pdftotext to read the paper with: install poppler-utils")
    told = subprocess.run(
        ["pdftotext", "-layout", str(paper), "-"], capture_output=True, encoding="utf-8", check=True
    ).stdout
    pages = told.split("\f")
    assert 6 <= len(pages) <= 14
    for heading in ("What went in", "Charging schedule", "Voltages", "hot spot", "Made with"):
        assert heading in told
    assert re.search(r"Node\s+Lowest without", told)  # opened, so printed
    assert "Everyone who asked" not in told  # closed, so left out
