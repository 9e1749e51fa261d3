"""Who charges when, against what was promised: the paper's Fig. 3, as a Gantt chart."""

import math
from collections import defaultdict
from dataclasses import dataclass, field
from typing import Any

from evdash.charts.style import (
    CLEAR,
    FONT_PX,
    HOUR_MS,
    OUTLINE,
    WINDOW,
    Figure,
    clock,
    colour_of,
    empty_note,
    figure,
    now_label,
    now_shapes,
    safe,
    spans,
    stamp,
    time_axis,
    value_axis,
)
from evdash.domain.outlook import Outlook
from evdash.domain.trace import Trace
from evdash.domain.vehicles import Request

GANTT_MOST = 60
"""Beyond so many vehicles a bar is too thin to read and a heat map takes over."""
HEIGHT_PX, TALL_PX = 600, 760
FRAME_PX = 106
LEAST_ROWS, TALL_FROM = 12, 43
"""The axis has room for so many rows at least; from so many on the chart is taller."""
LABEL_PX = 12.5
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


@dataclass(slots=True)
class Row:
    """One vehicle under contract: what it was promised, and its power by interval in kW."""

    request: Request
    power_kw: dict[int, float] = field(default_factory=dict)
    delivered_kwh: float = 0.0

    @property
    def percent(self) -> int:
        """How much of what it was promised it has, rounded down: 100 means all."""
        return int(100 * self.delivered_kwh / self.request.need_kwh + 1e-6)


def rows_of(trace: Trace) -> list[Row]:
    """A row for everyone admitted so far, in order of admission."""
    rows: dict[str, Row] = {}
    hours = trace.scenario.interval_hours
    for step in trace.steps:
        asked = {request.vehicle: request for request in step.requests}
        for vehicle in step.plan.admitted:
            rows[vehicle] = Row(asked[vehicle])
        for vehicle, power in zip(step.plan.vehicles, step.plan.power_kw[:, 0], strict=True):
            if power > 0:
                rows[vehicle].power_kw[step.interval] = float(power)
                rows[vehicle].delivered_kwh += float(power) * hours
    for contract, tail_kw in zip(trace.state.contracts, trace.state.tail_kw, strict=True):
        for slot, power in enumerate(tail_kw):
            if power > 0:
                rows[contract.vehicle].power_kw[trace.now + slot] = float(power)
    return list(rows.values())


def schedule_figure(trace: Trace, outlook: Outlook) -> Figure:
    """The Gantt chart, or a heat map where there are too many vehicles for bars."""
    rows = rows_of(trace)
    return _gantt(trace, outlook, rows) if len(rows) <= GANTT_MOST else _heat(outlook, rows)


def schedule_table(trace: Trace, outlook: Outlook) -> list[dict[str, object]]:
    """The same as rows of a table: one for each vehicle."""
    dated = outlook.crosses_midnight
    return [
        {
            "Vehicle": row.request.vehicle,
            "Option": row.request.option,
            "From": clock(outlook.times[row.request.arrival_interval], with_date=dated),
            "Promised by": clock(outlook.times[row.request.deadline_interval], with_date=dated),
            "Promised, kWh": round(row.request.need_kwh, 2),
            "Delivered, kWh": round(row.delivered_kwh, 2),
            "Done, %": row.percent,
            "Intervals charged": sum(t < outlook.now for t in row.power_kw),
            "Intervals planned": sum(t >= outlook.now for t in row.power_kw),
        }
        for row in rows_of(trace)
    ]


def schedule_alt(trace: Trace, outlook: Outlook) -> str:
    """The chart in one sentence."""
    rows = rows_of(trace)
    done = sum(row.percent == 100 for row in rows)
    return (
        f"Chart of {len(rows)} vehicles under contract at {clock(outlook.clock)}, one row each: "
        f"promised window, energy charged and energy planned. {done} are fully charged."
    )


def _gantt(trace: Trace, outlook: Outlook, rows: list[Row]) -> Figure:
    options = [option.name for option in trace.scenario.option]
    used = sorted({row.request.option for row in rows} - set(options))
    height = HEIGHT_PX if len(rows) < TALL_FROM else TALL_PX
    traces = [_windows(outlook, rows)]
    for option in [*options, *used]:
        colour = colour_of(options, option)
        traces.append(_bars(outlook, rows, option, colour, executed=True))
        traces.append(_bars(outlook, rows, option, colour, executed=False))
    traces.append(_percents(outlook, rows))
    return figure(
        traces,
        height,
        barmode="overlay",
        margin={"l": 70, "r": 8, "t": 58, "b": 48},
        xaxis=time_axis(outlook, room=0.085),
        yaxis=_row_axis(rows, max(LEAST_ROWS, len(rows)), height),
        shapes=now_shapes(outlook),
        annotations=[
            *([now_label(outlook)] if outlook.now else []),
            *([] if rows else [empty_note("Vehicles appear here once they are admitted")]),
        ],
    )


