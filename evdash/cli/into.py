"""What all imports have in common: a scenario folder that is changed as a whole or not at all."""

import argparse
from collections.abc import Callable, Mapping, Sequence
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING

from evdash.cli.options import add_settings
from evdash.cli.terminal import Terminal
from evdash.errors import Fault, InputError
from evdash.files.bundled import DEFAULT, located
from evdash.files.draft import Draft
from evdash.files.overrides import parse_settings
from evdash.imports.folder import draft_in, with_overrides, write_draft
from evdash.imports.sources import Imported, read_bounded
from evdash.imports.tables import ForeignTable, read_foreign

if TYPE_CHECKING:
    Commands = argparse._SubParsersAction[argparse.ArgumentParser]
Change = Callable[[Draft, argparse.Namespace], Imported]


def into_folder(change: Change) -> Callable[[argparse.Namespace], int]:
    """A command that changes a scenario folder, or leaves it as it was and tells every fault."""

    def command(options: argparse.Namespace) -> int:
        imported = change(draft_in(options.into, options.base), options)
        settings = parse_settings(options.settings)
        try:
            write_draft(options.into, with_overrides(imported.draft, settings))
        except InputError as error:
            raise imported.placed(error) from None
        terminal = Terminal()
        for notice in imported.told:
            terminal.say(f"  {notice}")
        terminal.say(("written to", "bold green"), f" {options.into}")
        return 0

    return command


def pair(option: str, text: str) -> tuple[str, str]:
    """NAME=VALUE as typed for an option."""
    key, equals, value = text.partition("=")
    if not equals:
        raise InputError([Fault(option, repr(text), "should be NAME=VALUE")])
    return key.strip(), value.strip()


def number_pair(option: str, text: str) -> tuple[str, float]:
    """NAME=NUMBER as typed for an option."""
    key, value = pair(option, text)
    try:
        return key, float(value)
    except ValueError:
        raise InputError([Fault(option, repr(text), "should be NAME=NUMBER")]) from None


def table_with_columns(
    options: argparse.Namespace,
    proposed: Callable[[Sequence[str]], Mapping[str, str]],
    fields: Sequence[str],
    enough: Callable[[Mapping[str, str]], bool],
) -> tuple[ForeignTable, dict[str, str]]:
    """The table a command names, and the column of each field.

    Raises InputError unless the proposal was accepted or the columns named are `enough`.
    """
    path = Path(options.file)
    table = read_foreign(path.name, read_bounded(path), options.sheet)
    given = dict(pair("--column", text) for text in options.columns)
    known = {f: column for f, column in proposed(table.columns).items() if f in fields}
    columns = known | given
    if not options.accept and not enough(given):
        _refuse_unconfirmed(path.name, columns, table.columns, fields)
    return table, columns


def _refuse_unconfirmed(
    place: str, columns: Mapping[str, str], known: Sequence[str], fields: Sequence[str]
) -> None:
    found = ", ".join(f"{field}={column}" for field, column in columns.items())
    rule = (
        "confirm with --accept, or name columns with --column FIELD=COLUMN; columns are "
        f"{', '.join(known)}; fields are {', '.join(fields)}"
    )
    raise InputError([Fault(f"{place}, columns", f"proposed {found or 'none'}", rule)])


def mapped_text(columns: Mapping[str, str]) -> str:
    """Which column each field is taken from."""
    mapped = ", ".join(f"{field} from {column}" for field, column in columns.items() if column)
    return f"Columns: {mapped}."


def into_command(
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
        type=located,
        default=DEFAULT,
        metavar="SCENARIO",
        help="scenario a new folder begins from (default: the bundled day)",
    )
    add_settings(command, "a key of scenario.toml to set along with it; may be given again")
    return command


def add_table_options(command: argparse.ArgumentParser, fields: Sequence[str]) -> None:
    """Options of a command that reads a table of any columns with times in it."""
    add = command.add_argument
    add("--accept", action="store_true", help="confirm the proposed columns")
    told = f"take FIELD from COLUMN (blank: from none); fields: {', '.join(fields)}"
    add("--column", action="append", default=[], dest="columns", metavar="FIELD=COLUMN", help=told)
    add("--sheet", help="sheet of a workbook")
    add("--zone", help="time zone of the station, such as America/Los_Angeles")
    add("--day-first", action="store_true", default=None, help="3/4/2019 is 3 April")
    add("--month-first", action="store_false", dest="day_first", help="3/4/2019 is 4 March")
    add("--from", type=date.fromisoformat, dest="first_day", metavar="DATE", help="first day")
