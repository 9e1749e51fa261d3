"""What the Feeder page says in plain words. Markdown; user text is escaped."""

import math
from collections.abc import Iterable

import numpy as np

from evdash.charts.feeder_moment import Moment
from evdash.domain.outlook import Outlook
from evdash.domain.refusal import element_name
from evdash.domain.scenario import Scenario
from evdash.metrics.feeder import Gap, Violation
from evdash.ui.words import clock, counted, element_words, plain

CAUSES = {
    "station": "charging",
    "both": "feeder and charging",
    "feeder": "feeder itself",
}


def headline(outlook: Outlook, scenario: Scenario) -> str:
    """The lowest voltage of the day and the tightest limit, in a sentence or two."""
    t = int(outlook.voltage_pu.min(axis=1).argmin())
    i = int(outlook.voltage_pu[t].argmin())
    low = (
        f"**Lowest voltage {outlook.voltage_pu[t, i]:.4f}\u00a0pu** at node "
        f"{plain(outlook.nodes[i])}, {clock(outlook.times[t], outlook)} "
        f"(allowed {outlook.voltage_min_pu:g} to {outlook.voltage_max_pu:g})."
    )
    if not np.isfinite(outlook.headroom_kw).any():
        return f"{low} No limit of the feeder binds the station."
    tight = int(outlook.headroom_kw.argmin())
    return (
        f"{low} **Least room for charging {outlook.headroom_kw[tight]:,.0f}\u00a0kW** at "
        f"{clock(outlook.times[tight], outlook)}, limited by "
        f"{element_words(outlook.binding[tight], scenario)}."
    )


def moment_lines(moment: Moment) -> list[str]:
    """One interval of the drawing in numbers."""
    outlook, t = moment.outlook, moment.interval
    low = int(outlook.voltage_pu[t].argmin())
    high = int(outlook.voltage_pu[t].argmax())
    drop = outlook.base_voltage_pu[t] - outlook.voltage_pu[t]
    most = int(drop.argmax())
    lines = [
        _station(moment),
        f"**Lowest** {outlook.voltage_pu[t, low]:.4f}\u00a0pu at node "
        f"{plain(outlook.nodes[low])}; **highest** {outlook.voltage_pu[t, high]:.4f}\u00a0pu at "
        f"node {plain(outlook.nodes[high])}.",
    ]
    if drop[most] > 1e-6:
        lines.append(
            f"**Charging lowers** node {plain(outlook.nodes[most])} the most, by "
            f"{drop[most]:.4f}\u00a0pu."
        )
    if loaded := _most_loaded(moment):
        lines.append(loaded)
    lines.append(_checked(moment))
    return lines


def _station(moment: Moment) -> str:
    outlook, t = moment.outlook, moment.interval
    kw, room = outlook.station_kw[t], outlook.headroom_kw[t]
    what = "draws" if t < outlook.now else "is planned to draw"
    said = f"**The station {what} {kw:,.0f}\u00a0kW**"
    if not math.isfinite(room):
        return f"{said}; the feeder sets no limit."
    limit = element_words(outlook.binding[t], moment.scenario)
    return f"{said} of the {room:,.0f}\u00a0kW there is room for, limited by {limit}."


def _most_loaded(moment: Moment) -> str:
    flows, t = moment.flows, moment.interval
    rated = np.flatnonzero(np.isfinite(flows.rating_kva) & (flows.rating_kva > 0))
    if not len(rated):
        return ""
    share = flows.line_kva[t, rated] / flows.rating_kva[rated]
    worst = int(rated[int(share.argmax())])
    line = moment.scenario.lines[worst]
    return (
        f"**Most loaded** {plain(line.from_node)}–{plain(line.to_node)}: "
        f"{flows.line_kva[t, worst]:,.0f} of {flows.rating_kva[worst]:,.0f}\u00a0kVA "
        f"({100 * share.max():.0f}\u00a0%)."
    )


