"""The run so far and what is ahead, in a few sentences: the head of the Live page."""

from collections.abc import Sequence

import numpy as np

from evdash.domain.elements import CHARGERS
from evdash.domain.outlook import Outlook
from evdash.domain.refusal import named
from evdash.domain.trace import Trace
from evdash.explain.binding import REACHED_KW, reached_in
from evdash.metrics.ledger import LedgerEntry, broken_promises, ledger
from evdash.metrics.records import refused_by_reason, vehicle_records
from evdash.metrics.service import Totals
from evdash.ui.words import clock, counted, decided_by, element_words, money, plain


def story(trace: Trace, outlook: Outlook, totals: Totals) -> str:
    """How many were admitted and why not the others, what limited charging or will."""
    who = decided_by(trace.policy)
    if not trace.steps:
        by = f" It will be {who}." if who else ""
        return f"**The day is about to begin.**{by} {_limit_ahead(trace, outlook)}"
    who = f", {who}" if who else ""
    admitted = f"**{totals.admitted:,} of {counted(totals.arrived, 'PEV')} admitted**{who}"
    broken = _broken(broken_promises(ledger(trace)), outlook)
    if trace.is_over:
        return (
            f"**The day is over:** {admitted}{_kept(totals)}; "
            f"{totals.energy_delivered_kwh:,.0f}\u00a0kWh delivered for a profit of "
            f"{money(totals.profit)}. {broken}{_why_not(trace)}{_limits_behind(trace, outlook)}"
        )
    charging = int(trace.steps[-1].plan.charging[0])
    return f"{admitted}, {charging} charging. {broken}{_limit_ahead(trace, outlook)}"


def _kept(totals: Totals) -> str:
    if totals.broken or not totals.admitted:
        return ""
    if totals.released:
        return f", every promise kept, {totals.released:,} cut short by their drivers"
    return ", every one charged in full and on time"


def broken_told(entries: Sequence[LedgerEntry], now: int) -> str:
    """How many promises are broken, and how many will be; nothing where all are or can be kept."""
    over = sum(entry.revised_by_interval <= now for entry in entries)
    ahead = len(entries) - over
    told = [f"{counted(over, 'promise')} broken"] * (over > 0)
    told += [f"{counted(ahead, 'promise')} cannot be kept as things stand"] * (ahead > 0)
    return ", ".join(told)


def _broken(entries: Sequence[LedgerEntry], outlook: Outlook) -> str:
    """Promises not kept, or known not to be kept: whose, how much is missing, since when, why."""
    if not entries:
        return ""
    missing_kwh = sum(entry.short_kwh for entry in entries)
    who = named([plain(entry.vehicle) for entry in entries])
    told = f"**{broken_told(entries, outlook.now)}**: {missing_kwh:,.1f}\u00a0kWh missing for {who}"
    since = {entry.since_interval for entry in entries if entry.since_interval is not None}
    if since:
        causes = dict.fromkeys(plain(entry.cause) for entry in entries if entry.cause)
        told += f", known since {clock(outlook.times[min(since)], outlook)}: {'; '.join(causes)}"
    return f":red[:material/warning: {told}.] "


def _why_not(trace: Trace) -> str:
    """All refusals of a day that is over, by reason."""
    told = ", ".join(
        f"{plain(reason)}\u00a0({len(records):,})"
        for reason, records in refused_by_reason(vehicle_records(trace)).items()
    )
    return f"Refused: {told}. " if told else ""


def _limit_ahead(trace: Trace, outlook: Outlook) -> str:
    ahead = outlook.headroom_kw[outlook.now :]
    station = trace.scenario.station
    if not station.chargers:
        return "The station has no chargers."
    if not np.isfinite(ahead).any():
        return "The feeder sets no limit to charging."
    least_kw, most_kw = float(ahead.min()), station.chargers * station.max_kw
    if least_kw >= most_kw:
        return (
            f"From now on the feeder limits nothing: it leaves at least {least_kw:,.0f}\u00a0kW, "
            f"and {counted(station.chargers, 'charger')} can draw {most_kw:,.0f}\u00a0kW at most."
        )
    t = int(outlook.headroom_kw.argmin())
    when, room = f"**{clock(outlook.times[t], outlook)}**", f"{outlook.headroom_kw[t]:,.0f}\u00a0kW"
    if t < outlook.now:
        return (
            f"The feeder's tightest hour is behind: {when} left {room}. From now on it leaves at "
            f"least {least_kw:,.0f}\u00a0kW."
        )
    limit = (
        f"{_capital(element_words(outlook.binding[t], trace.scenario))} is the feeder's tightest"
    )
    room = f"{room} left for charging"
    if t == outlook.now:
        return f"{limit} limit, and now is its tightest hour: {room}."
    return f"{limit} limit; {when} will be its tightest hour, {room}."


def _limits_behind(trace: Trace, outlook: Outlook) -> str:
    """In how many intervals chargers and feeder were used up."""
    chargers = [step.inputs.scenario.station.chargers for step in trace.steps]
    if not any(chargers):
        return "The station has no chargers."
    busy = sum(
        0 < there <= step.plan.charging[0]
        for there, step in zip(chargers, trace.steps, strict=True)
    )
    hourly = trace.scenario.interval_minutes == 60
    of_all = f"of {counted(outlook.n_intervals, 'hour' if hourly else 'interval')}"
    used = f"All chargers were in use in {busy} {of_all}" if busy else "A charger was always free"
    headroom_kw = outlook.headroom_kw
    full = [s.interval for s in trace.steps if any(e != CHARGERS for e in reached_in(s))]
    if not full:
        return f"{used}; the feeder was never full."
    t = min(full, key=lambda t: headroom_kw[t])
    room = f"just {headroom_kw[t]:,.0f}\u00a0kW" if headroom_kw[t] > REACHED_KW else "nothing"
    element = element_words(outlook.binding[t], trace.scenario)
    return (
        f"{used}; the feeder was full in {len(full)}{'' if busy else f' {of_all}'}: at "
        f"{clock(outlook.times[t], outlook)} {element} allowed {room}."
    )


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
