"""What a study found along one axis: medians with the band of 5 to 95 % of days."""

from collections.abc import Sequence
from dataclasses import dataclass

from evdash.charts.style import (
    FONT_PX,
    OPTION_COLOURS,
    OUTLINE,
    Figure,
    Trace,
    empty_note,
    figure,
    safe,
    value_axis,
)

HEIGHT_PX = 420
DASHES = ("solid", "dash", "dot", "dashdot", "longdash", "longdashdot")
SYMBOLS = ("circle", "square", "diamond", "triangle-up", "x", "star")
RIBBON = 0.18
LONGEST = 26


@dataclass(frozen=True, slots=True)
class Bands:
    """One series: where it stands on the axis, and its quantiles there, each (points,)."""

    name: str
    at: Sequence[object]
    p05: Sequence[float]
    p50: Sequence[float]
    p95: Sequence[float]


def bands_figure(series: Sequence[Bands], axis: str, value: str, zero: bool = False) -> Figure:
    """A ribbon and a line where the axis is of numbers, whiskers on marks where it is of names.

    `zero`: values are differences, and the line of no difference is drawn.
    """
    numeric = all(_is_number(label) for one in series for label in one.at)
    traces = [
        trace
        for n, one in enumerate(series)
        for trace in (_ribbon(one, n) if numeric else [_whiskers(one, n, len(series))])
    ]
    line = {"type": "line", "xref": "paper", "x0": 0, "x1": 1, "y0": 0, "y1": 0}
    return figure(
        traces,
        HEIGHT_PX,
        showlegend=len(series) > 1,
        hovermode="x unified" if numeric else "closest",
        xaxis={
            **value_axis(safe(axis)),
            "showgrid": numeric,
            **({} if numeric else {"type": "category", "tickangle": "auto"}),
        },
        yaxis=value_axis(safe(value)),
        shapes=[line | {"line": {"color": OUTLINE, "width": 2, "dash": "dot"}}] if zero else [],
        annotations=[] if any(one.at for one in series) else [empty_note("No day has ended yet.")],
    )


def bars_figure(one: Bands, axis: str, value: str) -> Figure:
    """The medians of named points as bars, highest first, with whiskers from 5 to 95 %."""
    order = sorted(range(len(one.at)), key=lambda i: -one.p50[i])
    spread = any(one.p95[i] > one.p05[i] for i in order)
    bars = {
        "type": "bar",
        "x": [safe(f"{one.at[i]}"[:LONGEST]) for i in order],
        "y": [round(one.p50[i], 6) for i in order],
        "marker": {
            "color": [OPTION_COLOURS[2 if n == 0 else 0] for n in range(len(order))],
            "line": {"color": OUTLINE, "width": 1},
            "pattern": {"shape": ["/" if n == 0 else "" for n in range(len(order))]},
        },
        "hovertemplate": "%{x}: %{y:,.4~g}<extra></extra>",
    }
    if spread:
        bars["error_y"] = _errors(one, order)
    return figure(
        [bars],
        HEIGHT_PX,
        showlegend=False,
        xaxis={**value_axis(safe(axis)), "type": "category"},
        yaxis=value_axis(safe(value)),
        annotations=[] if order else [empty_note("No day has ended yet.")],
    )


def bands_alt(series: Sequence[Bands], axis: str, value: str) -> str:
    """The chart in a sentence or two."""
    told = []
    for one in series:
        if one.at:
            best = max(range(len(one.at)), key=lambda i: one.p50[i])
            least = min(range(len(one.at)), key=lambda i: one.p50[i])
            told.append(
                f"{one.name or value}: median from {one.p50[least]:,.4g} at {one.at[least]} to "
                f"{one.p50[best]:,.4g} at {one.at[best]}"
            )
    return f"{value} by {axis}. " + ("; ".join(told) if told else "Nothing to show yet.")


def _is_number(label: object) -> bool:
    return isinstance(label, int | float) and not isinstance(label, bool)


def _colour(n: int) -> str:
    return OPTION_COLOURS[n % len(OPTION_COLOURS)]


