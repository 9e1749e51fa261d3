"""Clicks count once, and parts that run by themselves are made in one place."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from evdash.ui import apart

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    ("run", "counted"),
    [
        (None, 1),
        (SimpleNamespace(fragment_ids_this_run=None), 1),
        (SimpleNamespace(fragment_ids_this_run=["a part's"]), 0),
    ],
)
def test_a_click_told_by_a_parts_timer_waits_for_its_own_run(
    monkeypatch: pytest.MonkeyPatch, run: object, counted: int
) -> None:
    monkeypatch.setattr(apart, "get_script_run_ctx", lambda: run)
    clicks: list[str] = []
    apart.one_click(clicks.append)("clicked")
    assert len(clicks) == counted


def test_every_part_has_a_container_of_its_own() -> None:
    """Only `apart` makes fragments; tests/browser/test_apart.py shows why it has to."""
    sources = [*(ROOT / "evdash").rglob("*.py"), *(ROOT / "pages").glob("*.py"), ROOT / "app.py"]
    using = {path.name for path in sources if "st.fragment" in path.read_text(encoding="utf-8")}
    assert using == {"apart.py"}
