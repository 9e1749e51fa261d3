"""A transformer's hot spot over the horizon, without the station and with it."""

from datetime import datetime
from typing import Any

import numpy as np

from evdash.charts.style import (
    BLUE,
    FONT_PX,
    OUTLINE,
    VERMILLION,
    Figure,
    clock,
    figure,
    spans,
    stamp,
    time_axis,
    value_axis,
)
from evdash.domain.limits import Floats
from evdash.domain.outlook import Outlook
from evdash.metrics.ageing import Ageing

HEIGHT_PX = 330
NORMAL_C = 110.0
MOST_POINTS = 600


def hot_spot_figure(outlook: Outlook, without: Ageing, with_station: Ageing) -> Figure:
    """Both temperatures, and the one at which insulation ages as it is meant to."""
    highest = max(NORMAL_C, without.highest_c, with_station.highest_c)
    lowest = min(float(without.hot_spot_c.min()), float(with_station.hot_spot_c.min()))
    room = 0.08 * (highest - lowest)
    return figure(
        [
            _line(outlook, without, "Without charging", {"color": OUTLINE, "dash": "dash"}),
            _line(outlook, with_station, "With charging", {"color": BLUE, "width": 3}),
        ],
        HEIGHT_PX,
        hovermode="x unified",
        xaxis=time_axis(outlook),
        yaxis=value_axis("Hot spot, °C", range=[lowest - room, highest + room]),
        shapes=[
            {
                "type": "line",
                "xref": "paper",
                "x0": 0,
                "x1": 1,
                "y0": NORMAL_C,
                "y1": NORMAL_C,
                "line": {"color": VERMILLION, "width": 2, "dash": "dash"},
            }
        ],
        annotations=[
            {
                "x": 0.005,
                "xref": "paper",
                "xanchor": "left",
                "y": NORMAL_C,
                "yref": "y",
                "yanchor": "top",
                "showarrow": False,
                "text": f"normal ageing, {NORMAL_C:g} °C",
                "font": {"size": FONT_PX - 1, "color": VERMILLION},
            }
        ],
    )


def hot_spot_table(
    outlook: Outlook, without: Ageing, with_station: Ageing
) -> list[dict[str, object]]:
    """The highest of each interval as rows of a table."""
    columns = [
        np.reshape(found.hot_spot_c, (outlook.n_intervals, -1)).max(axis=1)
        for found in (without, with_station)
    ]
    return [
        {
            "Interval": span,
            "Highest hot spot without charging, °C": round(float(columns[0][t]), 1),
            "Highest hot spot, °C": round(float(columns[1][t]), 1),
        }
        for t, span in enumerate(spans(outlook))
    ]


def hot_spot_alt(outlook: Outlook, without: Ageing, with_station: Ageing) -> str:
    """The chart in one sentence."""
    at = _times(outlook, with_station)[int(with_station.hot_spot_c.argmax())]
    return (
        f"Hot spot of the transformer over the day: at most {with_station.highest_c:.0f} °C at "
        f"{clock(at)} with charging, {without.highest_c:.0f} °C without; it ages normally at "
        f"{NORMAL_C:g} °C."
    )


def _line(outlook: Outlook, found: Ageing, name: str, line: dict[str, Any]) -> dict[str, Any]:
    every = max(1, len(found.hot_spot_c) // MOST_POINTS)
    values: Floats = found.hot_spot_c[::every]
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": [stamp(moment) for moment in _times(outlook, found)[::every]],
        "y": [round(float(value), 2) for value in values],
        "line": {"width": 2, **line},
        "hovertemplate": "%{y:.1f} °C",
    }


def _times(outlook: Outlook, found: Ageing) -> list[datetime]:
    step = (outlook.end - outlook.start) / len(found.hot_spot_c)
    return [outlook.start + step * n for n in range(len(found.hot_spot_c))]
