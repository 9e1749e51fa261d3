"""Who may import whom: import-linter's contracts, outside packages, and pages that only call."""

import ast
from pathlib import Path

import pytest
from importlinter.cli import lint_imports

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "app.py", *sorted((ROOT / "pages").glob("*.py"))]
CODE = [*sorted((ROOT / "evdash").rglob("*.py")), *PAGES]
# The only places that may import what is not ours.
HOMES = {
    "streamlit": ("evdash/ui/", "pages/", "app.py"),
    "starlette": ("evdash/ui/",),
    "plotly": ("evdash/charts/",),
    "pulp": ("evdash/scheduling/",),
    "highspy": ("evdash/scheduling/",),
    "pandapower": ("evdash/grid/",),
    "power_grid_model": ("evdash/grid/",),
    "networkx": ("evdash/grid/",),
}
# What a list of calls is made of.
CALLS = (
    *(ast.Module, ast.Expr, ast.Assign, ast.With, ast.withitem, ast.If, ast.Compare, ast.Eq),
    *(
        ast.Call,
        ast.keyword,
        ast.Attribute,
        ast.Subscript,
        ast.Name,
        ast.Constant,
        ast.expr_context,
    ),
    *(ast.List, ast.Tuple, ast.Dict, ast.Starred),
    *(ast.Import, ast.ImportFrom, ast.alias),
)


def imported(source: str) -> set[str]:
    """Every module imported anywhere in a file, also within functions."""
    names: set[str] = set()
    for statement in ast.walk(ast.parse(source)):
        if isinstance(statement, ast.Import):
            names |= {alias.name for alias in statement.names}
        elif isinstance(statement, ast.ImportFrom):
            base = statement.module or ""
            names |= {base} | {f"{base}.{alias.name}" for alias in statement.names}
    return names


def strangers(path: str, source: str) -> set[str]:
    """Outside packages a file imports that have their home elsewhere."""
    packages = {name.split(".")[0] for name in imported(source)}
    return {name for name in packages & set(HOMES) if not path.startswith(HOMES[name])}


def computations(source: str) -> list[str]:
    """Whatever in a page is more than a list of calls, or reaches past evdash.ui."""
    found = [
        f"line {getattr(node, 'lineno', '?')}: {type(node).__name__}"
        for node in ast.walk(ast.parse(source))
        if not isinstance(node, CALLS)
    ]
    beyond = [
        name
        for name in sorted(imported(source))
        if name.startswith("evdash.") and not name.startswith("evdash.ui")
    ]
    return found + beyond


def test_contracts_of_the_house_are_kept(capsys, monkeypatch):
    monkeypatch.chdir(ROOT)
    status = lint_imports(config_filename=str(ROOT / "pyproject.toml"), no_cache=True)
    assert status == 0, capsys.readouterr().out


@pytest.mark.parametrize("path", CODE, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_outside_packages_are_imported_at_home_only(path):
    name = path.relative_to(ROOT).as_posix()
    assert strangers(name, path.read_text(encoding="utf-8")) == set()


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_pages_are_lists_of_calls(path):
    assert computations(path.read_text(encoding="utf-8")) == []


def test_these_tests_can_fail():
    assert strangers("evdash/files/x.py", "def f():\n    import pandapower.shortcircuit") == {
        "pandapower"
    }
    assert strangers("evdash/ui/x.py", "from plotly import graph_objects") == {"plotly"}
    assert strangers("evdash/grid/x.py", "import pandapower") == set()
    assert computations("from evdash.ui import live\nlive.show(key='a')") == []
    assert computations("from evdash import grid") == ["evdash.grid"]
    assert computations("x = 1 + 2")
    assert computations("for x in y:\n    x()")
    assert computations("def f(): pass")
