"""Station load against headroom, feeder load and price: the paper's Fig. 4."""

from typing import Any

import numpy as np

from evdash.charts.style import (
    BLUE,
    MARGIN,
    ORANGE,
    PURPLE,
    VERMILLION,
    Figure,
    clock,
    fixed_figure,
    now_label,
    now_shapes,
    spans,
    step_line,
    time_axis,
    value_axis,
)
from evdash.domain.limits import Floats
from evdash.domain.outlook import Outlook

HEIGHT_PX = 330
IN_UNITS_HEIGHT_PX = 430
STATION = {"color": BLUE, "width": 3, "shape": "hv"}
PLANNED = {"color": BLUE, "width": 2.5, "shape": "hv", "dash": "dot"}
HEADROOM = {"color": VERMILLION, "width": 2.5, "shape": "hv", "dash": "dash"}
LOAD = {"color": PURPLE, "width": 2, "shape": "hv"}
PRICE = {"color": ORANGE, "width": 2, "shape": "hv", "dash": "dashdot"}


def normalised_figure(outlook: Outlook) -> Figure:
    """As in the paper: each quantity as a share of its own rating, peak or highest value."""
    traces = [
        *_station(outlook, 100 / outlook.station_rating_kw, "%{y:.0f} % of its rating"),
        step_line(
            outlook,
            100 * outlook.load_kw / _highest(outlook.load_kw),
            name="Feeder load",
            line=LOAD,
            hovertemplate="%{y:.0f} % of its peak",
        ),
        step_line(
            outlook,
            100 * outlook.price_per_kwh / _highest(outlook.price_per_kwh),
            name="Price",
            line=PRICE,
            hovertemplate="%{y:.0f} % of its highest",
        ),
    ]
    lowest = min(0.0, float(100 * outlook.price_per_kwh.min() / _highest(outlook.price_per_kwh)))
    return _over_time(
        outlook,
        traces,
        HEIGHT_PX,
        MARGIN,
        yaxis=value_axis("Share, %", range=[max(lowest, -110) * 1.05, 108]),
    )


def units_figure(outlook: Outlook) -> Figure:
    """The same in kW and $/kWh, in two panels: the feeder's load dwarfs the station's."""
    below = {"yaxis": "y2"}
    traces = [
        *_station(outlook, 1.0, "%{y:.0f} kW"),
        step_line(
            outlook,
            outlook.load_kw,
            name="Feeder load",
            line=LOAD,
            hovertemplate="%{y:,.0f} kW",
            **below,
        ),
        step_line(
            outlook,
            outlook.price_per_kwh,
            name="Price",
            line=PRICE,
            hovertemplate="&#36;%{y:.4f} per kWh",
            yaxis="y3",
        ),
    ]
    return _over_time(
        outlook,
        traces,
        IN_UNITS_HEIGHT_PX,
        {**MARGIN, "r": 76},
        xaxis=time_axis(outlook) | {"anchor": "y2"},
        yaxis=value_axis(
            "Station, kW", domain=[0.55, 1], range=[0, 1.1 * _station_top_kw(outlook)]
        ),
        yaxis2=value_axis("Feeder, kW", domain=[0, 0.45], rangemode="tozero"),
        yaxis3=value_axis(
            "Price, $/kWh",
            overlaying="y2",
            side="right",
            rangemode="tozero",
            showgrid=False,
            tickmode="auto",
            nticks=4,
            tickformat=".2~f" if np.abs(outlook.price_per_kwh).max() > 0.5 else ".3~f",
        ),
    )


def load_table(outlook: Outlook) -> list[dict[str, object]]:
    """Both charts as rows of a table."""
    return [
        {
            "Interval": span,
            "": "executed" if t < outlook.now else "planned",
            "Station, kW": round(float(outlook.station_kw[t]), 1),
            "Headroom, kW": _or_none(outlook.headroom_kw[t], 1),
            "Feeder load, kW": round(float(outlook.load_kw[t]), 1),
            "Price, $/kWh": round(float(outlook.price_per_kwh[t]), 6),
        }
        for t, span in enumerate(spans(outlook))
    ]


def load_alt(outlook: Outlook) -> str:
    """The chart in one sentence."""
    peak = int(np.argmax(outlook.station_kw))
    return (
        f"Lines over the day: station load peaks at {outlook.station_kw[peak]:.0f} kW at "
        f"{clock(outlook.times[peak])}; headroom, feeder load and energy price beside it."
    )


def _station(outlook: Outlook, factor: float, shown: str) -> list[dict[str, Any]]:
    """Executed and planned station load, and headroom, times `factor`."""
    # The planned line starts where the executed one ends, with a gap before it.
    planned = np.where(np.arange(outlook.n_intervals) < outlook.now, np.nan, outlook.station_kw)
    executed = step_line(
        outlook,
        factor * outlook.station_kw[: outlook.now],
        name="Station",
        line=STATION,
        fill="tozeroy",
        fillcolor="rgba(0,114,178,0.25)",
        hovertemplate=shown,
    )
    return [
        executed,
        step_line(outlook, factor * planned, name="Plan", line=PLANNED, hovertemplate=shown),
        step_line(
            outlook,
            factor * outlook.headroom_kw,
            name="Headroom",
            line=HEADROOM,
            hovertemplate=shown,
        ),
    ]


def _over_time(
    outlook: Outlook, traces: list[Any], height: int, margin: dict[str, int], **layout: Any
) -> Figure:
    return fixed_figure(
        traces,
        height,
        margin,
        **{"xaxis": time_axis(outlook), **layout},
        hovermode="x unified",
        shapes=now_shapes(outlook),
        annotations=[now_label(outlook)] if outlook.now else [],
    )


def _station_top_kw(outlook: Outlook) -> float:
    """As high as the station's axis need reach to show its load and where headroom is scarce."""
    finite = outlook.headroom_kw[np.isfinite(outlook.headroom_kw)]
    highest, least = (finite.max(), finite.min()) if len(finite) else (0.0, 0.0)
    most = float(outlook.station_kw.max())
    return max(1.0, most, min(highest, 3 * max(most, least)))


def _highest(values: Floats) -> float:
    return float(np.abs(values).max()) or 1.0


def _or_none(value: float, digits: int) -> float | None:
    return round(float(value), digits) if np.isfinite(value) else None
