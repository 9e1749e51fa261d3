"""A figure handed over as it is.

`st.plotly_chart` makes of a plain dictionary a plotly figure and of that a dictionary again,
checking every value: two thirds of a step's time on the server. The figures drawn here are
checked by tests instead, once for all (`tests/charts`).
"""

import json
import zlib
from typing import Any

from plotly.basedatatypes import BaseFigure

from evdash.charts.style import Figure


class Drawn(BaseFigure):  # type: ignore[misc]
    """A plain figure in the shape plotly's interface asks for, unchecked."""

    def __init__(self, figure: Figure, width_px: float | None = None) -> None:
        """Made without plotly's own figure, which would copy and check everything."""
        layout = {"datarevision": revision(figure), **figure["layout"]}
        if width_px:
            layout["width"] = width_px
        object.__setattr__(self, "_figure", {**figure, "layout": layout})

    def to_dict(self) -> dict[str, Any]:
        figure: dict[str, Any] = object.__getattribute__(self, "_figure")
        return figure


def revision(figure: Figure) -> int:
    """A number for what is drawn.

    Streamlit's browser side hands every new chart to plotly twice. Where this number is the same
    and there is no template, plotly sees that there is nothing to draw again.
    """
    return zlib.crc32(json.dumps(figure["data"]).encode())
