"""`import prices` and `import loads`: values by date and time as the scenario's profile."""

import argparse
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from evdash.cli.into import (
    add_table_options,
    into_command,
    into_folder,
    mapped_text,
    number_pair,
    pair,
    table_with_columns,
)
from evdash.files.draft import Draft
from evdash.imports.clock import Reading
from evdash.imports.profile import ProfileRules, with_profile
from evdash.imports.profile_columns import UNITS, proposed, proposed_unit
from evdash.imports.sources import Imported

if TYPE_CHECKING:
    from evdash.cli.into import Commands

TIME = "time"
PRICES = (TIME, "price")
LOADS = (TIME, "load", "generation")


def import_profile(fields: Sequence[str], draft: Draft, options: argparse.Namespace) -> Imported:
    """The draft with a table's values of `fields`, once their columns are confirmed."""
    table, columns = table_with_columns(
        options, proposed, fields, lambda given: TIME in given and len(given) > 1
    )
    units = {f: proposed_unit(f, c) for f, c in columns.items() if f in UNITS and c}
    units |= dict(pair("--unit", text) for text in options.units)
    rules = ProfileRules(
        columns=columns,
        units={field: unit for field, unit in units.items() if unit is not None},
        reading=Reading(options.zone, options.day_first),
        peak_kw=dict(number_pair("--peak-kw", text) for text in options.peaks),
        first_day=options.first_day,
        days=options.days,
        hold_minutes=options.hold,
        at_end=options.at_end,
    )
    changed, told = with_profile(draft, table, rules)
    return Imported(changed, (mapped_text(columns), *told))


def add_profile(kinds: "Commands", statuses: str) -> None:
    """Put `import prices` and `import loads` on the command line."""
    _add(kinds, "prices", "energy prices by date and time", PRICES, statuses)
    loads = _add(kinds, "loads", "loads and generation by date and time", LOADS, statuses)
    loads.add_argument(
        "--peak-kw",
        action="append",
        default=[],
        dest="peaks",
        metavar="FIELD=KW",
        help="peak that kW or MW are divided by (default: the table's own)",
    )


def _add(
    kinds: "Commands", name: str, brief: str, fields: Sequence[str], statuses: str
) -> argparse.ArgumentParser:
    command = into_command(
        kinds,
        name,
        brief,
        f"{name.upper()}: a table as .csv, .xlsx or JSON records, with a column of times. An "
        "interval has the time-weighted mean of the values that hold in it. The columns' meaning "
        "is proposed; it counts once confirmed.",
        statuses,
    )
    add_table_options(command, fields)
    add = command.add_argument
    units = "; ".join(f"{f} in {', '.join(UNITS[f])}" for f in fields if f in UNITS)
    told = f"unit, where the column's name does not end on it: {units}"
    add("--unit", action="append", default=[], dest="units", metavar="FIELD=UNIT", help=told)
    add("--days", type=int, metavar="N", help="how many days (default: as the scenario has)")
    told = "how many minutes a value holds at most (default: the table's usual step)"
    add("--hold", type=float, metavar="MIN", help=told)
    told = "times are the ends of what they stand for, as in hour ending"
    add("--at-end", action="store_true", help=told)
    command.set_defaults(command=into_folder(partial(import_profile, tuple(fields))), peaks=[])
    return command
