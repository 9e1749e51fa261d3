"""Figures that stand alone: Plotly's own script, a look for light and for dark, notebooks."""

from typing import Any, TypeAlias

from plotly import graph_objects
from plotly.offline import get_plotlyjs

from evdash.charts.style import CLEAR, Figure, now_label, now_shapes
from evdash.domain.outlook import Outlook

PlotlyFigure: TypeAlias = graph_objects.Figure
"""A figure as Plotly itself knows it."""
FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif"
INK = {"light": "#1f2430", "dark": "#e8eaf0"}
LAST_TICK_PX = 28
"""Room on the right for half of the last clock time."""
GRID = {"light": "rgba(31,36,48,0.14)", "dark": "rgba(232,234,240,0.18)"}


def plotly_script() -> str:
    """Plotly.js whole, to be set into a page once."""
    script: str = get_plotlyjs()
    return script


def templates() -> dict[str, dict[str, Any]]:
    """What figures leave to their page, by colour scheme: ink, grid and font."""
    return {scheme: _template(INK[scheme], GRID[scheme]) for scheme in INK}


def as_plotly(figure: Figure) -> PlotlyFigure:
    """A figure as Plotly's own kind, to be shown in a notebook, changed, or written to a file."""
    on_white = {"paper_bgcolor": "white", "plot_bgcolor": "white"}
    return PlotlyFigure(figure).update_layout(template=templates()["light"], **on_white)


def _template(ink: str, grid: str) -> dict[str, Any]:
    axis = {"gridcolor": grid, "linecolor": grid, "zerolinecolor": grid, "color": ink}
    return {
        "layout": {
            "font": {"family": FONT, "color": ink},
            "paper_bgcolor": CLEAR,
            "plot_bgcolor": CLEAR,
            "xaxis": axis,
            "yaxis": axis,
            "coloraxis": {"colorbar": {"outlinewidth": 0, "tickcolor": ink}},
        }
    }


def of_finished_day(figure: Figure, outlook: Outlook) -> Figure:
    """A figure without the now line, and without traces of what is still planned: nothing is."""
    layout, gone = figure["layout"], [*now_shapes(outlook), now_label(outlook)]
    kept = {
        part: [one for one in layout[part] if one not in gone]
        for part in ("shapes", "annotations")
        if part in layout
    }
    traces = [trace for trace in figure["data"] if not _is_blank(trace)]
    margin = layout["margin"] | {"r": max(LAST_TICK_PX, layout["margin"]["r"])}
    return {**figure, "data": traces, "layout": {**layout, **kept, "margin": margin}}


def _is_blank(trace: dict[str, Any]) -> bool:
    values = trace.get("y")
    return isinstance(values, list) and all(value is None for value in values)
