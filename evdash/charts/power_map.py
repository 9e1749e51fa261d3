"""Power by vehicle and interval, where there are too many vehicles for bars."""

from typing import Any

from evdash.charts.gantt import frame_of, row_axis
from evdash.charts.rows import Row
from evdash.charts.style import (
    COLORBAR,
    VERMILLION,
    WINDOW,
    Figure,
    fixed_figure,
    now_label,
    now_shapes,
    safe,
    spans,
    stamp,
    time_axis,
)
from evdash.domain.outlook import Outlook

# Cividis from its first visible shade on; no power is the colour of the pale window.
POWER_SCALE = [
    [0.0, WINDOW],
    [0.001, WINDOW],
    [0.002, "#00306f"],
    [0.25, "#414d6b"],
    [0.5, "#7c7b78"],
    [0.75, "#bcaf6f"],
    [1.0, "#fee838"],
]
REFUSED = "rgba(213,94,0,0.35)"


def power_map(outlook: Outlook, rows: list[Row], *, height_px: int, picked: str = "") -> Figure:
    """A line a vehicle, a column an interval; pale where a vehicle waits inside its window."""
    refused = [(y, row) for y, row in enumerate(rows) if row.is_refused]
    short = [(y, row) for y, row in enumerate(rows) if row.short_kwh]
    return fixed_figure(
        [
            _power(outlook, rows),
            *([_refused(outlook, refused)] if refused else []),
            *([_short(outlook, short)] if short else []),
        ],
        height_px,
        {"l": 70, "r": 66, "t": 58, "b": 48},
        xaxis=time_axis(outlook),
        yaxis=row_axis(rows, len(rows), height_px),
        shapes=[*now_shapes(outlook), *frame_of(rows, picked)],
        annotations=[
            *([now_label(outlook)] if outlook.now else []),
            _note(len(rows) - len(refused), len(refused), len(short)),
        ],
    )


def _power(outlook: Outlook, rows: list[Row]) -> dict[str, Any]:
    words = spans(outlook)
    power: list[list[float | None]] = []
    told: list[list[str | None]] = []
    for row in rows:
        who = f"{safe(row.request.vehicle)} ({safe(row.request.option)}, {row.percent} % done)"
        inside = [_is_inside(row, t) for t in range(outlook.n_intervals)]
        values = [round(row.power_kw.get(t, 0.0), 3) for t in range(outlook.n_intervals)]
        power.append([value if here else None for value, here in zip(values, inside, strict=True)])
        told.append(
            [
                f"{who}, {word}: {value:.1f} kW" if here else None
                for value, word, here in zip(values, words, inside, strict=True)
            ]
        )
    return {
        "type": "heatmap",
        "x": [stamp(time) for time in outlook.times],
        "y": list(range(len(rows))),
        "z": power,
        "zmin": 0,
        "zmax": max(row.request.max_kw for row in rows),
        "colorscale": POWER_SCALE,
        "colorbar": {"title": {"text": "kW"}, **COLORBAR},
        "hoverongaps": False,
        "hovertext": told,
        "hovertemplate": "%{hovertext}<extra></extra>",
    }


def _is_inside(row: Row, interval: int) -> bool:
    window = range(row.request.arrival_interval, row.request.deadline_interval)
    return interval in window and not row.is_refused


def _refused(outlook: Outlook, refused: list[tuple[int, Row]]) -> dict[str, Any]:
    """A line and a cross for who was refused, from its arrival to the return it asked for."""
    x: list[str | None] = []
    y: list[int | None] = []
    told: list[str | None] = []
    for place, row in refused:
        request = row.request
        begin = min(request.arrival_interval, outlook.n_intervals)
        x += [stamp(outlook.times[begin]), stamp(outlook.times[request.deadline_interval]), None]
        y += [place, place, None]
        who = f"{safe(request.vehicle)} ({safe(request.option)})"
        told += [f"{who}: {request.need_kwh:.1f} kWh refused"] * 2 + [None]
    return {
        "type": "scatter",
        "mode": "lines+markers",
        "showlegend": False,
        "x": x,
        "y": y,
        "line": {"color": REFUSED, "width": 1.5},
        "marker": {"symbol": "x-thin", "size": 5, "line": {"color": VERMILLION, "width": 1.2}},
        "hovertext": told,
        "hovertemplate": "%{hovertext}<extra></extra>",
    }


def _short(outlook: Outlook, short: list[tuple[int, Row]]) -> dict[str, Any]:
    """A triangle at the promised return of whose promise is not kept, or cannot be."""
    return {
        "type": "scatter",
        "mode": "markers",
        "showlegend": False,
        "x": [stamp(outlook.times[row.request.deadline_interval]) for _, row in short],
        "y": [y for y, _ in short],
        "marker": {"symbol": "triangle-left", "size": 9, "color": VERMILLION},
        "hovertext": [
            f"{safe(row.request.vehicle)} ({safe(row.request.option)}): {row.short_kwh:.1f} kWh of "
            "what was promised missing"
            for _, row in short
        ],
        "hovertemplate": "%{hovertext}<extra></extra>",
    }


def _note(admitted: int, refused: int, short: int) -> dict[str, Any]:
    text = f"{admitted} under contract. Pale: promised window; "
    return {
        "x": 0,
        "xref": "paper",
        "y": 1,
        "yref": "paper",
        "yanchor": "bottom",
        "yshift": 26,
        "showarrow": False,
        "text": f"{text}tinted: planned"
        + (f"; crosses: {refused} refused" if refused else "")
        + (f"; triangles: {short} short" if short else ""),
    }
