"""Nodal voltages with their limits, linearised and by AC power flow."""

from dataclasses import replace
from typing import Any

import numpy as np

from evdash.charts.style import (
    BLUE,
    FONT_PX,
    GREEN,
    ORANGE,
    VERMILLION,
    Figure,
    Trace,
    clock,
    fixed_figure,
    now_label,
    now_shapes,
    safe,
    spans,
    stamp,
    step_line,
    time_axis,
    value_axis,
)
from evdash.charts.voltage_map import (
    VOLTAGE_TOLERANCE_PU,
    AcVoltages,
    deepest_drop_pu,
    drop_map,
    margin_of,
    node_axis,
    node_map,
    outside_marks,
)
from evdash.domain.outlook import Outlook

HEIGHT_PX = 560
LINES_DOMAIN = [0.66, 1.0]


def voltages_figure(outlook: Outlook, ac: AcVoltages) -> Figure:
    """Lowest and highest voltage of each interval over a map of all nodes."""
    return fixed_figure(
        [
            *_lines(outlook),
            *_ac_minimum(outlook, ac),
            node_map(outlook),
            *outside_marks(outlook, ac),
        ],
        HEIGHT_PX,
        margin_of(outlook),
        hovermode="closest",
        xaxis=time_axis(outlook) | {"anchor": "y2"},
        yaxis=value_axis(
            "Voltage, pu",
            domain=LINES_DOMAIN,
            range=_range(outlook, ac),
            nticks=5,
            tickformat=".3f",
        ),
        yaxis2=node_axis(outlook),
        shapes=[*now_shapes(outlook), *_limit_lines(outlook)],
        annotations=[*([now_label(outlook)] if outlook.now else []), *_limit_labels(outlook)],
    )


def base_figure(outlook: Outlook) -> Figure:
    """The same without the station: what the feeder does by itself."""
    return voltages_figure(replace(outlook, voltage_pu=outlook.base_voltage_pu), {})


def drop_figure(outlook: Outlook) -> Figure:
    """By how much charging lowers voltages: the largest drop over a map of all nodes."""
    line = step_line(
        outlook,
        (outlook.base_voltage_pu - outlook.voltage_pu).max(axis=1),
        name="Largest drop by charging",
        line={"color": BLUE, "width": 2.5, "shape": "hv"},
        hovertemplate="%{x}: %{y:.4f} pu<extra></extra>",
    )
    return fixed_figure(
        [line, drop_map(outlook)],
        HEIGHT_PX,
        margin_of(outlook),
        hovermode="closest",
        xaxis=time_axis(outlook) | {"anchor": "y2"},
        yaxis=value_axis(
            "Drop, pu", domain=LINES_DOMAIN, range=[0.0, 1.1 * deepest_drop_pu(outlook)], nticks=5
        ),
        yaxis2=node_axis(outlook),
        shapes=now_shapes(outlook),
        annotations=[now_label(outlook)] if outlook.now else [],
    )


def voltages_table(outlook: Outlook, ac: AcVoltages) -> list[dict[str, object]]:
    """Lowest and highest voltage by interval as rows of a table."""
    rows: list[dict[str, object]] = []
    for t, span in enumerate(spans(outlook)):
        low, high = int(outlook.voltage_pu[t].argmin()), int(outlook.voltage_pu[t].argmax())
        found = ac.get(t)
        solved = found is not None and bool(np.isfinite(found).all())
        rows.append(
            {
                "Interval": span,
                "": "executed" if t < outlook.now else "planned",
                "Lowest, pu": round(float(outlook.voltage_pu[t, low]), 4),
                "at node": outlook.nodes[low],
                "Highest, pu": round(float(outlook.voltage_pu[t, high]), 4),
                "at node ": outlook.nodes[high],
                "Largest drop by charging, pu": round(
                    float((outlook.base_voltage_pu[t] - outlook.voltage_pu[t]).max()), 5
                ),
                "Lowest by AC, pu": (
                    round(float(found.min()), 4) if found is not None and solved else None
                ),
            }
        )
    return rows


