"""`export`: an earlier run, or a day run now, as files to hand on."""

import argparse
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from evdash.cli.options import add_settings
from evdash.cli.progress import run_with_progress
from evdash.cli.terminal import Terminal, progress_bar
from evdash.domain.trace import Network, Trace
from evdash.errors import Fault, InputError
from evdash.explain.worth import day_worths
from evdash.files.bundled import located
from evdash.files.draft import zipped
from evdash.files.exchange import put_files
from evdash.files.overrides import Setting, parse_settings
from evdash.files.run_export import RunLabel
from evdash.files.scenario_folder import read_scenario
from evdash.metrics.ageing import Thermal
from evdash.policies import registry
from evdash.reports.account import Account, account, flows_needed, transformer_of, verdict_on
from evdash.reports.again import decided_again, earlier_run, is_run_folder
from evdash.reports.bundle import check_files
from evdash.reports.html import report_html
from evdash.reports.network import interval_at, network_json
from evdash.reports.ocpp import DEFAULT_ZONE, check_zone, clock_note, profiles_zip
from evdash.reports.ocpp_limits import Current, current_of
from evdash.reports.workbook import workbook_bytes

BROKEN = 3
LEAST_C, MOST_C = -50.0, 70.0
OF_SCENARIOS = ("policy", "network", "seed", "settings")
Make = Callable[[Account, argparse.Namespace], bytes]
OUTPUTS: Mapping[str, Make] = {
    "report": lambda told, _: report_html(told).encode(),
    "excel": lambda told, _: workbook_bytes(told),
    "ocpp": lambda told, options: profiles_zip(told.trace, options.time_zone, _current(options)),
    "pandapower": lambda told, options: _network(told, options.at),
    "run_zip": lambda told, _: zipped(dict(told.files), "run"),
}
"""What can be handed on, by the option that names its file."""


def _network(told: Account, clock: str) -> bytes:
    interval = interval_at(told.scenario, clock) if clock else None
    return network_json(told.trace, interval).encode()


def _current(options: argparse.Namespace) -> Current | None:
    return current_of(options.amperes) if options.amperes else None


def export(options: argparse.Namespace) -> int:
    """Write the files asked for; 3 if a promise or a limit was broken, 0 otherwise."""
    targets = {
        f"--{name.replace('_', '-')}": getattr(options, name)
        for name in OUTPUTS
        if getattr(options, name) is not None
    }
    if not targets:
        allowed = f"should be one or more of --{', --'.join(OUTPUTS)}".replace("_", "-")
        raise InputError([Fault("export", "nothing to write", allowed)])
    check_files(targets, options.force)
    if not LEAST_C <= options.ambient <= MOST_C:
        allowed = f"should be from {LEAST_C:g} to {MOST_C:g} °C"
        raise InputError([Fault("--ambient", f"{options.ambient:g} °C", allowed)])
    check_zone(options.time_zone)
    _current(options)
    trace, label = _day(options)
    if options.at:
        interval_at(trace.scenario, options.at)  # tells what is wrong before the AC power flows
    told = _account(trace, label, options)
    contents = {
        getattr(options, name): make(told, options)
        for name, make in OUTPUTS.items()
        if getattr(options, name) is not None
    }
    put_files(contents)
    terminal = Terminal()
    for path, content in contents.items():
        terminal.say(f"written to {path} ({len(content):,} bytes)")
    if options.ocpp is not None and (note := clock_note(trace.scenario, options.time_zone)):
        terminal.say(note)
    broken = told.totals.broken or told.verdict.broken_by_station(label.network)
    return BROKEN if broken else 0


def _day(options: argparse.Namespace) -> tuple[Trace, RunLabel]:
    """The finished day and what it was made with."""
    if is_run_folder(options.source):
        given = [name for name in OF_SCENARIOS if getattr(options, name) not in (None, [])]
        if given:
            place = ", ".join(f"--{'set' if name == 'settings' else name}" for name in given)
            allowed = "is for a scenario; a run has been decided already"
            raise InputError([Fault(place, f"{options.source}, an earlier run", allowed)])
        earlier = earlier_run(options.source)
        return decided_again(earlier, run_with_progress), earlier.label
    settings = parse_settings(options.settings)
    if options.seed is not None:
        settings += (Setting("arrivals.seed", options.seed),)
    scenario = read_scenario(options.source, settings)
    rule = registry.given(options.policy or "p1")
    network: Network = options.network or "lindistflow"
    trace = run_with_progress(scenario, network, rule)
    seconds = sum(step.plan.report.seconds for step in trace.steps)
    return trace, RunLabel(rule.name, network, scenario.arrivals.seed, seconds)