def _checked(moment: Moment) -> str:
    """What the AC power flow says of this interval."""
    outlook, t = moment.outlook, moment.interval
    if t >= outlook.now:
        return "**AC power flow** checks this interval once it is over."
    if moment.ac_pu is None:
        return ":material/hourglass_top: **AC power flow** is being worked out …"
    if not np.isfinite(moment.ac_pu).all():
        return ":red[:material/warning: **AC power flow** has no solution here.]"
    low = int(moment.ac_pu.argmin())
    said = f"**By AC power flow** the lowest is {moment.ac_pu[low]:.4f}\u00a0pu at node "
    said += f"{plain(outlook.nodes[low])}"
    if moment.ac_pu[low] < outlook.voltage_min_pu - 1e-6:
        return f":red[:material/warning: {said}, below the lowest allowed.]"
    return f"{said}."


def tightest_rows(found: Iterable[tuple[str, float]]) -> list[dict[str, object]]:
    """The tightest limits of an interval as rows of a table."""
    return [{"Tightest limits": element_name(name), "Room, kW": round(kw)} for name, kw in found]


def gap_line(gaps: tuple[Gap, ...], outlook: Outlook) -> str:
    """How far the two models are apart at the worst."""
    if not gaps:
        return (
            "The optimiser works with a linearised model, which leaves losses out. Every interval "
            "that is over is solved again here by full AC power flow."
        )
    worst = max(gaps, key=lambda gap: abs(gap.difference))
    side = "too high" if worst.difference > 0 else "too low"
    return (
        f"**At worst {abs(worst.difference):.5f}\u00a0pu apart**, at node {plain(worst.node)}, "
        f"{clock(outlook.times[worst.interval], outlook)}: the linearised voltage is {side}."
    )


def element_names(outlook: Outlook) -> dict[str, str]:
    """A few words for every element that binds in some interval."""
    return {element: element_name(element) for element in outlook.binding if element}


def violation_rows(
    found: Iterable[Violation], model: str, outlook: Outlook
) -> list[dict[str, object]]:
    """Violations as rows of a table: what, whose doing, how deep, how long, when."""
    hours = (outlook.times[1] - outlook.start).total_seconds() / 3600
    return [
        {
            "Limit": element_name(one.element),
            "Model": model,
            "Cause": CAUSES[one.cause],
            "Beyond by": _depth(one.depth, one.unit),
            "Without charging": _depth(one.base_depth, one.unit) if one.base_depth > 0 else "held",
            "For": f"{hours * len(one.intervals):g} h",
            "Worst at": clock(outlook.times[one.worst], outlook),
            "When": _when(one, outlook),
        }
        for one in found
    ]


def _when(one: Violation, outlook: Outlook) -> str:
    if one.intervals[-1] < outlook.now:
        return "executed"
    return "planned" if one.intervals[0] >= outlook.now else "executed, planned"


def _depth(depth: float, unit: str) -> str:
    return f"{depth:.4f} pu" if unit == "pu" else f"{depth:,.1f} {unit}"


def verdict(
    linear: Iterable[Violation],
    ac: Iterable[Violation],
    *,
    waiting: int,
    unchecked: bool,
    begun: bool,
) -> list[str]:
    """What the tables of violations come to, in a line for each model and cause.

    Nothing is called kept while intervals are `waiting` for AC or could not be checked by it.
    """
    lines = []
    for found, model in ((tuple(linear), "linearised model"), (tuple(ac), "AC power flow")):
        mine = len({one.element for one in found if one.cause != "feeder"})
        own = len({one.element for one in found if one.cause == "feeder"})
        if mine:
            lines.append(
                f":red[:material/warning: **{counted(mine, 'limit')} exceeded because of "
                f"charging**, by the {model}.]"
            )
        if own:
            lines.append(
                f":orange[:material/info: {counted(own, 'limit')} exceeded by the feeder itself, "
                f"by the {model}; charging does not worsen that.]"
            )
    if waiting:
        lines.append(f":material/hourglass_top: {counted(waiting, 'interval')} being checked …")
    elif not lines and not unchecked:
        models = "in both models" if begun else "in the linearised model; AC power flow follows"
        lines.append(f":green[:material/check_circle: Every limit holds, {models}.]")
    return lines
