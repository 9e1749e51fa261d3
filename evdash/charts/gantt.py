"""Bars of time, one line a vehicle: its window, the energy charged and the energy planned."""

import math
from collections import defaultdict
from collections.abc import Sequence
from typing import Any

from evdash.charts.rows import Row
from evdash.charts.style import (
    BLUE,
    CLEAR,
    FONT_PX,
    HOUR_MS,
    LEGEND,
    OUTLINE,
    VERMILLION,
    WINDOW,
    Figure,
    clock,
    colour_of,
    empty_note,
    fixed_figure,
    now_label,
    now_shapes,
    safe,
    spans,
    stamp,
    time_axis,
    value_axis,
)
from evdash.domain.outlook import Outlook

FRAME_PX = 98
LABEL_PX = 12.5
LABEL_SHARE = 0.095
"""So much of the horizon lies under the text at a window's end."""
ROOMY_PX = 15
"""A line at least so high carries text of the ordinary small size."""
ADMITTED_LOOK = {"color": WINDOW, "line": {"color": OUTLINE, "width": 1}}
SHORT_LOOK = {"color": "rgba(213,94,0,0.18)", "line": {"color": VERMILLION, "width": 2}}
REFUSED_LOOK = {
    "color": CLEAR,
    "line": {"color": VERMILLION, "width": 1},
    "pattern": {"shape": "x", "size": 8, "solidity": 0.12, "fgcolor": VERMILLION, "bgcolor": CLEAR},
}


def gantt(
    outlook: Outlook,
    options: Sequence[str],
    rows: list[Row],
    *,
    height_px: int,
    lines: int,
    empty: str,
    picked: str = "",
) -> Figure:
    """Rows as bars, the first on top, in a chart with room for so many `lines`.

    `empty` is said where there are no rows; the vehicle `picked` is framed.
    """
    used = sorted({row.request.option for row in rows} - set(options))
    traces = _windows(outlook, rows)
    for option in [*options, *used]:
        colour = colour_of(options, option)
        traces.append(_bars(outlook, rows, option, colour, executed=True))
        traces.append(_bars(outlook, rows, option, colour, executed=False))
    size_px = 12 if lines * ROOMY_PX <= height_px else 11
    traces += [_percents(outlook, rows, size_px, short) for short in (False, True)]
    return fixed_figure(
        traces,
        height_px,
        {"l": 70, "r": 24, "t": 58, "b": 46},
        barmode="overlay",
        legend={**LEGEND, "font": {"size": FONT_PX - 1}},
        xaxis=time_axis(outlook, room=0.085),
        yaxis=row_axis(rows, lines, height_px),
        shapes=[*now_shapes(outlook), *frame_of(rows, picked)],
        annotations=[
            *([now_label(outlook)] if outlook.now else []),
            *([] if rows else [empty_note(empty)]),
        ],
    )


def row_axis(rows: list[Row], lines: int, height_px: int) -> dict[str, Any]:
    """One line a vehicle, the first on top; every n-th label, so that they never overlap."""
    every = max(1, math.ceil(LABEL_PX * lines / (height_px - FRAME_PX)))
    places = range(0, len(rows), every)
    return value_axis(
        "",
        range=[lines - 0.5, -0.5],
        tickvals=list(places),
        ticktext=[safe(_short(rows[n].request.vehicle)) for n in places],
        tickfont={"size": FONT_PX - 2},
        showgrid=False,
    )


def frame_of(rows: list[Row], picked: str) -> list[dict[str, Any]]:
    """A frame around the line of the vehicle picked, if it is there."""
    return [
        {
            "type": "rect",
            "xref": "paper",
            "yref": "y",
            "x0": 0,
            "x1": 1,
            "y0": y - 0.5,
            "y1": y + 0.5,
            "line": {"color": BLUE, "width": 2},
            "fillcolor": "rgba(0,114,178,0.12)",
            "layer": "below",
        }
        for y, row in enumerate(rows)
        if row.request.vehicle == picked
    ]


def _short(name: str) -> str:
    return name if len(name) <= 9 else f"{name[:8]}…"


def _windows(outlook: Outlook, rows: list[Row]) -> list[dict[str, Any]]:
    """Promised windows, and those asked for in vain where there are any."""
    admitted = [(y, row) for y, row in enumerate(rows) if not row.is_refused]
    refused = [(y, row) for y, row in enumerate(rows) if row.is_refused]
    kept = [(y, row) for y, row in admitted if not row.short_kwh]
    short = [(y, row) for y, row in admitted if row.short_kwh]
    traces = [_window_bars(outlook, "Promised", kept, ADMITTED_LOOK)]
    if short:
        traces.append(_window_bars(outlook, "Short of its promise", short, SHORT_LOOK))
    if refused:
        traces.append(_window_bars(outlook, "Refused", refused, REFUSED_LOOK))
    return traces


