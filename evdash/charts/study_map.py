"""The feeder as a map of sites: what a station would find at each node."""

from collections.abc import Mapping

from evdash.charts.feeder_layout import layout_of
from evdash.charts.style import FONT_PX, GREEN, OUTLINE, Figure, empty_note, figure, safe
from evdash.domain.scenario import Scenario

HEIGHT_PX, TALLEST_PX, ROW_PX = 520, 900, 26
FEW = 45
"""Up to so many nodes all are labelled."""


def site_map(
    scenario: Scenario,
    values: Mapping[str, float],
    told: Mapping[str, str],
    value: str,
    least_is_best: bool = False,
) -> Figure:
    """Nodes coloured by a value, the best one ringed, the present site a diamond."""
    layout = layout_of(scenario)
    source, station = scenario.feeder.source_node, scenario.station.node
    known = [node for node in layout.order if node in values]
    pick = min if least_is_best else max
    best = pick(known, key=values.__getitem__, default=None)
    lines = {
        "type": "scatter",
        "mode": "lines",
        "x": [x for way in layout.ways for x in (*(p[0] for p in way), None)],
        "y": [y for way in layout.ways for y in (*(p[1] for p in way), None)],
        "line": {"color": OUTLINE, "width": 2},
        "hoverinfo": "skip",
        "showlegend": False,
    }
    labelled = len(known) <= FEW
    nodes = {
        "type": "scatter",
        "mode": "markers+text" if labelled else "markers",
        "name": "Node",
        "x": [layout.places[node][0] for node in known],
        "y": [layout.places[node][1] for node in known],
        "text": [f"<b>{safe(node[:14])}</b> {safe(told[node])}" for node in known],
        "textposition": "top right",
        "textfont": {"size": FONT_PX - 1},
        "cliponaxis": False,
        "hovertemplate": "Node %{text}<extra></extra>",
        "showlegend": False,
        "marker": {
            "symbol": ["diamond" if node == station else "circle" for node in known],
            "size": [22 if node == station else 18 for node in known],
            "color": [round(values[node], 6) for node in known],
            "colorscale": "Cividis",
            "showscale": True,
            "colorbar": {"title": {"text": safe(value), "side": "right"}, "thickness": 14},
            "line": {"color": OUTLINE, "width": 1.5},
        },
    }
    marks = [
        ("Source", [source], "square", 18, OUTLINE),
        ("Present site", [station], "diamond-open", 30, OUTLINE),
        ("Best site", [best] if best is not None else [], "circle-open", 38, GREEN),
    ]
    rings = [
        {
            "type": "scatter",
            "mode": "markers",
            "name": name,
            "x": [layout.places[node][0] for node in at],
            "y": [layout.places[node][1] for node in at],
            "hoverinfo": "skip",
            "marker": {"symbol": symbol, "size": size, "color": colour}
            | {"line": {"color": colour, "width": 4 if symbol.endswith("open") else 1}},
        }
        for name, at, symbol, size, colour in marks
        if at
    ]
    return figure(
        [lines, *rings, nodes],
        _height_px(scenario),
        margin={"l": 8, "r": 8, "t": 58, "b": 8},
        hovermode="closest",
        dragmode="pan",
        annotations=[] if known else [empty_note("No day has ended yet.")],
        **_frame(list(layout.places.values())),
    )


def _height_px(scenario: Scenario) -> int:
    layout = layout_of(scenario)
    rows = 0 if layout.is_given else len({y for _, y in layout.places.values()})
    return min(TALLEST_PX, max(HEIGHT_PX, ROW_PX * rows))


def _frame(places: list[tuple[float, float]]) -> dict[str, object]:
    """Axes without marks, with room for labels, most of it on the right."""
    axes: dict[str, object] = {}
    for axis, values, before, after in (
        ("xaxis", [x for x, _ in places], 0.05, 0.16),
        ("yaxis", [y for _, y in places], 0.1, 0.12),
    ):
        low, high = min(values), max(values)
        wide = high - low or 1.0
        axes[axis] = {"visible": False, "range": [low - before * wide, high + after * wide]}
    return axes


def site_alt(values: Mapping[str, float], value: str) -> str:
    """The best and the worst site, in a sentence."""
    if not values:
        return f"{value} by node: nothing to show yet."
    best, worst = max(values, key=values.__getitem__), min(values, key=values.__getitem__)
    return (
        f"{value} by node of the station: highest at {best} ({values[best]:,.4g}), lowest at "
        f"{worst} ({values[worst]:,.4g}), of {len(values)} nodes."
    )
