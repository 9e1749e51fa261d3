"""`import`: data of one's own into a scenario folder."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from evdash.cli.import_profile import add_profile
from evdash.cli.import_sessions import add_sessions
from evdash.cli.into import into_command, into_folder
from evdash.cli.terminal import Terminal
from evdash.files.draft import Draft
from evdash.grid.nets.shipped import SHIPPED
from evdash.imports.sources import Imported, with_feeder_from, with_workbook_from
from evdash.imports.templates import write_templates

if TYPE_CHECKING:
    from evdash.cli.into import Commands


def import_feeder(draft: Draft, options: argparse.Namespace) -> Imported:
    """The draft on another feeder."""
    return with_feeder_from(draft, options.file, options.source, options.station)


def import_workbook(draft: Draft, options: argparse.Namespace) -> Imported:
    """The draft with every sheet of a scenario that a workbook has."""
    return with_workbook_from(draft, Path(options.file))


def list_networks(_: argparse.Namespace) -> int:
    """Print the networks pandapower ships that can be imported by name."""
    terminal = Terminal()
    for name, told in SHIPPED.items():
        terminal.say("  ", (f"{name:<31}", "bold"), f" {told}")
    return 0


def write_template(options: argparse.Namespace) -> int:
    """Write templates to fill in."""
    terminal = Terminal()
    for path in write_templates(options.where, options.force):
        terminal.say("  ", ("written", "bold green"), f" {path}")
    return 0


def add_import(commands: "Commands", statuses: str) -> None:
    """Put `import` and its own commands on the command line."""
    command = commands.add_parser(
        "import",
        help="bring in a feeder, sessions, prices or loads of your own",
        description="Bring data of your own into a scenario folder. docs/importing.md says by "
        "which rules. A folder is changed only if all of it is then a valid scenario.",
        epilog=statuses,
    )
    kinds = command.add_subparsers(title="what", required=True, metavar="WHAT")
    feeder = into_command(
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
    workbook = into_command(
        kinds,
        "workbook",
        "an Excel workbook of a scenario, or of a run",
        "WORKBOOK: an .xlsx with sheets named scenario, nodes, lines, profile, fleet, arrivals or "
        "events. Each replaces its own; what came of a run is left out.",
        statuses,
    )
    workbook.set_defaults(command=into_folder(import_workbook))
    add_sessions(kinds, statuses)
    add_profile(kinds, statuses)
    template = kinds.add_parser(
        "template",
        help="write templates to fill in",
        description="Write templates to fill in: a small scenario as a folder and as a workbook, "
        "and tables of sessions, prices and loads. Each is complete and runs as it is; units and "
        "what is allowed stand beside it.",
        epilog=statuses,
    )
    template.add_argument(
        "where", type=Path, metavar="WHERE", help="a new folder, or an .xlsx for the workbook alone"
    )
    template.add_argument("--force", action="store_true", help="replace files that are there")
    template.set_defaults(command=write_template)
    networks = kinds.add_parser(
        "networks",
        help="list the networks that pandapower ships",
        description="List the networks that pandapower ships and `import feeder` takes by name.",
        epilog=statuses,
    )
    networks.set_defaults(command=list_networks)
