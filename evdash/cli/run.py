"""`run`: a whole day, its totals, and its files."""

import argparse
import time

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from evdash.cli.report import print_explanations, print_report
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Network, Trace
from evdash.errors import Fault, InputError
from evdash.explain.refusals import Explanation, explanations
from evdash.files.bundled import DEFAULT
from evdash.files.explanation_table import EXPLANATIONS, explanations_text
from evdash.files.overrides import Setting, parse_settings
from evdash.files.run_export import RunLabel, judge, run_files
from evdash.files.run_folder import check_target, write_run
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import run_day, start_day
from evdash.metrics.breaches import linear_breaches
from evdash.metrics.totals import totals
from evdash.policies.registry import RULES, Rule

EXPLAINED = "p1"
"""The policy whose refusals can be explained: by solving its problem again."""
BROKEN = 3


def run(options: argparse.Namespace) -> int:
    """Run a scenario; 3 if a promise or a limit was broken, 0 otherwise."""
    _check_explained(options)
    if options.out is not None:
        check_target(options.out, options.force)
    began = time.perf_counter()
    settings = parse_settings(options.settings)
    if options.seed is not None:
        settings += (Setting("arrivals.seed", options.seed),)
    scenario = read_scenario(options.scenario or DEFAULT, settings)
    trace = _with_progress(scenario, options.network, RULES[options.policy])
    verdict = judge(trace, linear_breaches(trace))
    label = RunLabel(
        policy=options.policy,
        network=options.network,
        seed=scenario.arrivals.seed,
        wall_seconds=time.perf_counter() - began,
    )
    explained = _explained(trace) if options.explain else ()
    if options.out is not None:
        files = run_files(trace, verdict, label)
        if options.explain:
            files[EXPLANATIONS] = explanations_text(explained)
        write_run(options.out, files)
    print_report(trace, verdict, label, options.out)
    if options.out is None:
        print_explanations(explained)
    return BROKEN if totals(trace).broken or verdict.broken_by_station(options.network) else 0


def _check_explained(options: argparse.Namespace) -> None:
    if options.explain and options.policy != EXPLAINED:
        fault = Fault("--explain", f"--policy {options.policy}", f"explains {EXPLAINED} alone")
        raise InputError([fault])


def _explained(trace: Trace) -> tuple[Explanation, ...]:
    """Every refusal explained."""
    with _progress() as progress:
        task = progress.add_task("explaining", total=totals(trace).refused)
        explained = []
        for explanation in explanations(trace):
            explained.append(explanation)
            progress.advance(task)
    return tuple(explained)


def _progress() -> Progress:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    return Progress(*columns, console=Console(stderr=True), transient=True)


def _with_progress(scenario: Scenario, network: Network, rule: Rule) -> Trace:
    with _progress() as progress:
        task = progress.add_task("preparing", total=scenario.intervals)

        def told(trace: Trace) -> None:
            clock = f"{scenario.time_of(trace.now):%H:%M}"
            progress.update(task, completed=trace.now, description=f"deciding {clock}")

        trace = start_day(scenario, network)
        return run_day(trace, rule.make(trace.inputs), told, rule.decide)