def voltages_alt(outlook: Outlook) -> str:
    """The chart in one sentence."""
    t = int(outlook.voltage_pu.min(axis=1).argmin())
    node = outlook.nodes[int(outlook.voltage_pu[t].argmin())]
    return (
        f"Voltages of {len(outlook.nodes)} nodes over the day: lowest "
        f"{outlook.voltage_pu[t].min():.4f} pu at node {node}, {clock(outlook.times[t])}; "
        f"allowed {outlook.voltage_min_pu:g} to {outlook.voltage_max_pu:g} pu."
    )


def _lines(outlook: Outlook) -> list[Trace]:
    lowest, highest = outlook.voltage_pu.min(axis=1), outlook.voltage_pu.max(axis=1)
    return [
        step_line(
            outlook,
            highest,
            name="Highest node",
            line={"color": ORANGE, "width": 2, "dash": "dot", "shape": "hv"},
            hovertemplate="%{x}: highest %{y:.4f} pu<extra></extra>",
        ),
        step_line(
            outlook,
            lowest,
            name="Lowest node, linearised",
            line={"color": BLUE, "width": 2.5, "shape": "hv"},
            hovertemplate="%{x}: lowest %{y:.4f} pu<extra></extra>",
        ),
    ]


def _ac_minimum(outlook: Outlook, ac: AcVoltages) -> list[Trace]:
    """The lowest node in AC, red where it is below its limit, like the marks of the map."""
    solved = {t: v for t, v in sorted(ac.items()) if np.isfinite(v).all()}
    least = outlook.voltage_min_pu - VOLTAGE_TOLERANCE_PU
    kept = {t: v for t, v in solved.items() if v.min() >= least}
    below = {t: v for t, v in solved.items() if t not in kept}
    shown = [_rings(outlook, "Lowest node, AC", kept, GREEN)]
    if below:
        red = _rings(outlook, "Lowest node, AC, below its limit", below, VERMILLION)
        shown.append(red | {"showlegend": False})
    return shown


def _rings(outlook: Outlook, name: str, found: AcVoltages, color: str) -> Trace:
    middle, told = (outlook.times[1] - outlook.start) / 2, spans(outlook)
    return {
        "type": "scatter",
        "mode": "markers",
        "name": name,
        "x": [stamp(outlook.times[t] + middle) for t in found],
        "y": [round(float(v.min()), 6) for v in found.values()],
        "hovertext": [
            f"{told[t]}: AC {v.min():.4f} pu at node {safe(outlook.nodes[int(v.argmin())])}"
            for t, v in found.items()
        ],
        "hovertemplate": "%{hovertext}<extra></extra>",
        "marker": {"symbol": "circle-open", "size": 8, "color": color, "line": {"width": 2}},
    }


def _range(outlook: Outlook, ac: AcVoltages) -> list[float]:
    """Both limits and every voltage shown, with a little room."""
    values = [outlook.voltage_min_pu, outlook.voltage_max_pu]
    values += [float(outlook.voltage_pu.min()), float(outlook.voltage_pu.max())]
    values += [float(v.min()) for v in ac.values() if np.isfinite(v).all()]
    room = 0.12 * (max(values) - min(values))
    return [round(min(values) - room, 4), round(max(values) + room, 4)]


def _limit_lines(outlook: Outlook) -> list[dict[str, Any]]:
    return [
        {
            "type": "line",
            "xref": "paper",
            "x0": 0,
            "x1": 1,
            "yref": "y",
            "y0": limit,
            "y1": limit,
            "line": {"color": VERMILLION, "width": 2, "dash": "dash"},
        }
        for limit in (outlook.voltage_min_pu, outlook.voltage_max_pu)
    ]


def _limit_labels(outlook: Outlook) -> list[dict[str, Any]]:
    sides = (("lowest", outlook.voltage_min_pu, "top"), ("highest", outlook.voltage_max_pu, "top"))
    return [
        {
            "x": 0.005,
            "xref": "paper",
            "xanchor": "left",
            "y": limit,
            "yref": "y",
            "yanchor": anchor,
            "showarrow": False,
            "text": f"{side} allowed {limit:g} pu",
            "font": {"size": FONT_PX - 1, "color": VERMILLION},
        }
        for side, limit, anchor in sides
    ]
