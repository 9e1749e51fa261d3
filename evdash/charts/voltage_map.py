"""A map of all nodes over the day: voltage by colour, limits as contours, crosses outside."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from evdash.charts.style import (
    COLORBAR,
    FONT_PX,
    MARGIN,
    ORANGE,
    VERMILLION,
    Figure,
    Trace,
    fixed_figure,
    now_label,
    now_shapes,
    safe,
    spans,
    stamp,
    time_axis,
    value_axis,
)
from evdash.domain.limits import Floats
from evdash.domain.outlook import Outlook

MAP_DOMAIN = [0.0, 0.55]
MAP_PX = 250
LABEL_PX = 15
LETTER_PX, LONGEST_NAME = 8, 12
"""A letter of a node's name is at most so wide, and so many are shown."""
VOLTAGE_TOLERANCE_PU = 1e-6
LEAST_DROP_PU = 1e-4
"""The drop shown at full scale at the least, so that next to nothing looks like it."""
NEAR_PU = 0.005
"""Voltages this near to a limit have a contour of their own."""
MAP_FRAME_PX = 106
ROW_PX = 26
SHORTEST_PX, TALLEST_PX = 300, 640
"""Of a map with hundreds of nodes a row is a line or two thin; it can be zoomed."""

MapWay = Literal["with", "without", "difference"]
AcVoltages = Mapping[int, Floats]
"""Node voltages of executed intervals by AC power flow, pu, shape (nodes,) each."""


def map_figure(outlook: Outlook, ac: AcVoltages, order: Sequence[str], way: MapWay) -> Figure:
    """The map alone, large, nodes in the `order` given: with charging, without, or the drop."""
    seen, ac_seen = _in_order(outlook, ac, order)
    if way == "without":
        seen, ac_seen = replace(seen, voltage_pu=seen.base_voltage_pu), {}
    rows = len(seen.nodes)
    height = min(TALLEST_PX, max(SHORTEST_PX, MAP_FRAME_PX + ROW_PX * rows))
    if way == "difference":
        traces = [drop_map(seen)]
    else:
        traces = [node_map(seen), *_contours(seen), *outside_marks(seen, ac_seen)]
    colorbar = traces[0]["colorbar"] | {"len": 1.0, "y": 0.5}
    traces[0] = traces[0] | {"colorbar": colorbar}
    return fixed_figure(
        [trace | {"yaxis": "y"} for trace in traces],
        height,
        margin_of(outlook),
        hovermode="closest",
        xaxis=time_axis(outlook),
        yaxis=node_axis(seen, height - MAP_FRAME_PX) | {"domain": [0.0, 1.0]},
        shapes=now_shapes(outlook),
        annotations=[now_label(outlook)] if outlook.now else [],
    )


def _in_order(
    outlook: Outlook, ac: AcVoltages, order: Sequence[str]
) -> tuple[Outlook, dict[int, Floats]]:
    places = [outlook.nodes.index(node) for node in order]
    seen = replace(
        outlook,
        nodes=tuple(order),
        voltage_pu=outlook.voltage_pu[:, places],
        base_voltage_pu=outlook.base_voltage_pu[:, places],
    )
    return seen, {t: voltage[places] for t, voltage in ac.items()}


def _contours(outlook: Outlook) -> list[Trace]:
    """Where voltages cross a limit, and where they come near one; none where they do not."""
    low, high = outlook.voltage_min_pu, outlook.voltage_max_pu
    least, most = float(outlook.voltage_pu.min()), float(outlook.voltage_pu.max())
    middle = (outlook.times[1] - outlook.start) / 2
    looks = (
        (f"Lowest allowed, {low:g} pu", low, {"color": VERMILLION, "width": 3}),
        (
            f"Within {NEAR_PU:g} pu of the lowest",
            low + NEAR_PU,
            {"color": VERMILLION, "width": 2} | {"dash": "dot"},
        ),
        (f"Highest allowed, {high:g} pu", high, {"color": ORANGE, "width": 3}),
        (
            f"Within {NEAR_PU:g} pu of the highest",
            high - NEAR_PU,
            {"color": ORANGE, "width": 2} | {"dash": "dot"},
        ),
    )
    return [
        {
            "type": "contour",
            "name": name,
            "showlegend": True,
            "showscale": False,
            "x": [stamp(time + middle) for time in outlook.times[:-1]],
            "y": list(range(len(outlook.nodes))),
            "z": np.round(outlook.voltage_pu.T, 5).tolist(),
            "autocontour": False,
            "contours": {"start": level, "end": level, "size": 1, "coloring": "none"},
            "line": line | {"smoothing": 0},
            "hoverinfo": "skip",
        }
        for name, level, line in looks
        if least < level < most
    ]


def node_map(outlook: Outlook) -> Trace:
    """Voltage of every node in every interval, below the lines of another axis."""
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
            **COLORBAR,
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


def drop_map(outlook: Outlook) -> Trace:
    """By how much charging lowers the voltage of every node in every interval."""
    drop = outlook.base_voltage_pu - outlook.voltage_pu
    words = spans(outlook)
    shown = node_map(outlook) | {
        "z": np.round(drop.T, 6).tolist(),
        "zmin": 0.0,
        "zmax": deepest_drop_pu(outlook),
        "hovertext": [
            [
                f"Node {safe(node)}, {words[t]}: {drop[t, i]:.4f} pu lower by charging"
                for t in range(outlook.n_intervals)
            ]
            for i, node in enumerate(outlook.nodes)
        ],
    }
    shown["colorbar"] = shown["colorbar"] | {"tickformat": ".4f"}
    return shown


def deepest_drop_pu(outlook: Outlook) -> float:
    """The drop shown at full scale."""
    return max(float((outlook.base_voltage_pu - outlook.voltage_pu).max()), LEAST_DROP_PU)


def outside_marks(outlook: Outlook, ac: AcVoltages) -> list[Trace]:
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


def margin_of(outlook: Outlook) -> dict[str, int]:
    """Room for the names of nodes on the left and the scale of colours on the right."""
    longest = max(len(node[:LONGEST_NAME]) for node in outlook.nodes)
    return {**MARGIN, "l": max(MARGIN["l"], 34 + LETTER_PX * longest), "r": 84}


def node_axis(outlook: Outlook, map_px: int = MAP_PX) -> dict[str, Any]:
    """A line a node, as many labelled as there is room for."""
    every = -(-LABEL_PX * len(outlook.nodes) // map_px)
    places = range(0, len(outlook.nodes), every)
    return value_axis(
        "Node",
        domain=MAP_DOMAIN,
        range=[len(outlook.nodes) - 0.5, -0.5],
        tickvals=list(places),
        ticktext=[safe(outlook.nodes[i][:LONGEST_NAME]) for i in places],
        tickfont={"size": FONT_PX - 2},
        showgrid=False,
    )
