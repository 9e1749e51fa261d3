"""`import`: data of one's own into a scenario folder."""

import argparse
from collections.abc import Callable
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.markup import escape

from evdash.errors import Fault, InputError
from evdash.files.bundled import DEFAULT
from evdash.files.draft import Draft
from evdash.files.overrides import parse_settings
from evdash.grid.nets.shipped import SHIPPED
from evdash.imports.clock import Reading
from evdash.imports.folder import draft_in, with_overrides, write_draft
from evdash.imports.session_columns import FIELDS, REQUIRED, proposed
from evdash.imports.sessions import HOURS, SessionRules, with_sessions
from evdash.imports.sources import read_bounded, sheet_faults, with_feeder_from
from evdash.imports.tables import read_foreign

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


def import_sessions(draft: Draft, options: argparse.Namespace) -> tuple[Draft, tuple[str, ...]]:
    """The draft with recorded sessions for arrivals, once their columns are confirmed."""
    path = Path(options.file)
    table = read_foreign(path.name, read_bounded(path), options.sheet)
    given = dict(_pair("--column", text) for text in options.columns)
    columns = proposed(table.columns) | given
    if not options.accept and not set(REQUIRED) <= set(given):
        found = ", ".join(f"{field}={column}" for field, column in columns.items())
        rule = (
            f"confirm with --accept, or name columns with --column FIELD=COLUMN; columns are "
            f"{', '.join(table.columns)}; fields are {', '.join(FIELDS)}"
        )
        raise InputError([Fault(f"{path.name}, columns", f"proposed {found or 'none'}", rule)])
    rules = SessionRules(
        columns=columns,
        reading=Reading(options.zone, options.day_first),
        duration_unit=options.duration_unit,
        time_unit=options.time_unit,
        origin=options.origin,
        first_day=options.first_day,
        days=options.days,
        battery_kwh=options.battery_kwh,
        soc_out=options.soc_out,
        option_share={key: _share(value) for key, value in map(_share_pair, options.shares)},
        seed=options.seed,
    )
    changed, told = with_sessions(draft, table, rules)
    mapped = ", ".join(f"{field} from {column}" for field, column in columns.items() if column)
    return changed, (f"Columns: {mapped}.", *told)


def _pair(option: str, text: str) -> tuple[str, str]:
    key, equals, value = text.partition("=")
    if not equals:
        raise InputError([Fault(option, repr(text), "should be NAME=VALUE")])
    return key.strip(), value.strip()


def _share_pair(text: str) -> tuple[str, str]:
    return _pair("--option-share", text)


def _share(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError([Fault("--option-share", repr(text), "should be a number")]) from None


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
        help="bring in a feeder or sessions of your own",
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
    _add_sessions(kinds, statuses)
    networks = kinds.add_parser(
        "networks",
        help="list the networks that pandapower ships",
        description="List the networks that pandapower ships and `import feeder` takes by name.",
        epilog=statuses,
    )
    networks.set_defaults(command=list_networks)


def _add_sessions(kinds: "Commands", statuses: str) -> None:
    command = _into(
        kinds,
        "sessions",
        "recorded sessions, as the vehicles that arrive",
        "SESSIONS: ACN-Data's JSON, or a table of sessions as .csv, .xlsx or JSON records. The "
        "columns' meaning is proposed; it counts once confirmed.",
        statuses,
    )
    add = command.add_argument
    add("--accept", action="store_true", help="confirm the proposed columns")
    told = f"take FIELD from COLUMN (blank: from none); fields: {', '.join(FIELDS)}"
    add("--column", action="append", default=[], dest="columns", metavar="FIELD=COLUMN", help=told)
    add("--sheet", help="sheet of a workbook")
    add("--zone", help="time zone of the station, such as America/Los_Angeles")
    add("--day-first", action="store_true", default=None, help="3/4/2019 is 3 April")
    add("--month-first", action="store_false", dest="day_first", help="3/4/2019 is 4 March")
    add("--from", type=date.fromisoformat, dest="first_day", metavar="DATE", help="first day")
    add("--days", type=int, metavar="N", help="how many days, 1 to 31 (default: all there are)")
    add("--battery-kwh", type=float, default=60.0, help="battery where none is given (60)")
    add("--soc-out", type=float, default=0.9, help="charge on leaving where none is given (0.9)")
    told = "draw options by shares with sum 1 (default: by each session's average power)"
    add(
        "--option-share",
        action="append",
        default=[],
        dest="shares",
        metavar="NAME=SHARE",
        help=told,
    )
    add("--seed", type=int, default=1, help="seed of drawn options (1)")
    add("--duration-unit", choices=list(HOURS), default="h", help="unit of durations (h)")
    add("--time-unit", choices=list(HOURS), default="h", help="unit of times in numbers (h)")
    add(
        "--origin",
        type=date.fromisoformat,
        metavar="DATE",
        help="day that times in numbers count from",
    )
    command.set_defaults(command=into_folder(import_sessions))


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