def _window_bars(
    outlook: Outlook, name: str, rows: list[tuple[int, Row]], look: dict[str, Any]
) -> dict[str, Any]:
    begins = [outlook.times[_first(outlook, row)] for _, row in rows]
    ends = [outlook.times[row.request.deadline_interval] for _, row in rows]
    return {
        "type": "bar",
        "orientation": "h",
        "name": name,
        "y": [y for y, _ in rows],
        "base": [stamp(begin) for begin in begins],
        "x": [
            (end - begin).total_seconds() * 1000 for begin, end in zip(begins, ends, strict=True)
        ],
        "width": 0.86,
        "marker": look,
        "hovertext": [_told(outlook, row) for _, row in rows],
        "hovertemplate": "%{hovertext}<extra></extra>",
    }


def _first(outlook: Outlook, row: Row) -> int:
    """Whoever comes after the last interval has begun stands at the very end."""
    return min(row.request.arrival_interval, outlook.n_intervals)


def _told(outlook: Outlook, row: Row) -> str:
    request = row.request
    end = clock(outlook.times[request.deadline_interval], with_date=outlook.crosses_midnight)
    who = f"{safe(request.vehicle)} ({safe(request.option)}): {request.need_kwh:.1f} kWh"
    if row.is_refused:
        return f"{who} asked for by {end}, refused"
    short = f", {row.short_kwh:.1f} kWh of it missing" if row.short_kwh else ""
    return f"{who} promised by {end}{short}, {row.delivered_kwh:.1f} kWh delivered"


def _bars(
    outlook: Outlook, rows: list[Row], option: str, colour: str, *, executed: bool
) -> dict[str, Any]:
    """One option's energy, charged or planned; the thicker a bar, the higher the power."""
    columns: dict[str, list[Any]] = defaultdict(list)
    words = spans(outlook)
    ms = HOUR_MS * (outlook.times[1] - outlook.start).total_seconds() / 3600
    for y, row in enumerate(rows):
        if row.request.option != option:
            continue
        for interval, power_kw in sorted(row.power_kw.items()):
            if (interval < outlook.now) == executed:
                columns["base"].append(stamp(outlook.times[interval]))
                columns["x"].append(ms)
                columns["y"].append(y)
                columns["width"].append(round(0.3 + 0.5 * power_kw / row.request.max_kw, 3))
                columns["hovertext"].append(
                    f"{safe(row.request.vehicle)} ({safe(option)}), {words[interval]}: "
                    f"{power_kw:.1f} kW"
                )
    pattern = {"shape": "/", "size": 5, "solidity": 0.4, "fgcolor": colour, "bgcolor": CLEAR}
    solid = {"color": colour, "line": {"width": 0}}
    planned = {"color": CLEAR, "line": {"color": colour, "width": 1}, "pattern": pattern}
    return {
        "type": "bar",
        "orientation": "h",
        "name": f"{safe(option)} {'charged' if executed else 'planned'}",
        **{key: columns[key] for key in ("base", "x", "y", "width", "hovertext")},
        "marker": solid if executed else planned,
        "hovertemplate": f"%{{hovertext}}{'' if executed else ' planned'}<extra></extra>",
    }


def _percents(outlook: Outlook, rows: list[Row], size_px: int, short: bool) -> dict[str, Any]:
    """Option and percent complete at the end of each window, and whether its promise is `short`;
    so no row is told by colour alone.

    Where the now line would cross the text, it stands behind the line.
    """
    shown = [(y, row) for y, row in enumerate(rows) if bool(row.short_kwh) == short]
    room = (outlook.end - outlook.start) * LABEL_SHARE
    ends = [outlook.times[row.request.deadline_interval] for _, row in shown]
    places = [outlook.clock if end <= outlook.clock < end + room else end for end in ends]
    return {
        "type": "scatter",
        "mode": "text",
        "showlegend": False,
        "x": [stamp(place) for place in places],
        "y": [y for y, _ in shown],
        "text": [
            f" {safe(_short(row.request.option))} "
            f"{'refused' if row.is_refused else f'{row.percent} %'}{' !' if short else ''}"
            for _, row in shown
        ],
        "textposition": "middle right",
        "textfont": {"size": size_px} | ({"color": VERMILLION} if short else {}),
        "hoverinfo": "skip",
        "cliponaxis": False,
    }
