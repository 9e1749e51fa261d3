"""What a report says in sentences. Plain text; whoever sets it into HTML or cells escapes it."""

from collections.abc import Iterable

import numpy as np

from evdash.domain.arrivals import GeneratedArrivals
from evdash.domain.events import Event
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.domain.words import counted as counted  # noqa: PLC0414 - ours, too
from evdash.domain.words import element_words
from evdash.explain.words import Clock
from evdash.grid.lindistflow import load_kvar_of
from evdash.metrics.verdict import Violation
from evdash.metrics.verdict_words import Wording, sentences
from evdash.policies.registry import described
from evdash.reports.account import Account, edited

KEPT = "the last plan was kept:"
MOST_KEPT = 5
NETWORK_WORDS = {
    "lindistflow": "the linearised DistFlow model, as in the paper",
    "ac": "full AC power flow",
}
EDITED = (
    "Settings were changed by hand on the way. The run's files hold what was in force last: the "
    "time before cannot be audited with them, nor decided again."
)
CAUSES = {
    "station": "charging",
    "both": "feeder and charging",
    "feeder": "feeder itself",
}


def period(scenario: Scenario) -> str:
    """From when to when the day goes, and in which steps."""
    end = scenario.time_of(scenario.intervals)
    return (
        f"{scenario.start:%A, %d %B %Y, %H:%M} to {end:%d %B, %H:%M}, in "
        f"{counted(scenario.intervals, 'interval')} of {scenario.interval_minutes} min"
    )


def promises_line(account: Account) -> tuple[str, str]:
    """(state, sentence): what became of the promises. States: good, bad, note."""
    day = account.totals
    said = f"{day.admitted:,} of {counted(day.arrived, 'vehicle')} admitted"
    if day.broken:
        return "bad", f"{said}; {counted(day.broken, 'promise')} broken."
    if not day.admitted:
        return "note", f"{said}."
    released = f", {day.released} cut short by their drivers" if day.released else ""
    return "good", f"{said}; every promise kept: in full and on time{released}."


def limit_lines(account: Account) -> list[tuple[str, str]]:
    """(state, sentence) for each network model: which limits were exceeded, and whose doing."""
    wording = Wording.of(account.trace, Clock(account.scenario, 0).at)
    told = sentences(account.verdict.models, wording)
    lines: list[tuple[str, str]] = [(one.state, one.text) for one in told]
    error = account.verdict.worst_voltage_error_pu
    if error is not None:
        apart = f"At worst the linearised voltages are {error:.5f} pu from those of AC."
        lines.append(("note", apart))
    return lines


def feeder_words(scenario: Scenario) -> list[str]:
    """The feeder and what it carries without the station."""
    feeder, nodes = scenario.feeder, scenario.nodes
    load_kw = feeder.load_scale * sum(node.load_kw or 0.0 for node in nodes)
    load_kvar = feeder.load_scale * sum(load_kvar_of(n, feeder.power_factor) for n in nodes)
    shunt_kvar = sum(node.shunt_kvar or 0.0 for node in nodes)
    generation_kw = sum(node.generation_kw or 0.0 for node in nodes)
    carried = f"Peak load {load_kw:,.0f} kW and {load_kvar:,.0f} kvar"
    if shunt_kvar:
        carried += f"; capacitors {shunt_kvar:,.0f} kvar"
    if generation_kw:
        carried += f"; peak generation {generation_kw:,.0f} kW"
    rated = [
        f"{line.name} {line.rating_kva:,.0f} kVA" for line in scenario.lines if line.rating_kva
    ]
    rated += [f"node {n.node} {n.rating_kva:,.0f} kVA" for n in nodes if n.rating_kva]
    return [
        f"{counted(len(nodes), 'node')} and {counted(len(scenario.lines), 'line')}, radial, at "
        f"{feeder.base_kv:g} kV; supplied at node {feeder.source_node} with "
        f"{feeder.source_voltage_pu:g} pu.",
        f"Voltage allowed at every node: {feeder.voltage_min_pu:g} to "
        f"{feeder.voltage_max_pu:g} pu.",
        f"{carried}, times the profile of the day.",
        f"Ratings: {', '.join(rated)}." if rated else "No line, transformer or node has a rating.",
    ]


def station_words(scenario: Scenario) -> list[str]:
    """The station and what drivers may choose."""
    station = scenario.station
    return [
        f"At node {station.node}: {counted(station.chargers, 'vehicle')} can charge at the same "
        f"time, each with {station.min_kw:g} to {station.max_kw:g} kW, at an efficiency of "
        f"{station.efficiency:g}.",
        *(
            f"Option {option.name}: {option.price_per_kwh:g} $/kWh, back by the time that "
            f"{option.average_kw:g} kW on average would take."
            for option in scenario.option
        ),
    ]


