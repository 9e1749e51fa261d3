"""What a run prints: the day in one table, and loudly whatever is outside its limits."""

from collections.abc import Mapping
from pathlib import Path

from rich.table import Table
from rich.text import Text

from evdash.cli.terminal import Terminal, line
from evdash.domain.trace import Trace
from evdash.explain.binding import binding_told
from evdash.explain.words import Clock
from evdash.files.explanation_table import DayExplained
from evdash.files.run_export import RunLabel, Verdict
from evdash.metrics.ledger import LedgerEntry, ledger
from evdash.metrics.records import (
    IntervalRecord,
    interval_records,
    refused_by_reason,
    vehicle_records,
)
from evdash.metrics.service import Totals, totals
from evdash.metrics.verdict_words import State, Wording, sentences
from evdash.reports.words import KEPT, kept_plans

HOURLY_ROWS = 48
SENTENCE_STYLE: Mapping[State, str] = {
    "bad": "bold red",
    "note": "bold yellow",
    "good": "green",
    "open": "dim",
}
STATUS_STYLE = {"optimal": "green", "feasible": "yellow", "fallback": "red"}


def print_report(trace: Trace, verdict: Verdict, label: RunLabel, out: Path | None) -> None:
    """Print a finished day to standard output."""
    terminal = Terminal()
    day = totals(trace)
    scenario = trace.scenario
    terminal.print()
    began = f"  {scenario.start:%Y-%m-%d %H:%M}, policy {label.policy}, {label.network}, "
    terminal.say((scenario.name, "bold"), f"{began}seed {label.seed}")
    if trace.scenario.intervals <= HOURLY_ROWS:
        terminal.print(_hourly(interval_records(trace)))
    terminal.print(_totals(trace, day, label))
    _print_reasons(terminal, trace)
    _print_happenings(terminal, trace)
    _print_kept(terminal, trace)
    _print_verdict(terminal, trace, verdict)
    if out is not None:
        terminal.say(f"written to {out}")


def print_explanations(trace: Trace, day: DayExplained) -> None:
    """Every refusal with reason and remedy, what binds when, worths, and each plan revised."""
    terminal = Terminal()
    told = [(refusal.vehicle, refusal.text) for refusal in day.refusals]
    told += [("What binds", sentence) for sentence in binding_told(trace)]
    told += [("What more is worth", worth.text) for worth in day.worths]
    told += [("Plan revised", revision.text) for revision in day.revisions if revision.moves]
    for name, text in told:
        terminal.say((name, "bold"), f" {text}")


def _hourly(records: tuple[IntervalRecord, ...]) -> Table:
    table = Table(box=None, header_style="dim", pad_edge=False, padding=(0, 1, 0, 0))
    for name in ("from", "energy\n$/kWh", "\nasked", "\nadmitted", "\nrefused", "\ncharging"):
        table.add_column(Text(name), justify="right", no_wrap=True)
    for name in ("station\nkW", "headroom\nkW"):
        table.add_column(Text(name), justify="right", no_wrap=True)
    table.add_column(Text("tightest\nlimit"), overflow="ellipsis", no_wrap=True)
    all_proven = all(_needs_no_word(record) for record in records)
    if not all_proven:
        table.add_column(Text("\nplan"), no_wrap=True)
    for record in records:
        room = "–" if record.headroom_kw is None else f"{record.headroom_kw:.1f}"
        style = STATUS_STYLE[record.status]
        table.add_row(
            f"{record.start:%H:%M}",
            f"{record.price_per_kwh:.4f}",
            f"{record.arrived or ''}",
            f"{record.admitted or ''}",
            line((f"{record.refused or ''}", "bold")),
            f"{record.charging or ''}",
            f"{record.station_kw:.1f}",
            room,
            record.binding or "nothing",
            *([] if all_proven else [line((record.status, style))]),
        )
    return table


def _needs_no_word(record: IntervalRecord) -> bool:
    """Whether a plan is proven, or of a policy that proves nothing."""
    unproven_p1 = record.status == "feasible" and record.objective is not None
    return record.status != "fallback" and not unproven_p1


