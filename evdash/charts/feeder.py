"""The feeder as a one-line drawing, in one interval: voltages, loading, and what limits."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from evdash.charts.feeder_layout import Layout, middle_of
from evdash.charts.feeder_moment import Moment, loading_told, nodes_outside
from evdash.charts.style import (
    BLUE,
    CLEAR,
    COLORBAR,
    FONT_PX,
    ORANGE,
    OUTLINE,
    SKY,
    VERMILLION,
    Figure,
    figure,
    safe,
)
from evdash.charts.voltage_map import LEAST_DROP_PU
from evdash.domain.trace import Network
from evdash.metrics.verdict import FULL_AC, LINEARISED

HEIGHT_PX, TALLEST_PX, ROW_PX = 540, 900, 14
FEW, MANY = 45, 150
"""Up to FEW nodes all are labelled; from MANY on symbols are small."""
CARRIED_KVA = 0.05
HALO = "rgba(230,159,0,0.55)"


@dataclass(frozen=True, slots=True)
class Loading:
    """A class of lines: up to which share of the rating, and how it is drawn."""

    name: str
    up_to: float
    width: float
    colour: str
    dash: str = "solid"


LOADINGS = (
    Loading("Loading to 50 %", 0.5, 2.5, SKY),
    Loading("50–80 %", 0.8, 4.5, BLUE),
    Loading("80–100 %", 1.0, 7, ORANGE),
    Loading("Over its rating", float("inf"), 9, VERMILLION, "dot"),
)
OVER = len(LOADINGS) - 1
UNRATED = Loading("No rating", float("nan"), 2, OUTLINE)
SYMBOLS = (("Node", "circle"), ("Source", "square"), ("Charging station", "diamond"))
BUSY, IDLE = Loading("Carries charging", 0, 6, BLUE), Loading("Other lines", 0, 2, OUTLINE)


def feeder_figure(moment: Moment) -> Figure:
    """The drawing: nodes coloured by voltage, lines by loading, the tightest limit ringed."""
    voltage = moment.voltage_pu
    values = list(voltage.values())
    return figure(
        [
            *_tightest(moment),
            *_lines(moment),
            _line_marks(moment),
            *_nodes(moment, voltage),
            *_symbols(),
            *_nodes_outside(moment),
        ],
        _height_px(moment.layout),
        margin={"l": 8, "r": 8, "t": 62, "b": 8},
        hovermode="closest",
        dragmode="pan",
        coloraxis=_colours(moment, values),
        **_frame(moment.layout),
    )


def _height_px(layout: Layout) -> int:
    """Taller for a tree of many branches."""
    rows = 0 if layout.is_given else len({y for _, y in layout.places.values()})
    return min(TALLEST_PX, max(HEIGHT_PX, ROW_PX * rows))


def _frame(layout: Layout) -> dict[str, Any]:
    """Axes without marks, with room for labels at the edges, most of it on the right."""
    axes = {}
    rooms = ((0.05, 0.16), (0.1, 0.12))
    for axis, values, (before, after) in zip(
        ("xaxis", "yaxis"), zip(*layout.places.values(), strict=True), rooms, strict=True
    ):
        low, high = min(values), max(values)
        wide = high - low or 1.0
        axes[axis] = {"visible": False, "range": [low - before * wide, high + after * wide]}
    return axes


def _colours(moment: Moment, values: Sequence[float]) -> dict[str, Any]:
    low, high = moment.outlook.voltage_min_pu, moment.outlook.voltage_max_pu
    bar: dict[str, Any] = {"title": {"text": "pu"}, **COLORBAR, "len": 0.85}
    if moment.way == "difference":
        return {
            "colorscale": "Cividis",
            "cmin": 0.0,
            "cmax": max(LEAST_DROP_PU, *values),
            "colorbar": bar | {"tickformat": ".4f", "title": {"text": "pu lower"}},
        }
    room = 0.1 * (high - low)
    middle = (low + high) / 2
    return {
        "colorscale": "Cividis",
        "cmin": low - room,
        "cmax": high + room,
        "colorbar": bar
        | {
            "tickvals": [low, middle, high],
            "ticktext": [
                f"{low:g} lowest<br>allowed",
                f"{middle:g}",
                f"{high:g} highest<br>allowed",
            ],
        },
    }


def _lines(moment: Moment) -> list[dict[str, Any]]:
    """One trace a class, so that the legend tells width and colour."""
    if moment.way == "difference":
        classes: tuple[Loading, ...] = (IDLE, BUSY)
        of_line = [int(kva > CARRIED_KVA) for kva in np.abs(moment.line_kva)]
    else:
        classes = (*LOADINGS, UNRATED)
        of_line = [
            _class_of(share, is_over=bool(moment.models_over(line)))
            for line, share in zip(moment.scenario.lines, moment.loading, strict=True)
        ]
    traces = []
    for place, look in enumerate(classes):
        ways = [moment.layout.ways[i] for i, one in enumerate(of_line) if one == place]
        if ways:
            traces.append(
                {
                    "type": "scatter",
                    "mode": "lines",
                    "name": look.name,
                    "x": [x for way in ways for x in (*(p[0] for p in way), None)],
                    "y": [y for way in ways for y in (*(p[1] for p in way), None)],
                    "line": {"color": look.colour, "width": look.width, "dash": look.dash},
                    "hoverinfo": "skip",
                }
            )
    return traces


def _class_of(share: float, *, is_over: bool) -> int:
    """Which of LOADINGS: the verdict decides what is over its rating, not the share's rounding."""
    if np.isnan(share):
        return len(LOADINGS)
    if is_over:
        return OVER
    return next((i for i, look in enumerate(LOADINGS[:OVER]) if share <= look.up_to), OVER - 1)


