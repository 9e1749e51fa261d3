"""`import sessions`: recorded sessions as the vehicles that arrive."""

import argparse
from datetime import date
from typing import TYPE_CHECKING

from evdash.cli.into import (
    add_table_options,
    into_command,
    into_folder,
    mapped_text,
    number_pair,
    table_with_columns,
)
from evdash.files.draft import Draft
from evdash.imports.clock import Reading
from evdash.imports.session_columns import FIELDS, REQUIRED, proposed
from evdash.imports.session_rows import HOURS, SessionRules
from evdash.imports.sessions import with_sessions
from evdash.imports.sources import Imported

if TYPE_CHECKING:
    from evdash.cli.into import Commands


def import_sessions(draft: Draft, options: argparse.Namespace) -> Imported:
    """The draft with recorded sessions for arrivals, once their columns are confirmed."""
    table, columns = table_with_columns(options, proposed, list(FIELDS), set(REQUIRED).issubset)
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
        option_share=dict(number_pair("--option-share", text) for text in options.shares),
        seed=options.seed,
    )
    changed, told = with_sessions(draft, table, rules)
    return Imported(changed, (mapped_text(columns), *told))


def add_sessions(kinds: "Commands", statuses: str) -> None:
    """Put `import sessions` on the command line."""
    command = into_command(
        kinds,
        "sessions",
        "recorded sessions, as the vehicles that arrive",
        "SESSIONS: ACN-Data's JSON, or a table of sessions as .csv, .xlsx or JSON records. The "
        "columns' meaning is proposed; it counts once confirmed.",
        statuses,
    )
    add_table_options(command, list(FIELDS))
    add = command.add_argument
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