def profile_words(scenario: Scenario) -> list[str]:
    """Energy prices, loads and generation over the day."""
    clock = Clock(scenario, 0)
    price, load, generation = scenario.price_per_kwh, scenario.load_pu, scenario.generation_pu
    lines = [
        f"Energy price {price.min():.4f} $/kWh (from {clock.at(int(price.argmin()))}) to "
        f"{price.max():.4f} $/kWh (from {clock.at(int(price.argmax()))}), mean "
        f"{price.mean():.4f} $/kWh.",
        f"Loads {load.min():.2f} (from {clock.at(int(load.argmin()))}) to {load.max():.2f} "
        f"(from {clock.at(int(load.argmax()))}) of their peak.",
    ]
    if np.any(generation) and any(node.generation_kw for node in scenario.nodes):
        at = clock.at(int(generation.argmax()))
        lines.append(f"Generation up to {generation.max():.2f} of its peak (from {at}).")
    return lines


def arrivals_words(account: Account) -> list[str]:
    """Who came, and how that was come by."""
    given, day = account.trace.inputs.given.arrivals, account.totals
    asked = (
        f"{counted(day.arrived, 'vehicle')} asked for "
        f"{day.energy_requested_kwh:,.0f} kWh in all, drawn from the grid."
    )
    if isinstance(given, GeneratedArrivals):
        return [
            asked,
            f"Arrivals drawn at random, {given.vehicles_per_day:g} in 24 h on average, with seed "
            f"{given.seed}; the run's files hold each of them.",
        ]
    return [asked, "Arrivals are given one by one."]


def event_lines(account: Account) -> list[str]:
    """What happened on the way and what it did to promises."""
    clock = Clock(account.scenario, 0)
    lines = []
    for happening in account.trace.happenings:
        told = f"{clock.at(happening.interval)}: {_told(happening.events, clock)}."
        if happening.short_kwh > 0:
            told += f" {happening.short_kwh:.1f} kWh promised could not be delivered in time."
        if happening.note:
            told += f" {happening.note}."
        lines.append(told)
    return lines


def _told(events: Iterable[Event], clock: Clock) -> str:
    return "; ".join(event.told(clock.at) for event in events)


def edit_lines(account: Account) -> list[str]:
    """Settings changed by hand on the way, which the run's files do not tell."""
    lines = [
        f"At {clock}, {one.place} from {one.before} to {one.after}."
        for clock, found in edited(account.trace).items()
        for one in found
    ]
    return [EDITED, *lines] if lines else []


def decided_words(account: Account) -> list[str]:
    """By which rule and under which model of the feeder it was decided, and how well."""
    rule, steps = described(account.label.policy), account.trace.steps
    lines = [f"Decided by {rule.title}. {rule.told}"]
    if rule.keeps_limits:
        lines.append(f"Limits are kept in {NETWORK_WORDS[account.label.network]}.")
    solved = [s.plan.report for s in steps if s.plan.report.objective is not None]
    proven = sum(report.status == "optimal" for report in solved)
    if solved:
        lines.append(
            f"Proven optimal to the cent in {proven} of {counted(len(steps), 'interval')}; the "
            f"slowest took {max(report.seconds for report in solved):.2f} s."
        )
    fallen = sum(step.plan.report.status == "fallback" for step in steps)
    if fallen:
        lines.append(
            f"In {counted(fallen, 'interval')} the certified plan of the interval before was kept "
            "and nobody new admitted."
        )
    return [*lines, *kept_plans(account.trace)]


def kept_plans(trace: Trace) -> list[str]:
    """When the last plan was kept in place of a new one, and why; beyond a few, how often."""
    kept = [step for step in trace.steps if step.plan.report.status == "fallback"]
    told = [f"{step.start:%H:%M} {KEPT} {step.plan.report.note}" for step in kept[:MOST_KEPT]]
    more = len(kept) - MOST_KEPT
    return [*told, f"and in {counted(more, 'more interval')}"] if more > 0 else told


def tightest_words(account: Account) -> str:
    """Where and when there was least room for charging."""
    headroom = account.outlook.headroom_kw
    if not np.isfinite(headroom).any():
        return "The feeder sets no limit to charging."
    t = int(headroom.argmin())
    element = element_words(account.outlook.binding[t], account.scenario)
    return (
        f"Least room for charging: {headroom[t]:,.0f} kW, from "
        f"{Clock(account.scenario, 0).at(t)}, limited by {element}."
    )


def violation_words(found: Violation, scenario: Scenario) -> str:
    """When a limit was exceeded."""
    return Clock(scenario, 0).spans(found.intervals)