def _line_marks(moment: Moment) -> dict[str, Any]:
    """In the middle of every line: its flow to hover over, and in words where it matters."""
    labelled = len(moment.layout.places) <= FEW
    texts, told = [], []
    for row, line in enumerate(moment.scenario.lines):
        kva, share = moment.line_kva[row], moment.loading[row]
        name = f"{safe(line.from_node)}–{safe(line.to_node)}"
        if moment.way == "difference":
            told.append(f"{name}: {kva:+.1f} kVA by charging")
            texts.append(f"{kva:+.0f} kVA" if labelled and abs(kva) > CARRIED_KVA else "")
        elif np.isnan(share):
            told.append(f"{name}: {kva:,.1f} kVA, no rating")
            texts.append("")
        else:
            loading = loading_told(moment, row)
            told.append(_line_told(moment, row, name, loading))
            is_shown = labelled or share > LOADINGS[1].up_to or moment.models_over(line)
            texts.append(loading.replace(", ", "<br>") if is_shown else "")
    middles = [middle_of(way) for way in moment.layout.ways]
    return {
        "type": "scatter",
        "mode": "markers+text",
        "showlegend": False,
        "x": [x for x, _ in middles],
        "y": [y for _, y in middles],
        "text": texts,
        "textposition": [
            "middle right" if way[-1][0] == way[-2][0] else "bottom center"
            for way in moment.layout.ways
        ],
        "textfont": {"size": FONT_PX - 2},
        "hovertext": told,
        "hovertemplate": "%{hovertext}<extra></extra>",
        "marker": {"size": 16, "color": "rgba(128,128,128,0.01)"},
    }


def _line_told(moment: Moment, row: int, name: str, loading: str) -> str:
    told = f"{name}: {moment.line_kva[row]:,.1f} of {moment.rating_kva[row]:,.0f} kVA"
    ac = moment.seen_in_ac
    if ac is not None and np.isfinite(ac.line_kva[row]):
        told += f" linearised, {ac.line_kva[row]:,.1f} kVA by AC power flow"
    return f"{told} ({loading})"


def _nodes(moment: Moment, voltage: dict[str, float]) -> list[dict[str, Any]]:
    source, station = moment.scenario.feeder.source_node, moment.scenario.station.node
    size = 17 if len(voltage) <= FEW else 11 if len(voltage) <= MANY else 8
    labelled = _labelled(moment, voltage)
    others = [n for n in voltage if n not in (source, station)]
    kinds = zip(SYMBOLS, ((others, size), ([source], size + 4), ([station], size + 8)), strict=True)
    return [
        {
            "type": "scatter",
            "mode": "markers+text",
            "name": name,
            "showlegend": False,
            "x": [moment.layout.places[node][0] for node in nodes],
            "y": [moment.layout.places[node][1] for node in nodes],
            "text": [
                _label(moment, node, voltage[node]) if node in labelled else "" for node in nodes
            ],
            "textposition": "top right",
            "cliponaxis": False,
            "textfont": {"size": FONT_PX - 1},
            "hovertext": [_told(moment, node, voltage[node]) for node in nodes],
            "hovertemplate": "%{hovertext}<extra></extra>",
            "marker": {
                "symbol": symbol,
                "size": pixels,
                "color": [round(voltage[node], 6) for node in nodes],
                "coloraxis": "coloraxis",
                "line": {"color": OUTLINE, "width": 1.5},
            },
        }
        for (name, symbol), (nodes, pixels) in kinds
        if nodes
    ]


