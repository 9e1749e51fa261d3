"""Room above a chart for as many lines as its legend takes at the width it is shown in."""

import math
from typing import Any

from evdash.charts.style import FONT_PX, Figure

WIDTH_PX = 560
"""Taken for the width of a chart that nobody has seen yet: that of the narrower ones."""
SYMBOL_PX, GAP_PX, LETTER = 40, 5, 0.52
"""What plotly puts beside a name and between two; a letter's width on average, of its height."""
LINE_PX, NOW_PX = 20, 26
"""A line of a legend; the label of the now line, which stands between legend and chart."""


def roomy(figure: Figure, width_px: float | None) -> dict[str, Any]:
    """A figure's layout, taller by what further lines of its legend need above the chart.

    Where margins are plotly's own to find, it finds room for the legend, too.
    """
    layout: dict[str, Any] = figure["layout"]
    margin = layout.get("margin", {})
    if margin.get("autoexpand", True) or not layout.get("showlegend", True):
        return layout
    plot_px = (width_px or WIDTH_PX) - margin["l"] - margin["r"]
    size_px = layout["legend"]["font"]["size"]
    needed = LINE_PX * legend_lines(names_of(figure), plot_px, size_px) + NOW_PX
    more = max(0, needed - margin["t"])
    return {
        **layout,
        "height": layout["height"] + more,
        "margin": {**margin, "t": margin["t"] + more},
    }


def names_of(figure: Figure) -> list[str]:
    """What the legend lists. Maps of colour are not in it unless they ask for it."""
    return [
        trace["name"]
        for trace in figure["data"]
        if trace.get("showlegend", trace["type"] not in {"heatmap", "contour"}) and "name" in trace
    ]


def legend_lines(names: list[str], plot_px: float, size_px: float = FONT_PX) -> int:
    """Lines of a horizontal legend: one if all fits, else columns as wide as the longest name."""
    if len(names) < 2:  # plotly has none for one
        return 0
    widths = [SYMBOL_PX + LETTER * size_px * len(name) for name in names]
    if sum(widths) + GAP_PX * len(names) < plot_px:
        return 1
    columns = max(1, int((plot_px + GAP_PX) // (max(widths) + GAP_PX)))
    return math.ceil(len(names) / columns)
