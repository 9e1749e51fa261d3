"""Nodal voltages with their limits, linearised and by AC power flow."""

from collections.abc import Mapping
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
from evdash.domain.limits import Floats
from evdash.domain.outlook import Outlook

HEIGHT_PX = 560
LINES_DOMAIN, MAP_DOMAIN = [0.66, 1.0], [0.0, 0.55]
MAP_PX = 250
LEAST_DROP_PU = 1e-4
"""The drop shown at full scale at the least, so that next to nothing looks like it."""
LABEL_PX = 15
VOLTAGE_TOLERANCE_PU = 1e-6

AcVoltages = Mapping[int, Floats]
"""Node voltages of executed intervals by AC power flow, pu, shape (nodes,) each."""


def voltages_figure(outlook: Outlook, ac: AcVoltages) -> Figure:
    """Lowest and highest voltage of each interval over a map of all nodes."""
    return figure(
        [*_lines(outlook), *_ac_minimum(outlook, ac), _map(outlook), *_marks(outlook, ac)],
        HEIGHT_PX,
        hovermode="closest",
        xaxis=time_axis(outlook) | {"anchor": "y2"},
        yaxis=value_axis("Voltage, pu", domain=LINES_DOMAIN, range=_range(outlook, ac), nticks=5),
        yaxis2=_node_axis(outlook),
        shapes=[*now_shapes(outlook), *_limit_lines(outlook)],
        annotations=[*([now_label(outlook)] if outlook.now else []), *_limit_labels(outlook)],
    )


def base_figure(outlook: Outlook) -> Figure:
    """The same without the station: what the feeder does by itself."""
    return voltages_figure(replace(outlook, voltage_pu=outlook.base_voltage_pu), {})


def drop_figure(outlook: Outlook) -> Figure:
    """By how much charging lowers voltages: the largest drop over a map of all nodes."""
    drop = outlook.base_voltage_pu - outlook.voltage_pu
    words = spans(outlook)
    deepest = max(float(drop.max()), LEAST_DROP_PU)
    shown = _map(outlook) | {
        "z": np.round(drop.T, 6).tolist(),
        "zmin": 0.0,
        "zmax": deepest,
        "hovertext": [
            [
                f"Node {safe(node)}, {words[t]}: {drop[t, i]:.4f} pu lower by charging"
                for t in range(outlook.n_intervals)
            ]
            for i, node in enumerate(outlook.nodes)
        ],
    }
    shown["colorbar"] = shown["colorbar"] | {"tickformat": ".4f"}
    line = step_line(
        outlook,
        drop.max(axis=1),
        name="Largest drop by charging",
        line={"color": BLUE, "width": 2.5, "shape": "hv"},
        hovertemplate="%{x}: %{y:.4f} pu<extra></extra>",
    )
    return figure(
        [line, shown],
        HEIGHT_PX,
        hovermode="closest",
        xaxis=time_axis(outlook) | {"anchor": "y2"},
        yaxis=value_axis("Drop, pu", domain=LINES_DOMAIN, range=[0.0, 1.1 * deepest], nticks=5),
        yaxis2=_node_axis(outlook),
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
    solved = {t: v for t, v in sorted(ac.items()) if np.isfinite(v).all()}
    middle = (outlook.times[1] - outlook.start) / 2
    return [
        {
            "type": "scatter",
            "mode": "markers",
            "name": "Lowest node, AC",
            "x": [stamp(outlook.times[t] + middle) for t in solved],
            "y": [round(float(v.min()), 6) for v in solved.values()],
            "hovertext": [
                f"{spans(outlook)[t]}: AC {v.min():.4f} pu at node "
                f"{safe(outlook.nodes[int(v.argmin())])}"
                for t, v in solved.items()
            ],
            "hovertemplate": "%{hovertext}<extra></extra>",
            "marker": {"symbol": "circle-open", "size": 8, "color": GREEN, "line": {"width": 2}},
        }
    ]


def _map(outlook: Outlook) -> Trace:
    margin = 0.1 * (outlook.voltage_max_pu - outlook.voltage_min_pu)
    words = spans(outlook)
    return {
        "type": "heatmap",
        "xaxis": "x",
        "yaxis": "y2",
        "x": [stamp(time) for time in outlook.times],
        "y": list(range(len(outlook.nodes))),
        "z": np.round(outlook.voltage_pu.T, 5).tolist(),
        "zmin": outlook.voltage_min_pu - margin,
        "zmax": outlook.voltage_max_pu + margin,
        "colorscale": "Cividis",
        "colorbar": {
            "title": {"text": "pu"},
            "thickness": 14,
            "len": MAP_DOMAIN[1],
            "y": MAP_DOMAIN[1] / 2,
            "tickformat": ".2f",
            "nticks": 6,
        },
        "hovertext": [
            [
                f"Node {safe(node)}, {words[t]}: {outlook.voltage_pu[t, i]:.4f} pu"
                for t in range(outlook.n_intervals)
            ]
            for i, node in enumerate(outlook.nodes)
        ],
        "hovertemplate": "%{hovertext}<extra></extra>",
    }


def _marks(outlook: Outlook, ac: AcVoltages) -> list[Trace]:
    """Crosses where a node is outside its limits: linearised, and by AC where known."""
    low, high = outlook.voltage_min_pu, outlook.voltage_max_pu
    linear = {t: outlook.voltage_pu[t] for t in range(outlook.n_intervals)}
    marks = []
    for name, found, symbol in (
        ("Outside limits", linear, "x-thin"),
        ("Outside limits in AC", ac, "circle-open"),
    ):
        cells = [
            (t, int(i))
            for t, voltage in sorted(found.items())
            for i in np.flatnonzero(
                (voltage < low - VOLTAGE_TOLERANCE_PU) | (voltage > high + VOLTAGE_TOLERANCE_PU)
            )
        ]
        if cells:
            marks.append(_crosses(outlook, name, cells, symbol))
    return marks


def _crosses(outlook: Outlook, name: str, cells: list[tuple[int, int]], symbol: str) -> Trace:
    middle = (outlook.times[1] - outlook.start) / 2
    return {
        "type": "scatter",
        "mode": "markers",
        "name": name,
        "yaxis": "y2",
        "x": [stamp(outlook.times[t] + middle) for t, _ in cells],
        "y": [i for _, i in cells],
        "hoverinfo": "skip",
        "marker": {"symbol": symbol, "size": 8, "color": VERMILLION}
        | {"line": {"width": 2, "color": VERMILLION}},
    }


def _node_axis(outlook: Outlook) -> dict[str, Any]:
    every = -(-LABEL_PX * len(outlook.nodes) // MAP_PX)
    places = range(0, len(outlook.nodes), every)
    return value_axis(
        "Node",
        domain=MAP_DOMAIN,
        range=[len(outlook.nodes) - 0.5, -0.5],
        tickvals=list(places),
        ticktext=[safe(outlook.nodes[i][:12]) for i in places],
        tickfont={"size": FONT_PX - 2},
        showgrid=False,
    )


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
