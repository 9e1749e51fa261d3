"""The commands, their options and exit statuses."""

import argparse
import os
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path

from evdash import __version__
from evdash.cli.app import add_app
from evdash.cli.audit import audit
from evdash.cli.export import add_export
from evdash.cli.imports import add_import
from evdash.cli.options import SCENARIO, add_settings
from evdash.cli.race import add_race
from evdash.cli.run import run
from evdash.cli.study import add_study
from evdash.cli.terminal import Parser, Terminal, check_output
from evdash.cli.validate import validate
from evdash.errors import EvdashError, Fault, InputError
from evdash.files.bundled import located
from evdash.horizon.networks import NETWORKS

DONE, OWN_FAILURE, WRONG_INPUT, BROKEN = 0, 1, 2, 3
STATUSES = (
    "exit status: 0 done; 1 evdash itself failed; 2 wrong input or unreadable files; "
    "3 a promise or a limit was broken"
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; the exit status."""
    errors = Terminal(stderr=True)
    try:
        check_output()
        options = parser().parse_args(arguments)
        return int(options.command(options))
    except InputError as error:
        return _told(errors, error)
    except EvdashError as error:
        errors.say(("evdash failed:", "bold red"), f" {error}")
        return OWN_FAILURE
    except KeyboardInterrupt:
        errors.say("stopped; nothing was written")
        return OWN_FAILURE
    except Exception as error:  # noqa: BLE001 - the last resort: no traceback is ever shown
        if os.environ.get("EVDASH_TRACEBACK"):
            traceback.print_exc(file=sys.stderr)
        if isinstance(error, OSError) and error.filename is not None:
            return _told(errors, InputError([unusable(error)]))
        errors.say(("evdash failed:", "bold red"), f" {type(error).__name__}: {error}")
        errors.say("Set EVDASH_TRACEBACK=1 to see where.")
        return OWN_FAILURE


def _told(errors: Terminal, wrong: InputError) -> int:
    count = len(wrong.faults)
    errors.say((f"{count} fault{'s' if count != 1 else ''} in the input", "bold red"))
    for fault in wrong.faults:
        errors.say("  ", ("✗", "red"), f" {fault}")
    return WRONG_INPUT


def unusable(error: OSError) -> Fault:
    """A file or folder that the system refuses, as with a name that is too long."""
    found = f"what the system refuses ({error.strerror})"
    return Fault(f"{error.filename}", found, "should be a file or folder that can be used")


def parser() -> argparse.ArgumentParser:
    """The command line."""
    top: argparse.ArgumentParser = Parser(
        prog="evdash" if Path(sys.argv[0]).stem == "evdash" else "python -m evdash",
        description="Which electric vehicles can a charging station take on, hour by hour?",
        epilog=STATUSES,
    )
    top.add_argument("--version", action="version", version=f"evdash {__version__}")
    commands = top.add_subparsers(title="commands", required=True, metavar="COMMAND")
    add_app(commands, STATUSES)
    _add_run(commands)
    _add_validate(commands)
    _add_audit(commands)
    add_export(commands, STATUSES)
    add_import(commands, STATUSES)
    add_study(commands, STATUSES)
    add_race(commands, STATUSES)
    return top


def _add_run(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    command = commands.add_parser(
        "run",
        help="run a whole day and print what came of it",
        description="Run a scenario's whole horizon, interval by interval, and print its totals.",
        epilog=STATUSES,
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
        "--policy",
        default="p1",
        metavar="NAME",
        help="who decides: the paper's p1; p1-plain, the same solved as written, slower; "
        "bid-price, which anticipates; by rule, first come (fcfs), earliest deadline (edf) or "
        "least laxity (llf) first; uncoordinated, which keeps no limit; oracle, which knows who "
        "will come; a policy that an installed package offers; or module:function, one of your "
        "own as docs/policies.md tells (default: p1)",
    )
    command.add_argument(
        "--network",
        choices=list(NETWORKS),
        default="lindistflow",
        help="model of the feeder whose limits are kept: linearised DistFlow as in the paper, "
        "or full AC power flow (default: lindistflow)",
    )
    add_settings(
        command,
        "a key of scenario.toml, such as station.chargers=8 or "
        "option.C1.price_per_kwh=0.4; may be given again, the later wins",
    )
    command.add_argument(
        "--out", type=Path, metavar="DIR", help="write the run's files to this folder"
    )
    command.add_argument(
        "--force", action="store_true", help="replace an earlier run in the --out folder"
    )
    command.add_argument(
        "--explain",
        action="store_true",
        help="explain the day: every refusal and what would have avoided it, what more of each "
        "limit is worth, what binds when, what each step revised; in explanations.csv, worths.csv, "
        "binding.csv and revisions.csv of the --out folder, or printed without one",
    )
    command.set_defaults(command=run)


def _add_validate(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    command = commands.add_parser(
        "validate",
        help="check a scenario and list every fault",
        description="Check a scenario as a whole: says ok, or lists every fault.",
        epilog=STATUSES,
    )
    command.add_argument("scenario", type=located, metavar="SCENARIO", help="a folder or a .zip")
    command.set_defaults(command=validate)


def _add_audit(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    command = commands.add_parser(
        "audit",
        help="check a run's files again by other means",
        description="Hold a run's files against its scenario with the independent checker and "
        "the AC power flow.",
        epilog=STATUSES,
    )
    command.add_argument("directory", type=Path, metavar="DIR", help="folder of an earlier run")
    command.add_argument(
        "--optimum",
        action="store_true",
        help="also prove P1's optimum anew at every interval, by the plain formulation, and hold "
        "objective, bound and status against it; seconds to minutes",
    )
    command.set_defaults(command=audit)