def _totals(trace: Trace, day: Totals, label: RunLabel) -> Table:
    table = Table(show_header=False, pad_edge=False)
    share = f" ({day.admitted / day.arrived:.0%})" if day.arrived else ""
    rows = (
        ("vehicles arrived", f"{day.arrived}"),
        ("admitted", f"{day.admitted}{share}"),
        ("refused", f"{day.refused}"),
        ("contracts kept", f"{day.charged} of {day.admitted}"),
        *([("cut short by drivers", f"{day.released}")] if day.released else []),
        ("energy delivered", f"{day.energy_delivered_kwh:,.1f} kWh"),
        ("highest station power", f"{day.peak_station_kw:.1f} kW"),
        ("revenue", f"$ {day.revenue:,.2f}"),
        ("energy cost", f"$ {day.energy_cost:,.2f}"),
        ("profit", f"$ {day.profit:,.2f}"),
        *([("proven optimal", _proven(trace))] if _solves_p1(trace) else []),
        ("time taken", f"{label.wall_seconds:.1f} s"),
    )
    for name, value in rows:
        table.add_row(name, line((value, "bold")))
    return table


def _proven(trace: Trace) -> str:
    optimal = sum(step.plan.report.status == "optimal" for step in trace.steps)
    return f"{optimal} of {len(trace.steps)} intervals, to the cent"


def _solves_p1(trace: Trace) -> bool:
    return any(
        step.plan.report.status != "fallback" and step.plan.report.objective is not None
        for step in trace.steps
    )


def _print_reasons(terminal: Terminal, trace: Trace) -> None:
    """Refusals by reason."""
    for reason, records in refused_by_reason(vehicle_records(trace)).items():
        terminal.say(f"  {len(records):>4} refused: {reason}")


def _print_happenings(terminal: Terminal, trace: Trace) -> None:
    """What happened on the way, and what it changed."""

    def clock(interval: int) -> str:
        return f"{trace.scenario.time_of(interval):%H:%M}"

    for happening in trace.happenings:
        told = "; ".join(event.told(clock) for event in happening.events)
        terminal.say(f"  {clock(happening.interval)} {told}")
        if happening.short_kwh:
            short = [revision for revision in happening.revisions if revision.short_kwh > 0]
            missing = (
                f"{happening.short_kwh:.1f} kWh promised to {len(short)} vehicles "
                "cannot be delivered in time"
            )
            terminal.say("        ", (missing, "red"))
        if happening.note:
            terminal.say(f"        {happening.note}")


def _print_kept(terminal: Terminal, trace: Trace) -> None:
    for told in kept_plans(trace):
        when, kept, why = told.partition(KEPT)
        terminal.say((f"  {when}{kept}", "bold yellow"), why)


def ledger_line(trace: Trace, entry: LedgerEntry) -> str:
    """A contract that is short, in a sentence."""
    told = (
        f"{entry.vehicle} got {entry.delivered_kwh:.2f} of {entry.revised_kwh:.2f} kWh promised, "
        f"{entry.short_kwh:.2f} kWh short"
    )
    if entry.since_interval is None:
        return told
    return (
        f"{told}; known since {trace.scenario.time_of(entry.since_interval):%H:%M}: {entry.cause}"
    )


def _print_verdict(terminal: Terminal, trace: Trace, verdict: Verdict) -> None:
    for entry in ledger(trace):
        if entry.status == "short":
            terminal.say(("broken:", "bold red"), f" {ledger_line(trace, entry)}")
    wording = Wording.of(trace, Clock(trace.scenario, 0).at)
    for one in sentences(verdict.models, wording):
        details = f": {one.details}" if one.details else ""
        terminal.say((one.head, SENTENCE_STYLE[one.state]), details)
    error = verdict.worst_voltage_error_pu
    if error is not None:
        terminal.say(f"linearised voltages differ from AC by at most {error:.4f} pu")
