"""A figure handed over as it is.

`st.plotly_chart` makes of a plain dictionary a plotly figure and of that a dictionary again,
checking every value: two thirds of a step's time on the server. The figures drawn here are
checked by tests instead, once for all (`tests/charts`).
"""

from functools import cache
from typing import Any

import plotly.io
from plotly.basedatatypes import BaseFigure

from evdash.charts.style import Figure

TEMPLATE = "streamlit"
"""The page's own look, which Streamlit registers with plotly and its browser side fills in."""


class Drawn(BaseFigure):  # type: ignore[misc]
    """A plain figure in the shape plotly's interface asks for, unchecked."""

    def __init__(self, figure: Figure) -> None:
        """Made without plotly's own figure, which would copy and check everything."""
        layout = {"template": _template(), **figure["layout"]}
        object.__setattr__(self, "_figure", {**figure, "layout": layout})

    def to_dict(self) -> dict[str, Any]:
        figure: dict[str, Any] = object.__getattribute__(self, "_figure")
        return figure


@cache
def _template() -> dict[str, Any]:
    template: dict[str, Any] = plotly.io.templates[TEMPLATE].to_plotly_json()
    return template
