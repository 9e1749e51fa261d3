"""Several runs over each other, each with a colour and a line style of its own."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Any

import numpy as np

from evdash.charts.style import (
    FONT_PX,
    OPTION_COLOURS,
    VERMILLION,
    Figure,
    clock,
    empty_note,
    figure,
    safe,
    stamp,
    time_axis,
    value_axis,
)
from evdash.domain.limits import Floats
from evdash.domain.outlook import Outlook
from evdash.domain.trace import Trace

HEIGHT_PX = 360
DASHES = ("solid", "dash", "dot", "dashdot", "longdash", "longdashdot")
LONGEST_NAME = 28


@dataclass(frozen=True, slots=True)
class Compared:
    """A run under the name it is compared by; only what was executed is drawn."""

    name: str
    trace: Trace
    outlook: Outlook


Values = Callable[[Compared], Floats]


def station_kw(run: Compared) -> Floats:
    """Station load of each executed interval, kW."""
    return run.outlook.station_kw[: run.outlook.now]


def headroom_kw(run: Compared) -> Floats:
    """Room for charging in each executed interval, kW; inf where nothing limits."""
    return run.outlook.headroom_kw[: run.outlook.now]


def price_per_kwh(run: Compared) -> Floats:
    """Energy price of each executed interval, $/kWh."""
    return run.outlook.price_per_kwh[: run.outlook.now]


def lowest_voltage_pu(run: Compared) -> Floats:
    """Voltage of the lowest node in each executed interval, linearised, pu."""
    return np.asarray(run.outlook.voltage_pu[: run.outlook.now].min(axis=1))


def admitted_so_far(run: Compared) -> Floats:
    """Vehicles admitted up to the end of each executed interval."""
    return np.cumsum([len(step.plan.admitted) for step in run.trace.steps], dtype=float)


def refused_so_far(run: Compared) -> Floats:
    """Vehicles refused up to the end of each executed interval."""
    return np.cumsum([len(step.plan.refused) for step in run.trace.steps], dtype=float)


QUANTITIES: dict[str, tuple[Values, str, str]] = {
    "Station load": (station_kw, "Station load, kW", "%{y:,.1f} kW"),
    "Headroom": (headroom_kw, "Headroom, kW", "%{y:,.1f} kW"),
    "Energy price": (price_per_kwh, "Energy price, $/kWh", "&#36;%{y:.4f} per kWh"),
    "Admitted": (admitted_so_far, "Admitted so far, vehicles", "%{y:.0f} admitted"),
    "Refused": (refused_so_far, "Refused so far, vehicles", "%{y:.0f} refused"),
    "Lowest voltage": (lowest_voltage_pu, "Lowest voltage, pu", "%{y:.4f} pu"),
}
"""What can be drawn of runs: its values, the title of its axis, and how a value is told."""


def overlay_figure(runs: Sequence[Compared], quantity: str) -> Figure:
    """One quantity of every run over the clock, dates aside: each begins on the first one's day."""
    values, title, told = QUANTITIES[quantity]
    shifted = [_on_the_day_of(runs[0], run) for run in runs]
    traces = [_line(run, values(run), n, told) for n, run in enumerate(shifted)]
    begun = any(run.outlook.now for run in runs)
    longest = max(shifted, key=lambda run: run.outlook.end)
    earliest = min(run.outlook.start for run in shifted)
    span = replace(longest.outlook, times=(earliest, *longest.outlook.times[1:]))
    is_voltage = quantity == "Lowest voltage"
    counts_from_zero = quantity not in ("Lowest voltage", "Energy price")
    return figure(
        traces,
        HEIGHT_PX,
        hovermode="x unified",
        showlegend=True,
        xaxis=time_axis(span),
        yaxis=value_axis(title, **({"rangemode": "tozero"} if counts_from_zero else {})),
        shapes=_voltage_limits(runs) if is_voltage else [],
        annotations=[
            *(_limit_labels(runs) if is_voltage else []),
            *([] if begun else [empty_note("None of these runs has begun")]),
        ],
    )


def overlay_table(runs: Sequence[Compared], quantity: str) -> list[dict[str, object]]:
    """The same as rows of a table: a row for each time at which an interval of any run begins."""
    values = QUANTITIES[quantity][0]
    columns: dict[str, dict[datetime, float]] = {}
    for run in (_on_the_day_of(runs[0], run) for run in runs):
        found = (
            None if not np.isfinite(value) else round(float(value), 5) for value in values(run)
        )
        columns[run.name] = dict(zip(run.outlook.times, found, strict=False))  # type: ignore[arg-type]
    moments = sorted({moment for column in columns.values() for moment in column})
    days = {moment.date() for moment in moments}
    return [
        {"From": clock(moment, with_date=len(days) > 1)}
        | {name: column.get(moment) for name, column in columns.items()}
        for moment in moments
    ]


def overlay_alt(runs: Sequence[Compared], quantity: str) -> str:
    """The chart in one sentence."""
    title = QUANTITIES[quantity][1]
    told = []
    for run in runs:
        values = QUANTITIES[quantity][0](run)
        finite = values[np.isfinite(values)]
        reach = f"{finite.min():.4g} to {finite.max():.4g}" if len(finite) else "nothing yet"
        told.append(f"{run.name} {reach}")
    return f"Lines over the clock, {title}, of {len(runs)} runs: {'; '.join(told)}."


def _on_the_day_of(first: Compared, run: Compared) -> Compared:
    days = first.outlook.start.date() - run.outlook.start.date()
    times = tuple(moment + days for moment in run.outlook.times)
    return replace(run, outlook=replace(run.outlook, times=times))


def _line(run: Compared, values: Floats, place: int, told: str) -> dict[str, Any]:
    held = [round(float(value), 6) if np.isfinite(value) else None for value in values]
    return {
        "type": "scatter",
        "mode": "lines",
        "name": safe(_short(run.name)),
        "x": [stamp(moment) for moment in run.outlook.times[: len(held) + 1]] if held else [],
        "y": [*held, *held[-1:]],
        "line": {
            "color": OPTION_COLOURS[place % len(OPTION_COLOURS)],
            "dash": DASHES[place % len(DASHES)],
            "width": 2.5,
            "shape": "hv",
        },
        "hovertemplate": told,
    }


def _short(name: str) -> str:
    return name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 1]}…"


def _limits(runs: Sequence[Compared]) -> list[float]:
    """The lowest voltages allowed; the highest is no concern of the lowest node."""
    return sorted({run.outlook.voltage_min_pu for run in runs})


def _voltage_limits(runs: Sequence[Compared]) -> list[dict[str, Any]]:
    across = {"type": "line", "xref": "paper", "x0": 0, "x1": 1, "yref": "y"}
    line = {"line": {"color": VERMILLION, "width": 2, "dash": "dash"}}
    return [across | line | {"y0": limit, "y1": limit} for limit in _limits(runs)]


def _limit_labels(runs: Sequence[Compared]) -> list[dict[str, Any]]:
    return [
        {
            "x": 0.005,
            "xref": "paper",
            "xanchor": "left",
            "y": limit,
            "yref": "y",
            "yanchor": "bottom",
            "showarrow": False,
            "text": f"lowest allowed {limit:g} pu",
            "font": {"size": FONT_PX - 1, "color": VERMILLION},
        }
        for limit in _limits(runs)
    ]
