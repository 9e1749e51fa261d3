"""Room for charging by the hour, and which element leaves no more."""

from itertools import groupby
from typing import Any

import numpy as np

from evdash.charts.style import (
    BLUE,
    FONT_PX,
    GREEN,
    ORANGE,
    OUTLINE,
    PURPLE,
    VERMILLION,
    YELLOW,
    Figure,
    clock,
    empty_note,
    figure,
    now_label,
    now_shapes,
    safe,
    spans,
    stamp,
    step_line,
    time_axis,
    value_axis,
)
from evdash.domain.elements import Element
from evdash.domain.outlook import Outlook
from evdash.domain.words import element_name

HEIGHT_PX = 380
LOOKS = (
    (ORANGE, ""),
    (PURPLE, "/"),
    (GREEN, "x"),
    (YELLOW, "\\"),
    (VERMILLION, "."),
    (OUTLINE, "+"),
)
MOST_NAMED = 10
"""Beyond so many changes of the binding element its name would be written over itself."""
STATION = {"color": BLUE, "width": 3, "shape": "hv"}


def headroom_figure(outlook: Outlook) -> Figure:
    """Bars of headroom, one look for each binding element, and what the station draws."""
    if not np.isfinite(outlook.headroom_kw).any():
        note = "The feeder sets no limit to charging"
        return figure(
            [],
            HEIGHT_PX,
            xaxis=time_axis(outlook),
            yaxis=value_axis("Headroom, kW"),
            annotations=[empty_note(note)],
        )
    elements = list(dict.fromkeys(element for element in outlook.binding if element))
    bars = [_bars(outlook, element, LOOKS[i % len(LOOKS)]) for i, element in enumerate(elements)]
    top = float(outlook.headroom_kw[np.isfinite(outlook.headroom_kw)].max())
    return figure(
        [*bars, _station(outlook)],
        HEIGHT_PX,
        barmode="overlay",
        xaxis=time_axis(outlook),
        yaxis=value_axis(
            "Headroom, kW", range=[0, 1.14 * max(1.0, top, float(outlook.station_kw.max()))]
        ),
        shapes=now_shapes(outlook),
        annotations=[
            *([now_label(outlook)] if outlook.now else []),
            *_labels(outlook),
        ],
    )


def headroom_table(outlook: Outlook) -> list[dict[str, object]]:
    """The same as rows of a table."""
    return [
        {
            "Interval": span,
            "": "executed" if t < outlook.now else "planned",
            "Headroom, kW": round(float(outlook.headroom_kw[t]), 1) if outlook.binding[t] else None,
            "Limited by": element_name(outlook.binding[t]),
            "Station, kW": round(float(outlook.station_kw[t]), 1),
            "Used, %": _used(outlook, t),
        }
        for t, span in enumerate(spans(outlook))
    ]


def headroom_alt(outlook: Outlook) -> str:
    """The chart in one sentence."""
    t = int(outlook.headroom_kw.argmin())
    if not outlook.binding[t]:
        return "Room for charging over the day: the feeder sets no limit."
    return (
        f"Bars of the room for charging by interval: least at {clock(outlook.times[t])}, "
        f"{outlook.headroom_kw[t]:.0f} kW, limited by {element_name(outlook.binding[t])}."
    )


def _used(outlook: Outlook, t: int) -> float | None:
    room = float(outlook.headroom_kw[t])
    return round(100 * float(outlook.station_kw[t]) / room, 1) if 0 < room < np.inf else None


def _bars(outlook: Outlook, element: Element, look: tuple[str, str]) -> dict[str, Any]:
    colour, shape = look
    name = element_name(element)
    shown = [t for t, one in enumerate(outlook.binding) if one == element]
    words = spans(outlook)
    ms = (outlook.times[1] - outlook.start).total_seconds() * 1000
    return {
        "type": "bar",
        "name": safe(name),
        "x": [stamp(outlook.times[t]) for t in shown],
        "y": [round(float(outlook.headroom_kw[t]), 3) for t in shown],
        "offset": 0.04 * ms,
        "width": 0.92 * ms,
        "marker": {
            "color": colour,
            "opacity": 0.6,
            "pattern": {"shape": shape, "size": 7, "solidity": 0.25, "fillmode": "overlay"},
            "line": {"width": 0},
        },
        "hovertext": [
            f"{words[t]}: room for {outlook.headroom_kw[t]:,.1f} kW, limited by {safe(name)}"
            for t in shown
        ],
        "hovertemplate": "%{hovertext}<extra></extra>",
    }


def _station(outlook: Outlook) -> dict[str, Any]:
    return step_line(
        outlook,
        outlook.station_kw,
        name="Station draws",
        line=STATION,
        hovertemplate="%{x}: station %{y:,.1f} kW<extra></extra>",
    )


def _labels(outlook: Outlook) -> list[dict[str, Any]]:
    """The element's name over each run of intervals in which it binds."""
    runs = [
        (element, [t for t, _ in group])
        for element, group in groupby(enumerate(outlook.binding), key=lambda pair: pair[1])
    ]
    if len(runs) > MOST_NAMED:
        return []
    return [
        {
            "x": stamp(
                outlook.times[run[0]] + (outlook.times[run[-1] + 1] - outlook.times[run[0]]) / 2
            ),
            "xref": "x",
            "y": max(float(outlook.headroom_kw[t]) for t in run),
            "yref": "y",
            "yanchor": "bottom",
            "showarrow": False,
            "text": safe(element_name(element)),
            "font": {"size": FONT_PX - 2},
        }
        for element, run in runs
        if element and 7 * len(element_name(element)) < 600 * len(run) / outlook.n_intervals
    ]
