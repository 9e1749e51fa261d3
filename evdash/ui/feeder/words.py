"""What the Feeder page says in plain words. Markdown; user text is escaped."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from evdash.charts.feeder_moment import Moment, loading_told
from evdash.charts.voltage_map import AcVoltages
from evdash.domain.elements import Element
from evdash.domain.outlook import Outlook
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Network
from evdash.domain.words import depth_words, element_name
from evdash.metrics.feeder import Gap
from evdash.metrics.verdict import LINEARISED, ModelVerdict, Violation, ac_verdict, verdict_of
from evdash.metrics.verdict_words import Wording, sentences
from evdash.ui.words import clock, element_words, marked, plain

MODELS: Mapping[Network, str] = {"lindistflow": "linearised", "ac": "AC"}
CAUSES = {
    "station": "charging",
    "both": "feeder and charging",
    "feeder": "feeder itself",
}


def headline(outlook: Outlook, ac: AcVoltages, scenario: Scenario) -> str:
    """The lowest voltage of the day by both models and the tightest limit, in a sentence or two."""
    t = int(outlook.voltage_pu.min(axis=1).argmin())
    i = int(outlook.voltage_pu[t].argmin())
    low = (
        f"**Lowest voltage {outlook.voltage_pu[t, i]:.4f}\u00a0pu** linearised, at node "
        f"{plain(outlook.nodes[i])}, {clock(outlook.times[t], outlook)}{_lowest_of(ac, outlook)} "
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


def _lowest_of(ac: AcVoltages, outlook: Outlook) -> str:
    """The lowest voltage that AC power flow found so far."""
    solved = {t: voltage for t, voltage in ac.items() if np.isfinite(voltage).all()}
    if not solved:
        return ""
    t = min(solved, key=lambda t: float(solved[t].min()))
    i = int(solved[t].argmin())
    return (
        f"; by AC power flow **{solved[t][i]:.4f}\u00a0pu** at node {plain(outlook.nodes[i])}, "
        f"{clock(outlook.times[t], outlook)}"
    )


def moment_lines(moment: Moment, wording: Wording) -> list[str]:
    """One interval of the drawing in numbers, and what the models say of its limits."""
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
    if lowest := _lowest_in_ac(moment):
        lines.append(lowest)
    return lines + [marked(one) for one in sentences(_verdicts(moment), wording)]


def _verdicts(moment: Moment) -> tuple[ModelVerdict, ModelVerdict]:
    """What either model says of this interval."""
    t, ac = moment.interval, moment.ac
    executed = int(t < moment.outlook.now)
    found = {} if ac is None else {t: ac}
    return verdict_of(LINEARISED, moment.linear, 1), ac_verdict(found, executed)


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
    rating_kva = flows.rating_kva[t]
    rated = np.flatnonzero(np.isfinite(rating_kva) & (rating_kva > 0))
    if not len(rated):
        return ""
    shown = replace(moment, way="with")
    row: int = max(rated.tolist(), key=lambda i: np.nanmax([shown.loading[i], shown.ac_loading[i]]))
    line = moment.scenario.lines[row]
    return (
        f"**Most loaded** {plain(line.from_node)}–{plain(line.to_node)}: "
        f"{flows.line_kva[t, row]:,.0f} of {rating_kva[row]:,.0f}\u00a0kVA "
        f"({loading_told(shown, row)})."
    )


def _lowest_in_ac(moment: Moment) -> str:
    if moment.ac is None or not moment.ac.solved:
        return ""
    low = int(moment.ac.voltage_pu.argmin())
    return (
        f"**By AC power flow** the lowest is {moment.ac.voltage_pu[low]:.4f}\u00a0pu at node "
        f"{plain(moment.outlook.nodes[low])}."
    )


def tightest_rows(found: Iterable[tuple[Element, float]]) -> list[dict[str, object]]:
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


def violation_rows(
    found: Iterable[Violation], network: Network, outlook: Outlook
) -> list[dict[str, object]]:
    """Violations as rows of a table: what, whose doing, how deep, how long, when."""
    hours = (outlook.times[1] - outlook.start).total_seconds() / 3600
    return [
        {
            "Limit": element_name(one.element),
            "Model": MODELS[network],
            "Cause": CAUSES[one.cause],
            "Beyond by": depth_words(one.depth, one.unit),
            "Without charging": (
                depth_words(one.base_depth, one.unit) if one.base_depth > 0 else "held"
            ),
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
