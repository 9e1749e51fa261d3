"""`audit`: a run's files checked again by other means."""

import argparse

from rich.console import Console
from rich.markup import escape

from evdash.audit.audit import audit_run

SHOWN = 40
BROKEN = 3


def audit(options: argparse.Namespace) -> int:
    """Audit a run folder; 3 if anything in it is broken or untrue, 0 otherwise."""
    result = audit_run(options.directory)
    console = Console(highlight=False)
    run = result.run
    for finding in result.findings[:SHOWN]:
        console.print(f"  [red]✗[/] {escape(finding)}", soft_wrap=True)
    if len(result.findings) > SHOWN:
        console.print(f"    and {len(result.findings) - SHOWN} more")
    by_station = sum(breach.by_station for breach in result.ac)
    own = len(result.ac) - by_station
    if by_station:
        console.print(f"[bold red]AC: {by_station} limits exceeded by the station[/]")
    if own or result.feeder_own:
        console.print(
            f"[bold yellow]outside by the feeder itself: {own} limits in AC, "
            f"{len(result.feeder_own)} in the linearised model[/]"
        )
    if result.flow.diverged:
        console.print(f"[bold red]AC: no solution in {len(result.flow.diverged)} intervals[/]")
    if result.findings:
        console.print(f"[bold red]{len(result.findings)} findings[/]")
        return BROKEN
    served = sum(row.status != "refused" for row in run.vehicles)
    console.print(
        f"[bold green]ok[/] {escape(run.scenario.name)}: {served} contracts kept, every limit "
        f"of the feeder and the chargers held, {len(run.intervals)} intervals, "
        f"{len(run.voltages)} voltages and all totals worked out again",
        soft_wrap=True,
    )
    return 0
