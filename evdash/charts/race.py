"""A race of policies in two pictures: what each earned, and what each drew from the feeder."""

from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any

from evdash.charts.style import (
    BLUE,
    CLEAR,
    FONT_PX,
    GREEN,
    ORANGE,
    OUTLINE,
    PURPLE,
    SKY,
    VERMILLION,
    YELLOW,
    Figure,
    clock,
    figure,
    safe,
    stamp,
    value_axis,
)
from evdash.domain.trace import Network
from evdash.domain.words import money
from evdash.metrics.verdict import FULL_AC, LINEARISED
from evdash.policies.race import Lap, Race
from evdash.policies.race_words import most_is_over_in_ac

LOOKS = {
    "oracle": (GREEN, "dash"),
    "bid-price": (PURPLE, "solid"),
    "p1": (BLUE, "solid"),
    "p1-plain": (BLUE, "dot"),
    "llf": (SKY, "dashdot"),
    "edf": (ORANGE, "dashdot"),
    "fcfs": (YELLOW, "dashdot"),
    "uncoordinated": (VERMILLION, "dot"),
}
"""Colour and dash of each policy of ours, the same in every picture."""
FROM_OUTSIDE = ((OUTLINE, "longdash"), (GREEN, "longdash"), (PURPLE, "longdash"))
"""Those of policies from outside, in turn."""
ROW_PX, BARS_PX, LINES_PX, PRICE_PX = 40, 130, 380, 300
BREAKS: Mapping[Network | None, str] = {
    LINEARISED: "breaks limits",
    FULL_AC: "over limits in AC",
    None: "",
}
"""What is told of a policy by the model whose limits charging exceeds."""


def profit_figure(race: Race) -> Figure:
    """A bar for each policy's profit, most first; a line at what nobody within limits can exceed.

    Hatched is who exceeds limits in the model in which they are kept: what it earns, it takes from
    the feeder. Who exceeds them by AC power flow alone is told to.
    """
    laps = sorted(race.laps, key=lambda lap: lap.service.profit)
    bars = {
        "type": "bar",
        "orientation": "h",
        "y": [_name(race, lap) for lap in laps],
        "x": [round(lap.service.profit, 2) for lap in laps],
        "text": [safe(profit_told(lap)) for lap in laps],
        "textposition": "none",
        "marker": {
            "color": [_look(race, lap.policy)[0] for lap in laps],
            "pattern": {
                "shape": ["/" if exceeding(race, lap) == race.network else "" for lap in laps],
                "bgcolor": CLEAR,
                "fgopacity": 0.9,
            },
            "line": {"color": OUTLINE, "width": 1},
        },
        "hovertemplate": "%{y}: %{text}<extra></extra>",
    }
    most = race.most_profit
    told = [] if most is None else [_most_line(race, most)]
    return figure(
        [bars],
        BARS_PX + ROW_PX * max(1, len(laps)),
        showlegend=False,
        xaxis=value_axis("Profit of the day, $", range=_reach(race)),
        yaxis={"automargin": True, "ticksuffix": "  "},
        shapes=[] if most is None else [_line_at(most)],
        annotations=[*_profits_told(race, laps), *told],
    )


def _look(race: Race, policy: str) -> tuple[str, str]:
    """Colour and dash of a policy that raced."""
    others = [lap.policy for lap in race.laps if lap.policy not in LOOKS]
    if policy not in others:
        return LOOKS[policy]
    return FROM_OUTSIDE[others.index(policy) % len(FROM_OUTSIDE)]


def _profits_told(race: Race, laps: Sequence[Lap]) -> list[dict[str, Any]]:
    """The numbers in a column right of all bars, where the line crosses none of them."""
    return [
        {
            "x": _longest(race),
            "xshift": 6,
            "xanchor": "left",
            "y": _name(race, lap),
            "showarrow": False,
            "text": safe(profit_told(lap)),
        }
        for lap in laps
    ]


def _longest(race: Race) -> float:
    return max(0.0, race.most_profit or 0.0, *(lap.service.profit for lap in race.laps))


def _reach(race: Race) -> list[float]:
    """From zero or below to beyond the longest bar, with room for what is written behind it."""
    profits = [0.0, race.most_profit or 0.0, *(lap.service.profit for lap in race.laps)]
    room = 0.36 * max(1.0, max(profits) - min(profits))
    return [min(profits) - (room if min(profits) < 0 else 0.0), max(profits) + room]


def exceeding(race: Race, lap: Lap) -> Network | None:
    """The model whose limits charging exceeds: that in which they are kept, else AC; or None."""
    models: tuple[Network, Network] = (race.network, FULL_AC)
    return next((model for model in models if lap.verdict(model).by_charging), None)


def _name(race: Race, lap: Lap) -> str:
    told = BREAKS[exceeding(race, lap)]
    return safe(lap.title) + (f"<br>{told}" if told else "")


def profit_told(lap: Lap) -> str:
    """Profit, and its share of the proven most where it is one."""
    share, profit = lap.service.profit_of_best, lap.service.profit
    told = money(profit)
    return told if share is None or not lap.keeps_limits else f"{told}, {100 * share:.1f} %"