def _ribbon(one: Bands, n: int) -> list[Trace]:
    order = sorted(range(len(one.at)), key=lambda i: float(str(one.at[i])))
    x = [one.at[i] for i in order]
    low, high = [one.p05[i] for i in order], [one.p95[i] for i in order]
    colour = _colour(n)
    red, green, blue = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    name = safe(one.name) or "Median"
    band: Trace = {
        "type": "scatter",
        "mode": "lines",
        "name": f"{name}, 5 to 95 %",
        "x": [*x, *reversed(x)],
        "y": [*high, *reversed(low)],
        "fill": "toself",
        "fillcolor": f"rgba({red},{green},{blue},{RIBBON})",
        "line": {"width": 0},
        "hoverinfo": "skip",
        "showlegend": False,
    }
    line: Trace = {
        "type": "scatter",
        "mode": "lines+markers",
        "name": name,
        "x": x,
        "y": [one.p50[i] for i in order],
        "customdata": [[a, b] for a, b in zip(low, high, strict=True)],
        "hovertemplate": "%{y:,.5~g} (5 to 95 %: %{customdata[0]:,.5~g} to %{customdata[1]:,.5~g})",
        "line": {"color": colour, "width": 2.5, "dash": DASHES[n % len(DASHES)]},
        "marker": {"size": 9, "symbol": SYMBOLS[n % len(SYMBOLS)]},
    }
    return [band, line]


def _whiskers(one: Bands, n: int, count: int) -> Trace:
    every = range(len(one.at))
    return {
        "type": "scatter",
        "mode": "markers",
        "name": safe(one.name) or "Median",
        "x": [safe(f"{label}"[:LONGEST]) for label in one.at],
        "y": list(one.p50),
        "error_y": _errors(one, every),
        "marker": {"size": 12, "color": _colour(n), "symbol": SYMBOLS[n % len(SYMBOLS)]},
        "hovertemplate": "%{x}: %{y:,.5~g}<extra></extra>",
        "offsetgroup": f"{n}" if count > 1 else "",
    }


def _errors(one: Bands, order: Sequence[int]) -> dict[str, object]:
    return {
        "type": "data",
        "symmetric": False,
        "array": [round(one.p95[i] - one.p50[i], 6) for i in order],
        "arrayminus": [round(one.p50[i] - one.p05[i], 6) for i in order],
        "thickness": 2,
        "width": 7,
        "color": OUTLINE,
    }


def days_figure(values: Sequence[float], quantiles: Sequence[float], value: str) -> Figure:
    """How often days came to what, and where 5, 50 and 95 % of them lie below."""
    names = ("5 %", "median", "95 %")
    marks = list(zip(names, quantiles, strict=True)) if values else []
    return figure(
        [
            {
                "type": "histogram",
                "x": list(values),
                "nbinsx": 24,
                "marker": {
                    "color": OPTION_COLOURS[0],
                    "opacity": 0.75,
                    "line": {"color": OUTLINE, "width": 1},
                },
                "hovertemplate": "%{x}: %{y} days<extra></extra>",
            }
        ],
        HEIGHT_PX,
        showlegend=False,
        bargap=0.03,
        xaxis=value_axis(safe(value)),
        yaxis=value_axis("Days"),
        shapes=[
            {"type": "line", "x0": x, "x1": x, "yref": "paper", "y0": 0, "y1": 1}
            | {"line": {"color": OUTLINE, "width": 2.5, "dash": "dash"}}
            for _, x in marks
        ],
        annotations=[
            {"x": x, "y": 1, "yref": "paper", "yanchor": "bottom", "showarrow": False}
            | {"text": f"{name}: {x:,.5g}", "font": {"size": FONT_PX}, "yshift": 18 * (n % 2)}
            for n, (name, x) in enumerate(marks)
        ]
        or [empty_note("No day has ended yet.")],
    )


def days_alt(values: Sequence[float], quantiles: Sequence[float], value: str) -> str:
    """The chart in a sentence."""
    if not values:
        return f"{value}: nothing to show yet."
    low, middle, high = quantiles
    return (
        f"{value} of {len(values)} days: 5 % lie below {low:,.4g}, half below {middle:,.4g}, 95 % "
        f"below {high:,.4g}."
    )
