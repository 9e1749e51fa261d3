"""`audit`: a run's files checked again by other means."""

import argparse

from evdash.audit.audit import audit_run
from evdash.cli.terminal import Terminal

SHOWN = 40
BROKEN = 3


def audit(options: argparse.Namespace) -> int:
    """Audit a run folder; 3 if anything in it is broken or untrue, 0 otherwise."""
    result = audit_run(options.directory)
    terminal = Terminal()
    run = result.run
    for finding in result.findings[:SHOWN]:
        terminal.say("  ", ("✗", "red"), f" {finding}")
    if len(result.findings) > SHOWN:
        terminal.say(f"    and {len(result.findings) - SHOWN} more")
    by_station = sum(breach.by_station for breach in result.ac)
    own = len(result.ac) - by_station
    if by_station:
        terminal.say((f"AC: {by_station} limits exceeded by the station", "bold red"))
    if own or result.feeder_own:
        told = (
            f"outside by the feeder itself: {own} limits in AC, "
            f"{len(result.feeder_own)} in the linearised model"
        )
        terminal.say((told, "bold yellow"))
    if result.flow.diverged:
        terminal.say((f"AC: no solution in {len(result.flow.diverged)} intervals", "bold red"))
    if result.findings:
        terminal.say((f"{len(result.findings)} findings", "bold red"))
        return BROKEN
    served = sum(row.status != "refused" for row in run.vehicles)
    terminal.say(
        ("ok", "bold green"),
        f" {run.scenario.name}: {served} contracts kept, every limit "
        f"of the feeder and the chargers held, {len(run.intervals)} intervals, "
        f"{len(run.voltages)} voltages and all totals worked out again",
    )
    return 0