def _line_at(most: float) -> dict[str, Any]:
    line = {"color": VERMILLION, "width": 2, "dash": "dash"}
    return {"type": "line", "x0": most, "x1": most, "yref": "paper", "y0": 0, "y1": 1, "line": line}


def _most_line(race: Race, most: float) -> dict[str, Any]:
    told = _most_told(race, most)
    return {
        "x": most,
        "y": 1,
        "yref": "paper",
        "yanchor": "bottom",
        "xanchor": "right",
        "showarrow": False,
        "text": safe(told),
        "font": {"size": FONT_PX, "color": VERMILLION},
    }


def _most_told(race: Race, most: float) -> str:
    beyond = ", over limits in AC" if race.network != FULL_AC and most_is_over_in_ac(race) else ""
    kept = "AC" if race.network == FULL_AC else "linearised"
    return f"most within {kept} limits{beyond}: {money(most)}"


def profit_alt(race: Race) -> str:
    """The bars in one sentence."""
    told = []
    for lap in race.laps:
        beyond = BREAKS[exceeding(race, lap)]
        told.append(f"{lap.title} {profit_told(lap)}{f' ({beyond})' if beyond else ''}")
    most = "" if race.most_profit is None else f" The {_most_told(race, race.most_profit)}."
    return f"Profit of the day by policy: {', '.join(told)}.{most}"


def load_figure(race: Race, policies: Sequence[str]) -> Figure:
    """Station load of some policies over the clock, and the headroom the feeder leaves."""
    times = race.times
    room = _steps(times, race.headroom_kw, "Headroom", OUTLINE, "solid")
    room |= {"fill": "tozeroy", "fillcolor": "rgba(128,128,128,0.12)"}
    lines = [
        _steps(times, lap.station_kw, lap.title, *_look(race, name))
        for name in policies
        for lap in [race.lap(name)]
        if lap is not None
    ]
    over_a_day = (times[-1] - times[0]).total_seconds() > 24 * 3600
    return figure(
        [room, *lines],
        LINES_PX,
        hovermode="x unified",
        showlegend=True,
        xaxis={
            "type": "date",
            "title": {"text": "Clock time"},
            "tickformat": "%H:%M\n%d %b" if over_a_day else "%H:%M",
            "range": [stamp(times[0]), stamp(times[-1])],
        },
        yaxis=value_axis("Station load, kW", rangemode="tozero"),
    )


def _steps(
    times: Sequence[datetime],
    values: Sequence[float | None],
    name: str,
    colour: str,
    dash: str,
) -> dict[str, Any]:
    held = [None if value is None else round(value, 3) for value in values]
    return {
        "type": "scatter",
        "mode": "lines",
        "name": safe(name),
        "x": [stamp(moment) for moment in times],
        "y": [*held, held[-1] if held else None],
        "line": {"shape": "hv", "color": colour, "dash": dash, "width": 2.5},
        "hovertemplate": "%{y:,.1f} kW",
    }


def price_figure(race: Race, policy: str) -> Figure:
    """What a policy that anticipates held each hour's capacity to be worth to others, $/kWh."""
    lap = race.lap(policy)
    prices = () if lap is None else lap.capacity_price_per_kwh
    line = _steps(race.times, prices, "Price of capacity", _look(race, policy)[0], "solid")
    line |= {"fill": "tozeroy", "hovertemplate": "&#36;%{y:.3f} per kWh"}
    return figure(
        [line],
        PRICE_PX,
        showlegend=False,
        xaxis={
            "type": "date",
            "title": {"text": "Clock time"},
            "tickformat": "%H:%M",
            "range": [stamp(race.times[0]), stamp(race.times[-1])],
        },
        yaxis=value_axis("Price of capacity, $/kWh", rangemode="tozero"),
    )


def price_alt(race: Race, policy: str) -> str:
    """Where the price is highest, in words."""
    lap = race.lap(policy)
    known = [
        (price, t)
        for t, price in enumerate(() if lap is None else lap.capacity_price_per_kwh)
        if price is not None
    ]
    if not known:
        return "No price of capacity."
    price, t = max(known, key=lambda one: one[0])
    return (
        f"Price of each hour's capacity, highest at {clock(race.times[t])}: ${price:.3f} per kWh."
    )


def load_alt(race: Race, policies: Sequence[str]) -> str:
    """Peaks, and where the headroom is passed, in words."""
    told = []
    for name in policies:
        lap = race.lap(name)
        if lap is None:
            continue
        over = sum(
            room is not None and kw > room + 1e-3
            for kw, room in zip(lap.station_kw, race.headroom_kw, strict=True)
        )
        beyond = f", above the headroom in {over} intervals" if over else ""
        told.append(f"{lap.title} up to {max(lap.station_kw):,.1f} kW{beyond}")
    return f"Station load over the clock against the headroom: {'; '.join(told)}."


def load_rows(race: Race) -> list[dict[str, object]]:
    """Station load of every policy as rows of a table, kW."""
    rows: list[dict[str, object]] = []
    for t, room_kw in enumerate(race.headroom_kw):
        row: dict[str, object] = {"From": clock(race.times[t]), "Headroom, kW": _rounded(room_kw)}
        rows.append(row | {f"{lap.policy}, kW": _rounded(lap.station_kw[t]) for lap in race.laps})
    return rows


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, 1)
