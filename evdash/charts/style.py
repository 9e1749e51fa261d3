"""How all charts look: colours, axes of clock time, the now line, safe text."""

import html
from collections.abc import Sequence
from datetime import datetime
from typing import Any

from evdash.domain.limits import Floats
from evdash.domain.outlook import Outlook

Figure = dict[str, Any]
Trace = dict[str, Any]

# Okabe and Ito's colours, told apart by every kind of colour vision.
BLUE, ORANGE, GREEN, PURPLE = "#0072B2", "#E69F00", "#009E73", "#CC79A7"
VERMILLION, SKY, YELLOW = "#D55E00", "#56B4E9", "#F0E442"
OPTION_COLOURS = (BLUE, ORANGE, GREEN, PURPLE, SKY, VERMILLION, YELLOW)
# Greys that let either theme's background through.
OUTLINE, WINDOW, FUTURE = "rgba(128,128,128,0.9)", "rgba(128,128,128,0.16)", "rgba(128,128,128,0.1)"

CLEAR = "rgba(0,0,0,0)"

FONT_PX = 14
HOUR_MS = 3_600_000
MAX_TICKS = 9
TICK_HOURS = (1, 2, 3, 4, 6, 12, 24, 48, 168)
LEGEND = {
    "orientation": "h",
    "traceorder": "normal",
    "x": 0,
    "xanchor": "left",
    "y": 1,
    "yref": "container",
    "yanchor": "top",
    "font": {"size": FONT_PX},
}
MARGIN = {"l": 66, "r": 16, "t": 58, "b": 48}
AS_IT_IS = {"ticklabeloverflow": "allow", "tickangle": 0}
"""Plotly measures no label to find out whether to turn or hide it."""
COLORBAR = {"thickness": 14, "outlinewidth": 0}
CONFIG = {
    "displaylogo": False,
    # what has no use here, or another button does: the bar lies over legends when it shows
    "modeBarButtonsToRemove": ["select2d", "lasso2d", "zoomIn2d", "zoomOut2d", "autoScale2d"],
}


def safe(text: str) -> str:
    """User text as Plotly shall show it: no tags, no LaTeX. It decodes numeric entities last."""
    return html.escape(text, quote=False).replace("$", "&#36;")


def colour_of(options: Sequence[str], option: str) -> str:
    """The colour of a price option, by its place among all options."""
    place = options.index(option) if option in options else len(options)
    return OPTION_COLOURS[place % len(OPTION_COLOURS)]


def stamp(moment: datetime) -> str:
    """A moment as Plotly reads dates."""
    return moment.strftime("%Y-%m-%dT%H:%M")


def clock(moment: datetime, *, with_date: bool = False) -> str:
    """A clock time, with the date if asked for."""
    return moment.strftime("%H:%M, %d %b" if with_date else "%H:%M")


def spans(outlook: Outlook) -> list[str]:
    """Every interval in words, `17:00–18:00`."""
    dated = outlook.crosses_midnight
    return [
        f"{clock(begin)}–{clock(end, with_date=dated)}"
        for begin, end in zip(outlook.times, outlook.times[1:], strict=False)
    ]


def time_axis(outlook: Outlook, *, room: float = 0.0) -> dict[str, Any]:
    """An axis of clock time over the horizon; `room` adds that share of it on the right."""
    hours = (outlook.end - outlook.start).total_seconds() / 3600
    step = next((h for h in TICK_HOURS if hours / h <= MAX_TICKS), TICK_HOURS[-1])
    return {
        "type": "date",
        "range": [stamp(outlook.start), stamp(outlook.end + (outlook.end - outlook.start) * room)],
        "dtick": step * HOUR_MS,
        "tick0": stamp(outlook.start.replace(hour=0, minute=0)),
        "tickformat": "%H:%M\n%d %b" if outlook.crosses_midnight else "%H:%M",
        "hoverformat": "%H:%M, %d %b" if outlook.crosses_midnight else "%H:%M",
        # with dates below the times there is no room for a title, nor any need of one
        "title": {"text": "" if outlook.crosses_midnight else "Clock time"},
        "showgrid": True,
        "zeroline": False,
    }


def now_shapes(outlook: Outlook) -> list[dict[str, Any]]:
    """The future tinted, and a line where it begins."""
    across = {"xref": "x", "yref": "paper", "y0": 0, "y1": 1}
    now, end = stamp(outlook.clock), stamp(outlook.end)
    return [
        across
        | {"type": "rect", "x0": now, "x1": end, "fillcolor": FUTURE, "layer": "below"}
        | {"line": {"width": 0}},
        across
        | {"type": "line", "x0": now, "x1": now}
        | {"line": {"color": VERMILLION, "width": 2}},
    ]


def now_label(outlook: Outlook) -> dict[str, Any]:
    """The clock time beside the now line, on whichever side there is room."""
    late = outlook.now > outlook.n_intervals / 2
    return {
        "x": stamp(outlook.clock),
        "xref": "x",
        "y": 1,
        "yref": "paper",
        "yanchor": "bottom",
        "xanchor": "right" if late else "left",
        "showarrow": False,
        "text": f"now {clock(outlook.clock)}",
        "font": {"color": VERMILLION, "size": FONT_PX},
    }


def empty_note(text: str) -> dict[str, Any]:
    """A word in the middle of a chart that has nothing to show yet."""
    return {
        "x": 0.5,
        "xref": "paper",
        "y": 0.5,
        "yref": "paper",
        "showarrow": False,
        "text": text,
        "font": {"size": FONT_PX + 2},
    }


def figure(traces: list[Trace], height: int, **layout: Any) -> Figure:
    """A figure with the look all charts share."""
    return {
        "data": traces,
        "layout": {
            "height": height,
            "font": {"size": FONT_PX},
            "margin": MARGIN,
            "paper_bgcolor": CLEAR,
            "plot_bgcolor": CLEAR,
            "legend": LEGEND,
            "hoverlabel": {"font": {"size": FONT_PX}},
            **layout,
            **{name: {**AS_IT_IS, **axis} for name, axis in layout.items() if is_axis(name)},
        },
    }


def fixed_figure(traces: list[Trace], height: int, margin: dict[str, int], **layout: Any) -> Figure:
    """A figure with just these margins. Where plotly finds them itself, it draws it twice."""
    axes = {name: {**axis, "automargin": False} for name, axis in layout.items() if is_axis(name)}
    return figure(traces, height, **{**layout, **axes, "margin": {**margin, "autoexpand": False}})


def is_axis(name: str) -> bool:
    """Whether this key of a layout is an axis."""
    return name.startswith(("xaxis", "yaxis"))


def value_axis(title: str, **axis: Any) -> dict[str, Any]:
    """An axis of values, its title with the unit."""
    return {"title": {"text": title}, "zeroline": False, "automargin": True, **axis}


def step_line(outlook: Outlook, values: Sequence[float] | Floats, **trace: Any) -> Trace:
    """A line that holds each interval's value until the interval ends."""
    held = [_number(value) for value in values]
    return {
        "type": "scatter",
        "mode": "lines",
        "x": [stamp(moment) for moment in outlook.times[: len(held) + 1]] if held else [],
        "y": [*held, *held[-1:]],
        "line": {"shape": "hv"},
        **trace,
    }


def _number(value: float) -> float | None:
    """A value as JSON can carry it; none where it is infinite or missing."""
    number = float(value)
    return round(number, 6) if abs(number) < float("inf") else None
