"""docs/equations.md names functions and tests that exist, and leaves no equation out."""

import re
from pathlib import Path

from tests.scheduling_reference.test_golden_lp import equations_written

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "equations.md").read_text(encoding="utf-8")
NAMED = re.findall(r"`((?:evdash|tests|benchmarks)/[\w/]+\.py)`\s+`(\w+)`", PAGE)


def test_what_the_page_names_exists():
    assert len(NAMED) > 40
    for path, name in NAMED:
        source = (ROOT / path).read_text(encoding="utf-8")
        assert re.search(rf"^(    )?def {name}\(", source, re.MULTILINE), f"{name} in {path}"


def test_every_equation_function_is_on_the_page():
    on_page = {name for path, name in NAMED if path == "evdash/scheduling/equations.py"}
    assert on_page == set(equations_written())


def test_every_equation_and_decision_of_the_paper_is_on_the_page():
    for number in ("1a", "2", "3", "4a", "4c", "5a", "6a", "6b", "7a", "7b", "8", "9", "10", "P1"):
        assert f"({number})" in PAGE
    assert re.findall(r"^(\d)\. \*\*", PAGE, re.MULTILINE) == list("123456")
