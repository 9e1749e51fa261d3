"""A figure handed over as it is, in the look of the app.

`st.plotly_chart` makes of a plain dictionary a plotly figure and of that a dictionary again,
checking every value: two thirds of a step's time on the server. The figures drawn here are
checked by tests instead, once for all (`tests/charts`).

The app's look is added here, as nothing but colours and a font, and Streamlit's own theme does
without: it comes as a template, for which plotly would draw every chart a second time.
"""

import json
import zlib
from typing import Any

from plotly.basedatatypes import BaseFigure

from evdash.charts.legend import roomy
from evdash.charts.style import BLUE, CLEAR, FONT_PX, Figure, is_axis

FONT = '"Source Sans", sans-serif'
INK = "rgb(125,125,126)"
"""Text that takes the colour of the page's own: `evdash.ui.look` looks for just this grey."""
GRID = {"gridcolor": "rgba(128,128,128,0.22)", "zerolinecolor": "rgba(128,128,128,0.5)"}
LABEL = {
    "font": {"size": FONT_PX, "family": FONT, "color": "#ffffff"},
    "bgcolor": "#31333f",
    "bordercolor": "#808495",
}
"""The same in both themes: unified labels would otherwise be as clear as the ground."""
MODEBAR = {"bgcolor": CLEAR, "color": "rgba(128,128,128,0.8)", "activecolor": BLUE}


class Drawn(BaseFigure):  # type: ignore[misc]
    """A plain figure in the shape plotly's interface asks for, unchecked."""

    def __init__(self, figure: Figure, width_px: float | None = None) -> None:
        """Made without plotly's own figure, which would copy and check everything."""
        layout = {"datarevision": revision(figure), **in_the_look(roomy(figure, width_px))}
        if width_px:
            layout["width"] = width_px
        object.__setattr__(self, "_figure", {**figure, "layout": layout})

    def to_dict(self) -> dict[str, Any]:
        figure: dict[str, Any] = object.__getattribute__(self, "_figure")
        return figure


def in_the_look(layout: dict[str, Any]) -> dict[str, Any]:
    """A layout with the app's colours and font, readable on a light ground and on a dark one."""
    axes = {name: {**GRID, **axis} for name, axis in layout.items() if is_axis(name)}
    font = {"family": FONT, "color": INK, **layout["font"]}
    return {**layout, **axes, "font": font, "hoverlabel": LABEL, "modebar": MODEBAR}


def revision(figure: Figure) -> int:
    """A number for what is drawn.

    Streamlit's browser side hands every new chart to plotly twice. Where this number is the same
    and there is no template, plotly sees that there is nothing to draw again.
    """
    return zlib.crc32(json.dumps(figure["data"]).encode())
