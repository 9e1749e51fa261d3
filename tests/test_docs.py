"""The documentation says what the code says."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from evdash import __version__
from evdash.audit.coverage import coverage_table

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("page", ["scenario", "api"])
def test_a_page_is_in_step_with_the_declarations_it_is_built_from(page):
    written = (ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8")
    script = f"import sys; sys.path.insert(0, 'docs'); import build_{page}_doc as page;"
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


@pytest.mark.parametrize("page", ["README.md", "docs/api.md"])
def test_the_first_result_in_ten_lines_of_python_comes_out(page, tmp_path):
    text = (ROOT / page).read_text(encoding="utf-8")
    (script,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert len(script.strip().splitlines()) <= 10
    printed = subprocess.run(
        [sys.executable, "-X", "utf8", "-c", script],
        capture_output=True,
        encoding="utf-8",
        check=True,
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
    ).stdout
    assert printed.startswith("Summer weekday, p1: ")
    assert "\nRefused because " in printed
    assert "<html>" in (tmp_path / "load.html").read_text(encoding="utf-8")[:200]


def test_the_citation_and_the_changes_are_of_this_version_and_licence():
    cited = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {__version__}\n" in cited
    assert "\nlicense: MIT\n" in cited
    assert (ROOT / "LICENSE").read_text(encoding="utf-8").startswith("MIT License\n")
    newest = re.search(r"^## ([\d.]+)", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.M)
    assert newest is not None
    assert newest[1] == __version__


def requirements(name):
    """(package, lower limit, upper limit) of every line, None where a limit is missing."""
    lines = (ROOT / name).read_text(encoding="utf-8").splitlines()
    bounds = re.compile(r"([a-z0-9-]+)(?:\[[a-z]+\])?(?:>=([\d.]+))?(?:,?<([\d.]+))?")
    found = [(line, bounds.fullmatch(line)) for line in lines if not line.startswith("-r ")]
    assert all(match for _, match in found), [line for line, match in found if not match]
    return [match.groups() for _, match in found]


def test_the_readmes_table_holds_every_requirement_and_nothing_else():
    table = README.split("| package | why |")[1].split("\n\n")[0]
    told = re.findall(r"^\| ([a-z][a-z0-9-]*) \| .+ \|$", table, re.MULTILINE)
    assert sorted(told) == sorted(package for package, _, _ in requirements("requirements.txt"))


@pytest.mark.parametrize("name", sorted(path.name for path in ROOT.glob("requirements*.txt")))
def test_every_bound_has_a_lower_and_an_upper_limit(name):
    for package, low, high in requirements(name):
        assert low, f"{package} has no lower limit"
        assert high, f"{package} has no upper limit"
        assert [int(part) for part in low.split(".")] < [int(part) for part in high.split(".")]


def test_the_lowest_versions_are_those_of_the_bounds():
    printed = subprocess.run(
        [ROOT / ".ci" / "lowest"], capture_output=True, encoding="utf-8", check=True
    ).stdout
    pins = [re.sub(r"\[[a-z]+\]", "", line).split("==") for line in printed.splitlines()]
    bounds = [
        [package, low]
        for path in ROOT.glob("requirements*.txt")
        for package, low, _ in requirements(path.name)
    ]
    assert sorted(pins) == sorted(bounds)


def test_ci_runs_the_readmes_test_command_on_the_newest_and_the_lowest_versions():
    command = "bin/python -m pytest -n auto --dist loadfile"
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert f".venv/{command}" in README
    assert f"\n.venv/{command} ||" in script
    assert f"\n.venv-lowest/{command} -m " in script
