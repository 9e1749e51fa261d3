"""`run`: a whole day, its totals, and its files."""

import argparse
import time

from evdash.cli.progress import run_with_progress
from evdash.cli.report import print_explanations, print_report
from evdash.cli.terminal import progress_bar
from evdash.domain.trace import Trace
from evdash.errors import Fault, InputError
from evdash.explain.binding import binding_elements
from evdash.explain.refusals import Explanation, explained, refused
from evdash.explain.revisions import explain_revision
from evdash.explain.worth import day_worths
from evdash.files.bundled import DEFAULT
from evdash.files.exchange import Claim, output_folder
from evdash.files.explanation_table import DayExplained, explanation_files
from evdash.files.overrides import Setting, parse_settings
from evdash.files.run_export import RunLabel, judge, run_files
from evdash.files.run_folder import is_run, write_run
from evdash.files.scenario_folder import read_scenario
from evdash.metrics.breaches import linear_breaches
from evdash.metrics.service import totals
from evdash.policies.registry import Rule, given
from evdash.studies.crew import cores, in_order

EXPLAINED = "p1"
"""The policy whose refusals can be explained: by solving its problem again."""
BROKEN = 3


def run(options: argparse.Namespace) -> int:
    """Run a scenario; 3 if a promise or a limit was broken, 0 otherwise."""
    rule = given(options.policy)
    _check_explained(options)
    if options.out is None:
        return _run(options, rule, None)
    with output_folder(options.out, "run", is_run, options.force) as claim:
        return _run(options, rule, claim)


def _run(options: argparse.Namespace, rule: Rule, claim: Claim | None) -> int:
    began = time.perf_counter()
    settings = parse_settings(options.settings)
    if options.seed is not None:
        settings += (Setting("arrivals.seed", options.seed),)
    scenario = read_scenario(options.scenario or DEFAULT, settings)
    trace = run_with_progress(scenario, options.network, rule)
    verdict = judge(trace, linear_breaches(trace))
    label = RunLabel(
        policy=rule.name,
        network=options.network,
        seed=scenario.arrivals.seed,
        wall_seconds=time.perf_counter() - began,
    )
    day = _whole_day(trace) if options.explain else None
    if claim is not None:
        files = run_files(trace, verdict, label)
        if day is not None:
            files |= explanation_files(day)
        write_run(claim, files)
    print_report(trace, verdict, label, options.out)
    if options.out is None and day is not None:
        print_explanations(trace, day)
    return BROKEN if totals(trace).broken or verdict.broken_by_station(options.network) else 0


def _check_explained(options: argparse.Namespace) -> None:
    if options.explain and options.policy != EXPLAINED:
        fault = Fault("--explain", f"--policy {options.policy}", f"explains {EXPLAINED} alone")
        raise InputError([fault])


def _whole_day(trace: Trace) -> DayExplained:
    """Every refusal explained, what more of each limit is worth, what binds, what was revised."""
    return DayExplained(
        scenario=trace.scenario,
        refusals=_refusals(trace),
        worths=tuple(day_worths(trace)),
        bindings=binding_elements(trace),
        revisions=tuple(explain_revision(trace, step.interval) for step in trace.steps[1:]),
    )


def _refusals(trace: Trace) -> tuple[Explanation, ...]:
    with progress_bar() as progress:
        task = progress.add_task("explaining", total=totals(trace).refused)
        told: list[Explanation] = []
        for some in in_order(list(refused(trace)), explained, cores()):
            told.extend(some)
            progress.advance(task, len(some))
    return tuple(told)
