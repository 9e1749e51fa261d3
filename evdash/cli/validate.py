"""`validate`: says ok or lists every fault."""

import argparse

from evdash.cli.terminal import Terminal
from evdash.domain.arrivals import RecordedArrivals
from evdash.files.scenario_folder import read_scenario


def validate(options: argparse.Namespace) -> int:
    """Check a scenario; faults come as InputError."""
    scenario = read_scenario(options.scenario)
    known = scenario.arrivals
    if isinstance(known, RecordedArrivals):
        arrivals = f"{len(known.vehicles)} arrivals on file"
    else:
        arrivals = f"about {known.vehicles_per_day:g} arrivals in 24 h, seed {known.seed}"
    told = (
        f" {scenario.name}: {len(scenario.nodes)} nodes, "
        f"{scenario.intervals} intervals of {scenario.interval_minutes} min, {arrivals}"
    )
    Terminal().say(("ok", "bold green"), told)
    return 0
