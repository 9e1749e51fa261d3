"""Every control whose label is seen says what it is for."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from streamlit.testing.v1 import AppTest

from tests.app.test_compare_page import APP

PAGES = sorted(path.stem for path in (APP.parent / "pages").glob("*.py"))
VISIBLE = 0
"""As Streamlit's protocol numbers it."""


def controls(block: Any) -> Iterator[Any]:
    """All that can be set in a block and what is in it."""
    for element in getattr(block, "children", {}).values():
        yield from controls(element)
        if hasattr(element, "set_value") and hasattr(element.proto, "label_visibility"):
            yield element


@pytest.fixture(scope="module")
def app() -> AppTest:
    at = AppTest.from_file(str(APP), default_timeout=120).run()
    for _ in range(3):
        at.button(key="step").click().run()
    return at


@pytest.mark.parametrize("page", PAGES)
def test_every_control_says_what_it_is_for(app: AppTest, page: str) -> None:
    app.switch_page(str(Path("pages") / f"{page}.py")).run()
    assert not app.exception
    seen = [c for c in controls(app._tree) if c.proto.label_visibility.value == VISIBLE]
    assert seen
    assert not [(c.type, c.proto.label) for c in seen if not c.proto.help]
