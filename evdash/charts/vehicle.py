"""One vehicle: its power by the hour, and its state of charge against the promise."""

from datetime import datetime, timedelta
from typing import Any

import numpy as np

from evdash.charts.style import (
    BLUE,
    CLEAR,
    FONT_PX,
    GREEN,
    HOUR_MS,
    MAX_TICKS,
    ORANGE,
    OUTLINE,
    TICK_HOURS,
    VERMILLION,
    Figure,
    clock,
    figure,
    now_shapes,
    spans,
    stamp,
    time_axis,
    value_axis,
)
from evdash.domain.outlook import Outlook
from evdash.metrics.vehicles import VehicleDay

HEIGHT_PX = 420
POWER_DOMAIN, SOC_DOMAIN = [0.6, 1.0], [0.0, 0.47]
PLANNED = {
    "color": CLEAR,
    "line": {"color": BLUE, "width": 1},
    "pattern": {"shape": "/", "size": 6, "solidity": 0.4, "fgcolor": BLUE, "bgcolor": CLEAR},
}


def vehicle_figure(day: VehicleDay, outlook: Outlook) -> Figure:
    """Power and price above, state of charge against the promise below."""
    request = day.request
    return figure(
        [
            _power(day, outlook, executed=True),
            _power(day, outlook, executed=False),
            _price(day, outlook),
            _least(day, outlook),
            _charged(day, outlook),
            *_promises(day, outlook),
        ],
        HEIGHT_PX,
        barmode="overlay",
        margin={"l": 60, "r": 66, "t": 58, "b": 44},
        xaxis=window_axis(day, outlook) | {"anchor": "y2"},
        yaxis=value_axis("Power, kW", domain=POWER_DOMAIN, range=[0, 1.15 * request.max_kw]),
        yaxis2=value_axis(
            "Battery, %",
            domain=SOC_DOMAIN,
            range=[
                max(0.0, 100 * request.soc_in - 8),
                min(106.0, 100 * max(request.soc_out, day.due_soc) + 12),
            ],
            nticks=6,
        ),
        yaxis3=value_axis(
            "Price, $/kWh",
            overlaying="y",
            side="right",
            showgrid=False,
            range=_price_range(outlook),
            tickmode="auto",
            nticks=4,
            tickformat=".3~f",
        ),
        shapes=[*now_shapes(outlook), _charger_line(request.max_kw)],
        annotations=[_charger_label(request.max_kw)],
    )


def vehicle_table(day: VehicleDay, outlook: Outlook) -> list[dict[str, object]]:
    """The same as rows of a table: its window, interval by interval."""
    return [
        {
            "Interval": spans(outlook)[t],
            "": "executed" if t < outlook.now else "planned",
            "Power, kW": round(float(day.power_kw[t]), 2),
            "Price, $/kWh": round(float(outlook.price_per_kwh[t]), 6),
            "Battery at its end, %": round(100 * float(day.soc[t + 1]), 1),
            "Needed at its end, %": round(100 * float(day.least_soc[t + 1]), 1),
        }
        for t in _window(day, outlook)
    ]


def vehicle_alt(day: VehicleDay, outlook: Outlook) -> str:
    """The chart in one sentence."""
    request = day.request
    by = clock(outlook.times[request.deadline_interval], with_date=outlook.crosses_midnight)
    asked = f"from {100 * request.soc_in:.0f} to {100 * request.soc_out:.0f} % of its battery"
    if not day.is_admitted:
        return f"Power and battery of {request.vehicle}: refused; it asked {asked} by {by}."
    hours = int((day.power_kw > 0).sum())
    return (
        f"Power and battery of {request.vehicle} by interval: it charges in {hours} intervals, "
        f"{asked}, promised by {by}."
    )


def window_axis(day: VehicleDay, outlook: Outlook) -> dict[str, Any]:
    """Clock time from the vehicle's arrival to its promised return, with a little room."""
    begin, end = _ends(day, outlook)
    hours = (end - begin).total_seconds() / 3600
    step = next((h for h in TICK_HOURS if hours / h <= MAX_TICKS), TICK_HOURS[-1])
    room = timedelta(hours=0.06 * hours)
    return time_axis(outlook) | {
        "range": [stamp(begin - room), stamp(end + room)],
        "dtick": step * HOUR_MS,
    }


def _ends(day: VehicleDay, outlook: Outlook) -> tuple[datetime, datetime]:
    least = outlook.times[1] - outlook.start
    begin = day.request.arrival
    return begin, max(outlook.times[_end(day)], begin + least)


def _window(day: VehicleDay, outlook: Outlook) -> range:
    return range(min(day.request.arrival_interval, outlook.n_intervals), _end(day))


def _end(day: VehicleDay) -> int:
    """As first promised or as last agreed, whichever is later."""
    return max(day.request.deadline_interval, day.due_interval)


