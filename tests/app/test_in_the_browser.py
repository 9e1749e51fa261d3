"""What pages leave to the browser, and what is taken from it."""

from pathlib import Path

import pytest
from streamlit.testing.v1 import AppTest

from evdash.charts.drawn import Drawn, revision
from evdash.charts.style import figure
from evdash.ui.widths import sound

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("told", [None, "wide", [500], {"chart_load": -1}, {"chart_load": "<b>"}])
def test_nonsense_from_a_browser_is_ignored(told: object) -> None:
    assert sound(told) == {}


def test_widths_reach_the_figure() -> None:
    assert sound({"chart_load": 491.4, "chart_x": 1e9}) == {"chart_load": 491.4}
    drawn = figure([{"type": "bar", "y": [1]}], 300)
    assert Drawn(drawn, 491.4).to_dict()["layout"]["width"] == 491.4
    assert "width" not in Drawn(drawn).to_dict()["layout"]


def test_another_drawing_has_another_revision() -> None:
    one, other = (figure([{"type": "bar", "y": [y]}], 300) for y in (1, 2))
    assert revision(one) == revision(figure([{"type": "bar", "y": [1]}], 300)) != revision(other)


def test_every_chart_goes_into_the_page_by_one_door() -> None:
    """With Streamlit's theme a chart without a template of plotly's would fail to be drawn."""
    calls = [
        path.relative_to(ROOT).as_posix()
        for path in (ROOT / "evdash").rglob("*.py")
        if "st.plotly_chart(" in path.read_text(encoding="utf-8")
    ]
    assert calls == ["evdash/ui/parts.py"]


def test_every_number_of_the_sidebar_is_its_widgets_default_too() -> None:
    """A browser that missed the first script run of two would else show blanks."""
    at = AppTest.from_file(str(ROOT / "app.py"), default_timeout=120).run()
    assert not at.exception
    fields = [field for field in at.sidebar.text_input if field.key]
    assert len(fields) == 7
    for field in fields:
        assert field.proto.default == field.value
    assert not at.warning
