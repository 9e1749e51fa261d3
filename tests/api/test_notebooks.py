"""The notebooks run, and show what stands in them."""

import importlib.util
from pathlib import Path
from types import ModuleType

import nbformat
import pytest

ROOT = Path(__file__).parents[2]
NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))


def builder() -> ModuleType:
    """`docs/build_notebooks.py`."""
    spec = importlib.util.spec_from_file_location("x", ROOT / "docs" / "build_notebooks.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_shows_what_comes_of_it(path: Path) -> None:
    page = builder()
    written = nbformat.read(path, as_version=4)
    nbformat.validate(written)
    assert page.printed(page.executed(path)) == page.printed(written)


def test_the_policy_of_the_notebook_is_that_of_the_documents() -> None:
    book = nbformat.read(ROOT / "docs" / "notebooks" / "a-policy-of-your-own.ipynb", as_version=4)
    policy = (ROOT / "docs" / "cheapest_hours.py").read_text(encoding="utf-8")
    assert policy.partition('"""\n\n')[2].strip() in [cell.source for cell in book.cells]
