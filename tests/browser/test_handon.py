"""A day handed on from the app: every file comes, and the run's own audits clean."""

import zipfile
from pathlib import Path

import openpyxl
from playwright.sync_api import Browser

from evdash.cli.main import main
from tests.browser.conftest import visiting

FILES = {
    "Report": "report.html",
    "Workbook": "run.xlsx",
    "The run's files": "run.zip",
    "Scenario": "scenario.zip",
    "OCPP profiles": "ocpp.zip",
    "pandapower network": "pandapower.json",
}


def test_every_file_of_a_finished_day_comes_from_any_page(
    browser: Browser, server: str, tmp_path: Path
):
    with visiting(browser) as page:
        page.set_default_timeout(120_000)
        page.goto(server)
        page.get_by_role("button", name="Hand on").first.click()
        page.get_by_role("button", name="Run to end first").click()
        panel = page.locator(".st-key-handon_body")
        panel.get_by_role("button", name="Report").wait_for()
        for name, ending in FILES.items():
            with page.expect_download() as download:
                panel.get_by_role("button", name=name, exact=True).click()
            assert download.value.suggested_filename == f"summer-weekday-{ending}"
            download.value.save_as(tmp_path / ending)
    report = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "<title>Summer weekday: charging report</title>" in report
    assert "Vehicles" in openpyxl.load_workbook(tmp_path / "run.xlsx").sheetnames
    assert '"pandapowerNet"' in (tmp_path / "pandapower.json").read_text(encoding="utf-8")
    for name in ("run.zip", "ocpp.zip"):
        with zipfile.ZipFile(tmp_path / name) as archive:
            archive.extractall(tmp_path / "out")
    assert main(["audit", str(tmp_path / "out" / "run")]) == 0
    assert main(["validate", str(tmp_path / "scenario.zip")]) == 0
    assert len(list((tmp_path / "out" / "profiles" / "ocpp-1.6").iterdir())) > 40