def _row_axis(rows: list[Row], shown: int, height_px: int) -> dict[str, Any]:
    """One line a vehicle, the first on top; every n-th label, so that they never overlap."""
    every = math.ceil(LABEL_PX * shown / (height_px - FRAME_PX))
    places = range(0, len(rows), every)
    return value_axis(
        "",
        range=[shown - 0.5, -0.5],
        tickvals=list(places),
        ticktext=[safe(_short(rows[n].request.vehicle)) for n in places],
        tickfont={"size": FONT_PX - 2},
        showgrid=False,
        automargin=False,
    )


def _short(name: str) -> str:
    return name if len(name) <= 9 else f"{name[:8]}…"


def _windows(outlook: Outlook, rows: list[Row]) -> dict[str, Any]:
    begins = [outlook.times[row.request.arrival_interval] for row in rows]
    ends = [outlook.times[row.request.deadline_interval] for row in rows]
    dated = outlook.crosses_midnight
    return {
        "type": "bar",
        "orientation": "h",
        "name": "Promised window",
        "y": list(range(len(rows))),
        "base": [stamp(begin) for begin in begins],
        "x": [
            (end - begin).total_seconds() * 1000 for begin, end in zip(begins, ends, strict=True)
        ],
        "width": 0.86,
        "marker": {"color": WINDOW, "line": {"color": OUTLINE, "width": 1}},
        "hovertext": [
            f"{safe(row.request.vehicle)} ({safe(row.request.option)}): "
            f"{row.request.need_kwh:.1f} kWh promised by {clock(end, with_date=dated)}, "
            f"{row.delivered_kwh:.1f} kWh delivered"
            for row, end in zip(rows, ends, strict=True)
        ],
        "hovertemplate": "%{hovertext}<extra></extra>",
    }


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


def _percents(outlook: Outlook, rows: list[Row]) -> dict[str, Any]:
    """Option and percent complete at the end of each window; so no row is told by colour alone."""
    return {
        "type": "scatter",
        "mode": "text",
        "showlegend": False,
        "x": [stamp(outlook.times[row.request.deadline_interval]) for row in rows],
        "y": list(range(len(rows))),
        "text": [f" {safe(_short(row.request.option))} {row.percent} %" for row in rows],
        "textposition": "middle right",
        "textfont": {"size": 12 if len(rows) < TALL_FROM else 11},
        "hoverinfo": "skip",
        "cliponaxis": False,
    }


def _heat(outlook: Outlook, rows: list[Row]) -> Figure:
    """Power by vehicle and interval; pale where a vehicle waits inside its window."""
    power = [
        [
            round(row.power_kw.get(t, 0.0), 3)
            if row.request.arrival_interval <= t < row.request.deadline_interval
            else None
            for t in range(outlook.n_intervals)
        ]
        for row in rows
    ]
    words = spans(outlook)
    told = [
        [
            f"{safe(row.request.vehicle)} ({safe(row.request.option)}, {row.percent} % done), "
            f"{words[t]}: {row.power_kw.get(t, 0.0):.1f} kW"
            for t in range(outlook.n_intervals)
        ]
        for row in rows
    ]
    heat = {
        "type": "heatmap",
        "x": [stamp(time) for time in outlook.times],
        "y": list(range(len(rows))),
        "z": power,
        "zmin": 0,
        "zmax": max(row.request.max_kw for row in rows),
        "colorscale": POWER_SCALE,
        "colorbar": {"title": {"text": "kW"}, "thickness": 14},
        "hoverongaps": False,
        "hovertext": told,
        "hovertemplate": "%{hovertext}<extra></extra>",
    }
    note = {
        "x": 0,
        "xref": "paper",
        "y": 1,
        "yref": "paper",
        "yanchor": "bottom",
        "yshift": 26,
        "showarrow": False,
        "text": f"{len(rows)} vehicles under contract, one line each. Pale: promised window; "
        "tinted: planned",
    }
    return figure(
        [heat],
        TALL_PX,
        margin={"l": 70, "r": 8, "t": 58, "b": 48},
        xaxis=time_axis(outlook),
        yaxis=_row_axis(rows, len(rows), TALL_PX),
        shapes=now_shapes(outlook),
        annotations=[*([now_label(outlook)] if outlook.now else []), note],
    )