def _power(day: VehicleDay, outlook: Outlook, *, executed: bool) -> dict[str, Any]:
    words = spans(outlook)
    shown = [int(t) for t in np.flatnonzero(day.power_kw > 0) if (int(t) < outlook.now) == executed]
    ms = (outlook.times[1] - outlook.start).total_seconds() * 1000
    return {
        "type": "bar",
        "name": "Charged" if executed else "Planned",
        "x": [stamp(outlook.times[t]) for t in shown],
        "y": [round(float(day.power_kw[t]), 3) for t in shown],
        "offset": 0,
        "width": ms,
        "marker": {"color": BLUE, "line": {"width": 0}} if executed else PLANNED,
        "hovertext": [
            f"{words[t]}: {day.power_kw[t]:.1f} kW{'' if executed else ' planned'}" for t in shown
        ],
        "hovertemplate": "%{hovertext}<extra></extra>",
    }


def _price(day: VehicleDay, outlook: Outlook) -> dict[str, Any]:
    begin, end = _ends(day, outlook)
    step = outlook.times[1] - outlook.start
    shown = [t for t, time in enumerate(outlook.times[:-1]) if begin - step <= time <= end] or [
        outlook.n_intervals - 1
    ]
    values = [round(float(outlook.price_per_kwh[t]), 6) for t in shown]
    return {
        "type": "scatter",
        "mode": "lines",
        "name": "Energy price",
        "yaxis": "y3",
        "x": [*(stamp(outlook.times[t]) for t in shown), stamp(outlook.times[shown[-1] + 1])],
        "y": [*values, values[-1]],
        "line": {"color": ORANGE, "width": 2, "dash": "dashdot", "shape": "hv"},
        "hovertemplate": "%{x}: &#36;%{y:.4f} per kWh<extra></extra>",
    }


def _price_range(outlook: Outlook) -> list[float]:
    """So that the line stays clear of the words at the top."""
    low, high = float(outlook.price_per_kwh.min()), float(outlook.price_per_kwh.max())
    return [1.1 * min(0.0, low), 1.35 * max(high, 0.01)]


def _charged(day: VehicleDay, outlook: Outlook) -> dict[str, Any]:
    """The battery from arrival to the promised return, level until the first interval."""
    window = [*_window(day, outlook), _end(day)]
    return {
        "type": "scatter",
        "mode": "lines+markers",
        "name": "Battery" if day.is_admitted else "Battery, not charged here",
        "yaxis": "y2",
        "x": [stamp(day.request.arrival), *(stamp(outlook.times[t]) for t in window)],
        "y": [round(100 * float(soc), 3) for soc in (day.request.soc_in, *day.soc[window])],
        "line": {"color": BLUE, "width": 3},
        "marker": {"size": 5},
        "hovertemplate": "%{x}: %{y:.1f} % charged<extra></extra>",
    }


def _least(day: VehicleDay, outlook: Outlook) -> dict[str, Any]:
    window = [*_window(day, outlook), _end(day)]
    return {
        "type": "scatter",
        "mode": "lines",
        "name": "Least to keep the promise" if day.is_admitted else "Least it would need",
        "yaxis": "y2",
        "x": [stamp(outlook.times[t]) for t in window],
        "y": [round(100 * float(soc), 3) for soc in day.least_soc[window]],
        "line": {"color": VERMILLION, "width": 2, "dash": "dash"},
        "hovertemplate": "%{x}: needs %{y:.1f} % at the least<extra></extra>",
    }


def _promises(day: VehicleDay, outlook: Outlook) -> list[dict[str, Any]]:
    """What is due and when; and what was promised at first where an event changed it."""
    request = day.request
    if not day.is_admitted:
        look = {"symbol": "star-open", "size": 14, "color": VERMILLION}
        return [_star(outlook, "asked for", request.deadline_interval, request.soc_out, look)]
    first = (request.deadline_interval, request.soc_out)
    due = (day.due_interval, day.due_soc)
    look = {"symbol": "star", "size": 14, "color": GREEN}
    if due == first:
        return [_star(outlook, "promised", *first, look)]
    past = {"symbol": "star-open", "size": 12, "color": OUTLINE}
    return [
        _star(outlook, "promised at first", *first, past),
        _star(outlook, "agreed since", *due, look),
    ]


def _star(
    outlook: Outlook, word: str, interval: int, soc: float, look: dict[str, Any]
) -> dict[str, Any]:
    by = clock(outlook.times[interval], with_date=outlook.crosses_midnight)
    return {
        "type": "scatter",
        "mode": "markers",
        "name": f"{100 * soc:.0f} % {word} by {by}",
        "yaxis": "y2",
        "x": [stamp(outlook.times[interval])],
        "y": [round(100 * soc, 3)],
        "marker": look,
        "cliponaxis": False,
        "hovertemplate": "%{y:.0f} % by %{x}<extra></extra>",
    }


def _charger_line(max_kw: float) -> dict[str, Any]:
    return {
        "type": "line",
        "xref": "paper",
        "x0": 0,
        "x1": 1,
        "yref": "y",
        "y0": max_kw,
        "y1": max_kw,
        "line": {"color": OUTLINE, "width": 1.5, "dash": "dot"},
    }


def _charger_label(max_kw: float) -> dict[str, Any]:
    return {
        "x": 0.01,
        "xref": "paper",
        "xanchor": "left",
        "y": max_kw,
        "yref": "y",
        "yanchor": "bottom",
        "showarrow": False,
        "text": f"at most {max_kw:g} kW",
        "font": {"size": FONT_PX - 2},
    }
