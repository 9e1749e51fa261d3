"""Addresses nobody has written on purpose: the page says what is wrong or begins a new day."""

from pathlib import Path

import pytest
from streamlit.testing.v1 import AppTest

from evdash.ui.keeping import GONE, LINK
from evdash.ui.session import PRESET
from evdash.ui.studies.mine import OWNER
from evdash.ui.vehicles.picked import VEHICLE

ROOT = Path(__file__).parents[2]
HOSTILE = ("../../etc/passwd", "' OR 1=1 --", "<img src=x onerror=alert(1)>", "n" * 5000, "a\x00b")


@pytest.mark.parametrize("text", HOSTILE)
def test_hostile_texts_in_an_address_open_a_page_without_an_error(text: str) -> None:
    app = AppTest.from_file(str(ROOT / "app.py"), default_timeout=120)
    for name in (LINK, PRESET, OWNER, VEHICLE, "unknown"):
        app.query_params[name] = text
    app.run()
    assert not app.exception
    assert any(GONE in caption.value for caption in app.caption)
