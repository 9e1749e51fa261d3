"""`race`: several policies on the same day, their figures side by side."""

import argparse
from collections.abc import Mapping
from pathlib import Path

from rich.table import Table

from evdash.cli.options import SCENARIO, add_settings
from evdash.cli.terminal import Terminal, progress_bar
from evdash.errors import Fault, InputError
from evdash.files.bundled import DEFAULT, located
from evdash.files.exchange import Claim, output_folder
from evdash.files.overrides import Setting, parse_settings
from evdash.files.race_folder import is_race, write_race
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.inputs import prepare
from evdash.horizon.networks import NETWORKS
from evdash.policies.race import CONTESTANTS, Race, Told, race
from evdash.policies.race_words import race_sentences, race_table
from evdash.policies.registry import RULES, Rule, all_given

BROKEN = 3
TABLE_WIDTH = 132


def add_race(
    commands: "argparse._SubParsersAction[argparse.ArgumentParser]", statuses: str
) -> None:
    """The command and its options."""
    command = commands.add_parser(
        "race",
        help="race policies on the same day and compare what comes of it",
        description="Run the same scenario, arrivals and events once for each policy, and print "
        "their figures side by side; what knowing who will come is worth is told in $.",
        epilog=f"{statuses}, by a policy that is to keep them",
    )
    command.add_argument(
        "scenario",
        nargs="?",
        type=located,
        metavar="SCENARIO",
        help=SCENARIO,
    )
    command.add_argument("--seed", type=int, metavar="N", help="seed of the random arrivals")
    command.add_argument(
        "--policies",
        nargs="+",
        metavar="NAME",
        help=f"who takes part, of {', '.join(RULES)}, what installed packages offer, and "
        "module:function, one of your own (default: all of ours but p1-plain, which decides as "
        "p1 does and takes minutes)",
    )
    command.add_argument(
        "--network",
        choices=list(NETWORKS),
        default="lindistflow",
        help="model of the feeder whose limits are kept (default: lindistflow)",
    )
    add_settings(command, "a key of scenario.toml, as for run; may be given again")
    command.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="write policies.csv, intervals.csv and race.json to this folder",
    )
    command.add_argument(
        "--force", action="store_true", help="replace an earlier race in the --out folder"
    )
    command.set_defaults(command=run_race)


def run_race(options: argparse.Namespace) -> int:
    """Race; 3 if a policy that is to keep limits and promises broke one, 0 otherwise."""
    rules = all_given(options.policies or CONTESTANTS, "--policies")
    if options.out is None:
        return _raced(options, rules, None)
    with output_folder(options.out, "race", is_race, options.force) as claim:
        return _raced(options, rules, claim)


def _raced(options: argparse.Namespace, rules: Mapping[str, Rule], claim: Claim | None) -> int:
    settings = parse_settings(options.settings)
    if options.seed is not None:
        settings += (Setting("arrivals.seed", options.seed),)
    inputs = prepare(read_scenario(options.scenario or DEFAULT, settings), options.network)
    with progress_bar() as progress:
        task = progress.add_task("preparing", total=None)

        def told(now: Told) -> None:
            what = rules[now.policy].title
            progress.update(task, description=what, completed=now.done, total=now.total)

        found = race(inputs, rules, told, rules.__getitem__)
    if options.policies and found.absent:
        raise InputError(
            [Fault(f"--policies {name}", "cannot run", why) for name, why in found.absent.items()]
        )
    if claim is not None:
        write_race(claim, found)
    print_race(found, options.out)
    return BROKEN if any(not lap.is_sound for lap in found.laps) else 0


def print_race(found: Race, out: Path | None) -> None:
    """The race to standard output: figures down, policies across."""
    terminal = Terminal()
    terminal.width = max(terminal.width, TABLE_WIDTH)  # a piped table must not lose its figures
    terminal.print()
    began = f"  {found.start:%Y-%m-%d %H:%M}, {found.network}, seed {found.seed}"
    terminal.say((found.scenario, "bold"), began)
    table = Table(box=None, header_style="bold", pad_edge=False, padding=(0, 1))
    table.add_column("", no_wrap=True)
    for lap in found.laps:
        table.add_column(lap.policy, justify="right", no_wrap=True)
    for head, cells in race_table(found):
        table.add_row(head, *cells)
    terminal.print(table)
    for name, why in found.absent.items():
        terminal.say((f"{name} did not take part:", "yellow"), f" {why}")
    for sentence in race_sentences(found):
        terminal.say(sentence)
    if out is not None:
        terminal.say(f"written to {out}")
