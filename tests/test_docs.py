"""The documentation says what the code says."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from evdash.audit.coverage import coverage_table

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_scenario_page_is_in_step_with_the_declarations():
    written = (ROOT / "docs" / "scenario.md").read_text(encoding="utf-8")
    script = "import sys; sys.path.insert(0, 'docs'); import build_scenario_doc as page;"
    printed = subprocess.run(
        [sys.executable, "-X", "utf8", "-c", script + "print(page.document(), end='')"],
        capture_output=True,
        encoding="utf-8",
        check=True,
        cwd=ROOT,
    ).stdout
    assert printed == written


def test_the_table_of_the_audit_is_in_step_with_its_declaration():
    written = (ROOT / "docs" / "reliability.md").read_text(encoding="utf-8")
    assert "\n".join(["", *coverage_table(), ""]) in written


@pytest.mark.parametrize("page", ["README.md", *sorted(p.name for p in ROOT.glob("docs/*.md"))])
def test_links_and_named_files_exist(page):
    path = ROOT / page if page == "README.md" else ROOT / "docs" / page
    text = path.read_text(encoding="utf-8")
    for target in re.findall(r"\]\((?!https?:|#)([^)#]+)", text):
        assert (path.parent / target).exists(), target
    for named in re.findall(r"`((?:evdash|tests|data|docs|benchmarks|pages)/[\w./-]+)`", text):
        assert (ROOT / named).exists(), named


def test_every_requirement_has_its_reason_in_the_readme():
    lines = (ROOT / "requirements.txt").read_text(encoding="utf-8").split()
    for line in lines:
        package = re.split(r"[<>=~!]", line)[0]
        assert f"| {package} |" in README, package
        assert re.search(r">=[\d.]+,<\d", line), f"{line} is not bounded on both sides"


def test_ci_runs_the_readmes_test_command():
    command = ".venv/bin/python -m pytest -n auto --dist loadfile"
    assert command in README
    assert command in (ROOT / ".ci" / "run").read_text(encoding="utf-8")
