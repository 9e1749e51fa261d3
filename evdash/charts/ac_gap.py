"""Linearised against AC voltages, interval by interval."""

from collections.abc import Sequence
from typing import Any

from evdash.charts.style import (
    BLUE,
    FONT_PX,
    GREEN,
    PURPLE,
    VERMILLION,
    Figure,
    clock,
    empty_note,
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
from evdash.charts.voltage_map import VOLTAGE_TOLERANCE_PU
from evdash.domain.outlook import Outlook
from evdash.metrics.feeder import Gap

HEIGHT_PX = 430
LOWEST_DOMAIN, GAP_DOMAIN = [0.46, 1.0], [0.0, 0.34]
NOTHING_YET = "Each interval is checked once it is over"
LEAST_GAP_PU = 1e-3


def ac_gap_figure(outlook: Outlook, gaps: Sequence[Gap]) -> Figure:
    """The lowest voltage by both models, and below it where they differ most."""
    return figure(
        [_linear(outlook), *_ac(outlook, gaps), _differences(outlook, gaps)],
        HEIGHT_PX,
        hovermode="closest",
        xaxis=time_axis(outlook) | {"anchor": "y2"},
        yaxis=value_axis(
            "Lowest, pu",
            domain=LOWEST_DOMAIN,
            range=_range(outlook, gaps),
            nticks=6,
            tickformat=".3f",
        ),
        yaxis2=value_axis(
            "Difference, pu",
            domain=GAP_DOMAIN,
            range=_gap_range(gaps),
            nticks=4,
            tickformat=".4~f",
        ),
        shapes=[*now_shapes(outlook), _limit(outlook)],
        annotations=[
            _limit_label(outlook),
            *([now_label(outlook)] if outlook.now else []),
            *([] if gaps else [empty_note(NOTHING_YET) | {"y": GAP_DOMAIN[1] / 2}]),
        ],
    )


def ac_gap_table(outlook: Outlook, gaps: Sequence[Gap]) -> list[dict[str, object]]:
    """The same as rows of a table."""
    return [
        {
            "Interval": spans(outlook)[gap.interval],
            "Lowest linearised, pu": round(gap.lowest_linear, 5),
            "Lowest AC, pu": round(gap.lowest_ac, 5),
            "Largest difference, pu": round(gap.difference, 5),
            "at node": gap.node,
            "AC below the lowest allowed": "yes" if _is_low(outlook, gap) else "no",
        }
        for gap in gaps
    ]


def ac_gap_alt(outlook: Outlook, gaps: Sequence[Gap]) -> str:
    """The chart in one sentence."""
    if not gaps:
        return "Linearised and AC voltages: no interval is checked by AC power flow yet."
    worst = max(gaps, key=lambda gap: abs(gap.difference))
    low = sum(_is_low(outlook, gap) for gap in gaps)
    return (
        f"Lowest voltage by both models in {len(gaps)} intervals: they differ most at "
        f"{clock(outlook.times[worst.interval])}, by {abs(worst.difference):.4f} pu at node "
        f"{worst.node}; AC is below the lowest allowed in {low}."
    )


def _linear(outlook: Outlook) -> dict[str, Any]:
    return step_line(
        outlook,
        outlook.voltage_pu.min(axis=1),
        name="Linearised",
        line={"color": BLUE, "width": 2.5, "shape": "hv"},
        hovertemplate="%{x}: linearised %{y:.4f} pu<extra></extra>",
    )


def _ac(outlook: Outlook, gaps: Sequence[Gap]) -> list[dict[str, Any]]:
    """The lowest AC voltage as green rings, below the lowest allowed as red crosses."""
    middle = (outlook.times[1] - outlook.start) / 2
    kinds = (
        ("AC", False, {"symbol": "circle-open", "color": GREEN}),
        ("AC below the lowest allowed", True, {"symbol": "x", "color": VERMILLION}),
    )
    return [
        {
            "type": "scatter",
            "mode": "markers",
            "name": name,
            "x": [stamp(outlook.times[gap.interval] + middle) for gap in shown],
            "y": [round(gap.lowest_ac, 6) for gap in shown],
            "marker": look | {"size": 9, "line": {"width": 2, "color": look["color"]}},
            "hovertemplate": "AC: lowest %{y:.4f} pu<extra></extra>",
        }
        for name, is_low, look in kinds
        if (shown := [gap for gap in gaps if _is_low(outlook, gap) == is_low])
    ]


def _differences(outlook: Outlook, gaps: Sequence[Gap]) -> dict[str, Any]:
    ms = (outlook.times[1] - outlook.start).total_seconds() * 1000
    return {
        "type": "bar",
        "name": "Largest difference of a node",
        "yaxis": "y2",
        "x": [stamp(outlook.times[gap.interval]) for gap in gaps],
        "y": [round(gap.difference, 6) for gap in gaps],
        "offset": 0.1 * ms,
        "width": 0.8 * ms,
        "marker": {"color": PURPLE},
        "hovertext": [
            f"{spans(outlook)[gap.interval]}: {gap.difference:.4f} pu at node {safe(gap.node)}"
            for gap in gaps
        ],
        "hovertemplate": "%{hovertext}<extra></extra>",
    }


def _is_low(outlook: Outlook, gap: Gap) -> bool:
    return gap.lowest_ac < outlook.voltage_min_pu - VOLTAGE_TOLERANCE_PU


def _range(outlook: Outlook, gaps: Sequence[Gap]) -> list[float]:
    values = [outlook.voltage_min_pu, *outlook.voltage_pu.min(axis=1)]
    values += [gap.lowest_ac for gap in gaps]
    room = 0.15 * (max(values) - min(values)) or 0.01
    return [round(float(min(values)) - room, 4), round(float(max(values)) + room, 4)]


def _gap_range(gaps: Sequence[Gap]) -> list[float]:
    values = [0.0, LEAST_GAP_PU, *(gap.difference for gap in gaps)]
    return [round(1.1 * min(values), 6), round(1.1 * max(values), 6)]


def _limit(outlook: Outlook) -> dict[str, Any]:
    low = outlook.voltage_min_pu
    return {
        "type": "line",
        "xref": "paper",
        "x0": 0,
        "x1": 1,
        "yref": "y",
        "y0": low,
        "y1": low,
        "line": {"color": VERMILLION, "width": 2, "dash": "dash"},
    }


def _limit_label(outlook: Outlook) -> dict[str, Any]:
    return {
        "x": 0.005,
        "xref": "paper",
        "xanchor": "left",
        "y": outlook.voltage_min_pu,
        "yref": "y",
        "yanchor": "top",
        "showarrow": False,
        "text": f"lowest allowed {outlook.voltage_min_pu:g} pu",
        "font": {"size": FONT_PX - 1, "color": VERMILLION},
    }
