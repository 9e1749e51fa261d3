"""`import`: data of one's own into a scenario folder."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.markup import escape

from evdash.errors import InputError
from evdash.files.bundled import DEFAULT
from evdash.files.draft import Draft
from evdash.files.overrides import parse_settings
from evdash.grid.nets.shipped import SHIPPED
from evdash.imports.folder import draft_in, with_overrides, write_draft
from evdash.imports.sources import sheet_faults, with_feeder_from

if TYPE_CHECKING:
    Commands = argparse._SubParsersAction[argparse.ArgumentParser]
Change = Callable[[Draft, argparse.Namespace], tuple[Draft, tuple[str, ...]]]


def into_folder(change: Change) -> Callable[[argparse.Namespace], int]:
    """A command that changes a scenario folder, or leaves it as it was and tells every fault."""

    def command(options: argparse.Namespace) -> int:
        draft, told = change(draft_in(options.into, options.base), options)
        try:
            write_draft(options.into, with_overrides(draft, parse_settings(options.settings)))
        except InputError as error:
            raise sheet_faults(str(options.file), error) from None
        console = Console(highlight=False)
        for notice in told:
            console.print(f"  {escape(notice)}", soft_wrap=True)
        console.print(f"[bold green]written to[/] {escape(str(options.into))}", soft_wrap=True)
        return 0

    return command


def import_feeder(draft: Draft, options: argparse.Namespace) -> tuple[Draft, tuple[str, ...]]:
    """The draft on another feeder."""
    return with_feeder_from(draft, options.file, options.source, options.station)


def list_networks(_: argparse.Namespace) -> int:
    """Print the networks pandapower ships that can be imported by name."""
    console = Console(highlight=False)
    for name, told in SHIPPED.items():
        console.print(f"  [bold]{name:<31}[/] {escape(told)}", soft_wrap=True)
    return 0


def add_import(commands: "Commands", statuses: str) -> None:
    """Put `import` and its own commands on the command line."""
    command = commands.add_parser(
        "import",
        help="bring in a feeder, prices, loads or sessions of your own",
        description="Bring data of your own into a scenario folder. docs/importing.md says by "
        "which rules. A folder is changed only if all of it is then a valid scenario.",
        epilog=statuses,
    )
    kinds = command.add_subparsers(title="what", required=True, metavar="WHAT")
    feeder = _into(
        kinds,
        "feeder",
        "a network: nodes, lines and voltages",
        "FEEDER: a pandapower .json, a scenario folder, a .zip or .xlsx of one, or the name of a "
        "network that pandapower ships (see `import networks`).",
        statuses,
    )
    feeder.add_argument("--source", metavar="BUS", help="the supply, where the file has several")
    feeder.add_argument("--station", metavar="NODE", help="the node the charging station is at")
    feeder.set_defaults(command=into_folder(import_feeder))
    networks = kinds.add_parser(
        "networks",
        help="list the networks that pandapower ships",
        description="List the networks that pandapower ships and `import feeder` takes by name.",
        epilog=statuses,
    )
    networks.set_defaults(command=list_networks)


def _into(
    kinds: "Commands", name: str, brief: str, told: str, statuses: str
) -> argparse.ArgumentParser:
    """A command that takes a file into a folder, with what all of them have in common."""
    command = kinds.add_parser(name, help=brief, description=told, epilog=statuses)
    command.add_argument("file", metavar=name.upper(), help="what to bring in")
    command.add_argument(
        "--into",
        type=Path,
        required=True,
        metavar="DIR",
        help="scenario folder to change; begun from --base if it is not there yet",
    )
    command.add_argument(
        "--base",
        type=Path,
        default=DEFAULT,
        metavar="SCENARIO",
        help="scenario a new folder begins from (default: the bundled day)",
    )
    command.add_argument(
        "--set",
        action="append",
        default=[],
        dest="settings",
        metavar="KEY=VALUE",
        help="a key of scenario.toml to set along with it; may be given again",
    )
    return command
