"""Where the server's secrets set up a sign-in, nothing is shown to who has not signed in."""

from pathlib import Path
from typing import Any

import pytest
import streamlit as st
from streamlit.testing.v1 import AppTest

from evdash.ui.entry import SIGN_IN

ROOT = Path(__file__).parents[2]
PAGES = sorted(path.name for path in (ROOT / "pages").glob("*.py"))


def asked(at: AppTest) -> bool:
    """Whether the page asks for the sign-in, and shows nothing else."""
    shown = [*at.metric, *at.get("plotly_chart"), *at.dataframe, *at.sidebar.children]
    return [b.label for b in at.button] == [SIGN_IN] and not shown and not at.exception


def test_without_a_sign_in_everyone_enters() -> None:
    at = AppTest.from_file(str(ROOT / "app.py"), default_timeout=120).run()
    assert SIGN_IN not in [button.label for button in at.button]
    assert at.button(key="step")


def test_who_has_not_signed_in_sees_nothing() -> None:
    at = AppTest.from_file(str(ROOT / "app.py"), default_timeout=120)
    at.secrets["auth"] = {"cookie_secret": "for the test of this page alone"}
    at.query_params["run"] = "somebody-elses-link"
    assert asked(at.run())
    assert "Open it once more" in at.caption[0].value


def test_a_sign_in_that_is_set_up_wrongly_is_told() -> None:
    def page() -> None:
        from evdash.ui.entry import begin_sign_in

        begin_sign_in()

    at = AppTest.from_function(page).run()
    assert "not set up as it should be" in at.error[0].value
    assert not at.exception


def test_who_has_signed_in_enters_and_finds_the_way_out() -> None:
    at = AppTest.from_file(str(ROOT / "app.py"), default_timeout=120)
    at.secrets["auth"] = {"cookie_secret": "for the test of this page alone"}
    at.user = {"is_logged_in": True, "email": "<b>planner</b>@example.org"}
    at.run()
    assert at.button(key="step")
    assert "Signed in as <b>planner</b>@example.org" in [text.value for text in at.text]
    assert at.button(key="sign_out")
    assert not at.exception


def test_secrets_that_cannot_be_read_let_nobody_in(tmp_path: Path, monkeypatch: Any) -> None:
    broken = tmp_path / "secrets.toml"
    broken.write_text("[auth\n", encoding="utf-8")
    at = AppTest.from_file(str(ROOT / "app.py"), default_timeout=120)
    monkeypatch.setattr(st, "get_option", {"secrets.files": [str(broken)]}.get)
    at.run()
    assert "cannot be read" in at.error[0].value
    assert not at.button


@pytest.mark.parametrize("page", PAGES)
def test_no_page_is_a_way_round_it(page: str) -> None:
    """A fresh server's first address is tried in `tests/browser/test_sign_in.py`."""
    at = AppTest.from_file(str(ROOT / "app.py"), default_timeout=120)
    at.secrets["auth"] = {"cookie_secret": "for the test of this page alone"}
    at.run()
    assert asked(at.switch_page(str(Path("pages") / page)).run())
