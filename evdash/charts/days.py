"""Solving times of many days, beside the range a paper reports."""

import statistics
from collections.abc import Mapping, Sequence

from evdash.charts.style import BLUE, FONT_PX, ORANGE, Figure, empty_note, figure, value_axis

HEIGHT_PX = 300
LEAST_SECONDS = 0.01


def days_figure(
    series: Mapping[str, Sequence[float]], published: tuple[float, float, float]
) -> Figure:
    """A dot a day on an axis of seconds, a row a series, and the published range with median."""
    names = [*series, "Published"]
    low, median, high = published
    traces: list[dict[str, object]] = [
        {
            "type": "box",
            "orientation": "h",
            "name": name,
            "x": [max(LEAST_SECONDS, round(value, 4)) for value in seconds],
            "y": [name] * len(seconds),
            "boxpoints": "all",
            "jitter": 0.6,
            "pointpos": 0,
            "fillcolor": "rgba(0,114,178,0.15)",
            "marker": {"color": BLUE, "size": 5, "opacity": 0.6},
            "line": {"color": BLUE, "width": 1.5},
            "hovertemplate": "%{x:.2f} s<extra></extra>",
        }
        for name, seconds in series.items()
    ]
    traces.append(
        {
            "type": "scatter",
            "mode": "lines+markers+text",
            "name": "Published",
            "x": [low, median, high],
            "y": ["Published"] * 3,
            "text": [f"{low:g} s", f"median {median:g} s", f"{high:g} s"],
            "textposition": ["top left", "bottom center", "top right"],
            "textfont": {"size": FONT_PX - 1},
            "line": {"color": ORANGE, "width": 6},
            "marker": {"symbol": "diamond", "size": 13, "color": ORANGE},
            "hovertemplate": "%{x:.1f} s<extra></extra>",
        }
    )
    return figure(
        traces,
        HEIGHT_PX,
        showlegend=False,
        margin={"l": 64, "r": 60, "t": 16, "b": 48},
        xaxis=value_axis("Solving one day, s (logarithmic)", type="log", range=[-2, 2]),
        yaxis=value_axis("", categoryorder="array", categoryarray=names[::-1]),
        annotations=[] if any(series.values()) else [empty_note("No day has been run yet")],
    )


def days_alt(series: Mapping[str, Sequence[float]]) -> str:
    """The chart in one sentence."""
    told = [
        f"{name}: {len(seconds)} days, median {statistics.median(seconds):.2f} s"
        for name, seconds in series.items()
        if seconds
    ]
    return "Dots of solving times by day. " + "; ".join(told) + "."
