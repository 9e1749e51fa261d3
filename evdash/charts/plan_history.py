"""A vehicle's plan as it was made and revised, interval after interval."""

import math
from typing import Any

import numpy as np

from evdash.charts.power_map import POWER_SCALE
from evdash.charts.style import (
    COLORBAR,
    FONT_PX,
    VERMILLION,
    Figure,
    clock,
    figure,
    spans,
    stamp,
    value_axis,
)
from evdash.charts.vehicle import window_axis
from evdash.domain.outlook import Outlook
from evdash.metrics.vehicles import PlanHistory, VehicleDay

FRAME_PX, ROW_PX = 96, 24
TALLEST_PX = 420
LEAST_ROWS = 3
MOST_NUMBERS = 14
"""Up to so many columns a cell has room for its number; a colour bar explains the rest."""
MARK_PLACE = 0.2
"""Marks stand beside the number, this share of the cell from its edge."""
CHANGED_KW = 0.05
"""Less than this is not shown as a change."""


def history_figure(history: PlanHistory, day: VehicleDay, outlook: Outlook) -> Figure:
    """A line for every time its plan was made, a column for every interval planned."""
    kept = [[None if math.isnan(kw) else round(float(kw), 3) for kw in p] for p in history.power_kw]
    dated = outlook.crosses_midnight
    made = [clock(outlook.times[t], with_date=dated) for t in history.decided]
    words = spans(outlook)
    rows = len(made)
    height = min(TALLEST_PX, FRAME_PX + ROW_PX * max(LEAST_ROWS, rows))
    numbered = day.due_interval - day.request.arrival_interval <= MOST_NUMBERS
    every = max(1, math.ceil(rows * ROW_PX / (height - FRAME_PX)))
    heat = {
        "type": "heatmap",
        "x": [stamp(time) for time in outlook.times],
        "y": list(range(rows)),
        "z": kept,
        "zmin": 0,
        "zmax": day.request.max_kw,
        "colorscale": POWER_SCALE,
        "xgap": 1,
        "ygap": 1,
        "showscale": not numbered,
        "colorbar": {"title": {"text": "kW"}, **COLORBAR},
        "text": [[f"{kw:.1f}" if numbered and kw else "" for kw in plan] for plan in kept],
        "texttemplate": "%{text}",
        "hoverongaps": False,
        "hovertext": [
            [
                None if kw is None else f"Decided at {at}: {kw:.1f} kW for {word}"
                for kw, word in zip(plan, words, strict=True)
            ]
            for plan, at in zip(kept, made, strict=True)
        ],
        "hovertemplate": "%{hovertext}<extra></extra>",
    }
    return figure(
        [heat, _executed_marks(history, outlook), _changed_marks(history, outlook)],
        height,
        margin={"l": 60, "r": 8, "t": 40, "b": 44},
        xaxis=window_axis(day, outlook)
        | {
            "title": {"text": "Interval planned; numbers in kW" if numbered else "Interval planned"}
        },
        yaxis=value_axis(
            "Decided at",
            range=[max(LEAST_ROWS, rows) - 0.5, -0.5],
            tickvals=list(range(0, rows, every)),
            ticktext=made[::every],
            tickfont={"size": FONT_PX - 2},
            showgrid=False,
        ),
    )


def history_table(history: PlanHistory, outlook: Outlook) -> list[dict[str, object]]:
    """The same as rows of a table: one for every time the plan was made."""
    dated = outlook.crosses_midnight
    return [
        {"Decided at": clock(outlook.times[at], with_date=dated)}
        | {
            f"{clock(outlook.times[t], with_date=dated)}, kW": _cell(plan[t])
            for t in np.flatnonzero(np.nan_to_num(history.power_kw).any(axis=0))
        }
        for at, plan in zip(history.decided, history.power_kw, strict=True)
    ]


def history_alt(history: PlanHistory, outlook: Outlook) -> str:
    """The chart in one sentence."""
    first = clock(outlook.times[history.decided[0]], with_date=outlook.crosses_midnight)
    changed = int((np.abs(np.nan_to_num(np.diff(history.power_kw, axis=0))) > CHANGED_KW).sum())
    return (
        f"Map of the plan of {history.vehicle} as made {len(history.decided)} times since {first}: "
        f"planned power by interval, with {changed} changes marked."
    )


def _cell(kw: float) -> float | None:
    return None if math.isnan(kw) else round(float(kw), 2)


def _executed_marks(history: PlanHistory, outlook: Outlook) -> dict[str, Any]:
    """A dot where what was planned at that moment was carried out at once."""
    place = (outlook.times[1] - outlook.start) * MARK_PLACE
    shown = [
        (y, t)
        for y, (t, plan) in enumerate(zip(history.decided, history.power_kw, strict=True))
        if plan[t] > 0
    ]
    return {
        "type": "scatter",
        "mode": "markers",
        "name": "Carried out",
        "showlegend": True,
        "x": [stamp(outlook.times[t] + place) for _, t in shown],
        "y": [y for y, _ in shown],
        "marker": {"symbol": "circle", "size": 8, "color": "#ffffff"}
        | {"line": {"color": "#000000", "width": 1.5}},
        "hoverinfo": "skip",
    }


def _changed_marks(history: PlanHistory, outlook: Outlook) -> dict[str, Any]:
    """A triangle, up or down, where a plan has more or less power than the one before."""
    place = (outlook.times[1] - outlook.start) * (1 - MARK_PLACE)
    changes = np.diff(history.power_kw, axis=0)
    cells = [(y, t) for y, t in np.argwhere(np.abs(np.nan_to_num(changes)) > CHANGED_KW)]
    return {
        "type": "scatter",
        "mode": "markers",
        "name": "More or less than before",
        "x": [stamp(outlook.times[t] + place) for _, t in cells],
        "y": [int(y) + 1 for y, _ in cells],
        "marker": {
            "symbol": ["triangle-up" if changes[y, t] > 0 else "triangle-down" for y, t in cells],
            "size": 9,
            "color": VERMILLION,
            "line": {"color": "#ffffff", "width": 1},
        },
        "hoverinfo": "skip",
    }