def _symbols() -> list[dict[str, Any]]:
    """The legend's own symbols: of nodes coloured by voltage it would draw black ones."""
    return [
        {
            "type": "scatter",
            "mode": "markers",
            "name": name,
            "x": [None],
            "y": [None],
            "hoverinfo": "skip",
            "marker": {"symbol": symbol, "size": 12, "color": OUTLINE},
        }
        for name, symbol in SYMBOLS
    ]


def _labelled(moment: Moment, voltage: dict[str, float]) -> set[str]:
    """All nodes of a small feeder; of a large one those that somebody looks for."""
    if len(voltage) <= FEW:
        return set(voltage)
    binding = moment.outlook.binding[moment.interval]
    sought = {
        moment.scenario.feeder.source_node,
        moment.scenario.station.node,
        min(voltage, key=voltage.__getitem__),
        max(voltage, key=voltage.__getitem__),
        *([binding.node] if binding and binding.kind != "line" else []),
    }
    return sought & set(voltage)


def _label(moment: Moment, node: str, value: float) -> str:
    digits = 4 if moment.way == "difference" else 3
    return f"<b>{safe(node[:14])}</b> {value:.{digits}f}"


def _told(moment: Moment, node: str, value: float) -> str:
    if moment.way == "difference":
        return f"Node {safe(node)}: {value:.4f} pu lower by charging"
    parts = [f"Node {safe(node)}: {value:.4f} pu linearised"]
    if moment.seen_in_ac is not None and node in moment.outlook.nodes:
        ac = float(moment.seen_in_ac.voltage_pu[moment.outlook.nodes.index(node)])
        parts.append(f"{ac:.4f} pu by AC power flow" if np.isfinite(ac) else "no AC solution")
    if node == moment.scenario.station.node and moment.way == "with":
        parts.append(f"station {moment.outlook.station_kw[moment.interval]:,.1f} kW")
    return "<br>".join(parts)


def _nodes_outside(moment: Moment) -> list[dict[str, Any]]:
    """Crosses on nodes outside their limits; by AC, rings: told apart by shape."""
    found: dict[str, tuple[Network, str, int]] = {
        "Outside limits": (LINEARISED, "x-thin", 18),
        "Outside limits in AC": (FULL_AC, "circle-open", 26),
    }
    sizes = {moment.scenario.station.node: 36}  # around the diamond, which is larger
    return [
        {
            "type": "scatter",
            "mode": "markers",
            "name": name,
            "x": [moment.layout.places[node][0] for node in nodes],
            "y": [moment.layout.places[node][1] for node in nodes],
            "marker": {"symbol": symbol, "size": [sizes.get(node, size) for node in nodes]}
            | {"color": VERMILLION, "line": {"color": VERMILLION, "width": 3}},
            "hoverinfo": "skip",
        }
        for name, (network, symbol, size) in found.items()
        if (nodes := nodes_outside(moment, network))
    ]


def _tightest(moment: Moment) -> list[dict[str, Any]]:
    """A halo around the element that sets the headroom."""
    element = moment.outlook.binding[moment.interval]
    if element is None:
        return []
    way = next(
        (
            way
            for line, way in zip(moment.scenario.lines, moment.layout.ways, strict=True)
            if line.element == element
        ),
        (moment.layout.places[element.node],) if element.node in moment.layout.places else (),
    )
    halo: dict[str, Any] = {
        "type": "scatter",
        "name": "Tightest limit",
        "x": [x for x, _ in way],
        "y": [y for _, y in way],
        "hoverinfo": "skip",
    }
    if len(way) > 1:
        return [halo | {"mode": "lines", "line": {"color": HALO, "width": 22}}]
    ring = {"symbol": "circle", "size": 38, "color": HALO, "line": {"color": CLEAR, "width": 0}}
    return [halo | {"mode": "markers", "marker": ring}] if way else []
