"""Pages' own addresses, as the server answers them; the browser's side is tests/browser's."""

from pathlib import Path

import pytest
import streamlit as st

from evdash.ui.deep_links import WHERE, routes

PAGES = Path(__file__).parents[2] / "pages"


def test_every_page_is_told_where_its_server_is_before_anything_runs() -> None:
    found = routes(PAGES)
    assert {route.path for route in found} == {f"/{page.stem}" for page in PAGES.glob("*.py")}
    for route in found:
        html = route.endpoint(None).body.decode()
        assert html.index(WHERE) < html.index("<script", html.index(WHERE) + 1)
        assert html.index("<script") == html.index(WHERE)


@pytest.mark.parametrize("base", ["stations", "/stations/"])
def test_pages_of_a_server_below_another_address(
    monkeypatch: pytest.MonkeyPatch, base: str
) -> None:
    monkeypatch.setattr(st, "get_option", {"server.baseUrlPath": base}.__getitem__)
    assert all(route.path.startswith("/stations/") for route in routes(PAGES))
