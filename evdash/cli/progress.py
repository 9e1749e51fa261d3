"""A day run while a bar tells which interval is being decided."""

from evdash.cli.terminal import progress_bar
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Network, Trace
from evdash.horizon.day import run_day, start_day
from evdash.policies.registry import Rule


def run_with_progress(scenario: Scenario, network: Network, rule: Rule) -> Trace:
    """A whole day, telling which interval is being decided."""
    with progress_bar() as progress:
        task = progress.add_task("preparing", total=scenario.intervals)

        def told(trace: Trace) -> None:
            clock = f"{scenario.time_of(trace.now):%H:%M}"
            progress.update(task, completed=trace.now, description=f"deciding {clock}")

        trace = start_day(scenario, network, rule.name)
        return run_day(trace, rule.make(trace.inputs), told, rule.decide)