def _account(trace: Trace, label: RunLabel, options: argparse.Namespace) -> Account:
    transformer_of(trace.scenario, options.transformer)
    with progress_bar() as progress:
        task = progress.add_task("checking in AC", total=flows_needed(trace))
        verdict = verdict_on(trace, partial(progress.advance, task))
        worths = tuple(worth.text for worth in day_worths(trace)) if options.worths else ()
    return account(
        trace,
        verdict,
        label,
        thermal=Thermal(ambient_c=options.ambient),
        transformer=options.transformer,
        worths=worths,
    )


def add_export(commands: "argparse._SubParsersAction[argparse.ArgumentParser]", told: str) -> None:
    """The command's options; `told` says what its exit statuses mean."""
    command = commands.add_parser(
        "export",
        help="hand a run on: report, workbook, OCPP profiles, pandapower network",
        description="Write what a finished day can be handed on as. An earlier run is decided "
        "again and must come out as its files tell; a scenario is run first.",
        epilog=told,
    )
    command.add_argument(
        "source",
        type=located,
        metavar="SOURCE",
        help="an earlier run's folder (run --out), or a scenario: a folder, a .zip or the name of "
        "a bundled one",
    )
    files = command.add_argument_group("what to write")
    files.add_argument(
        "--report",
        type=Path,
        metavar="FILE.html",
        help="the report: one HTML file that needs nothing else, made to be printed, too",
    )
    files.add_argument(
        "--excel",
        type=Path,
        metavar="FILE.xlsx",
        help="a workbook with a sheet for every table, units and notes in its heads",
    )
    files.add_argument(
        "--ocpp",
        type=Path,
        metavar="FILE.zip",
        help="the executed schedule as OCPP 1.6 and 2.0.1 charging profiles, one a vehicle",
    )
    files.add_argument(
        "--pandapower",
        type=Path,
        metavar="FILE.json",
        help="the feeder with the executed loads as a pandapower network, all intervals within",
    )
    files.add_argument(
        "--run-zip",
        type=Path,
        metavar="FILE.zip",
        help="the run's folder as run --out writes it, to be audited and run again",
    )
    files.add_argument("--force", action="store_true", help="replace files that are there already")
    _add_conditions(command)
    command.set_defaults(command=export)


def _add_conditions(command: argparse.ArgumentParser) -> None:
    ageing = command.add_argument_group("what the report and the workbook assume")
    ageing.add_argument(
        "--transformer",
        default="",
        metavar="FROM-TO",
        help="the line that stands for the station's transformer (default: the rated one "
        "nearest to the station)",
    )
    ageing.add_argument(
        "--ambient",
        type=float,
        default=Thermal().ambient_c,
        metavar="C",
        help="ambient temperature of the transformer in °C (default: %(default)g)",
    )
    ageing.add_argument(
        "--worths",
        action="store_true",
        help="also tell what one more charger, a higher rating and a wider voltage band would "
        "have been worth: the day is run once more for each",
    )
    command.add_argument(
        "--at",
        default="",
        metavar="HH:MM",
        help="the time the pandapower network is loaded as (default: when the station draws most)",
    )
    command.add_argument(
        "--time-zone",
        default=DEFAULT_ZONE,
        metavar="ZONE",
        help="the time zone of the scenario's local times in OCPP profiles, such as "
        "Europe/Berlin (default: %(default)s)",
    )
    command.add_argument(
        "--amperes",
        default="",
        metavar="PHASESxVOLTS",
        help="give OCPP limits in A per phase, too, for outlets connected like this: 3x230, 1x240",
    )
    scenario = command.add_argument_group("how a scenario is run (not for an earlier run)")
    scenario.add_argument("--policy", metavar="NAME", help="who decides, as for run (default: p1)")
    scenario.add_argument(
        "--network",
        choices=["lindistflow", "ac"],
        help="model of the feeder whose limits are kept (default: lindistflow)",
    )
    scenario.add_argument("--seed", type=int, metavar="N", help="seed of the random arrivals")
    add_settings(scenario, "a key of scenario.toml, as for run; may be given again")
