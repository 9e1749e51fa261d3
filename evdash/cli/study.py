"""`study`: many days, their tables, and what they show in a summary."""

import argparse
from collections import Counter
from pathlib import Path

from filelock import Timeout
from rich.table import Table

from evdash.cli.terminal import Terminal, progress_bar
from evdash.domain.study import Band
from evdash.files.bundled import located_study
from evdash.policies.registry import all_given
from evdash.studies.beyond import beyond_told
from evdash.studies.crew import Crew
from evdash.studies.engine import Progress as Stand
from evdash.studies.engine import run_study
from evdash.studies.folder import STUDY, SUMMARY, Busy, StudyFolder
from evdash.studies.measures import MEASURES
from evdash.studies.reading import read_study
from evdash.studies.tables import Found, bands

FAILED, DONE = 1, 0
SHOWN_GROUPS, SHOWN_METRICS, SHOWN_REASONS = 30, 3, 5


def add_study(
    commands: "argparse._SubParsersAction[argparse.ArgumentParser]", statuses: str
) -> None:
    """The command and its options."""
    command = commands.add_parser(
        "study",
        help="run many days and put what they show into tables",
        description="Run a study: the same day with many seeds, settings, policies or network "
        "models. Results land one by one in the --out folder; the same command resumes a study "
        "that was stopped, and runs only what is new in one that was changed.",
        epilog=statuses,
    )
    command.add_argument(
        "study",
        type=located_study,
        metavar="FILE",
        help="a study file, .toml, or the name of a bundled one, such as how-many-chargers",
    )
    command.add_argument(
        "--out", type=Path, metavar="DIR", required=True, help="folder of results and tables"
    )
    command.add_argument(
        "--policies",
        nargs="+",
        default=[],
        metavar="NAME",
        help="who decides, in place of those the file names: of ours, what installed packages "
        "offer, and module:function, one of your own, which counts only where it is given here",
    )
    command.add_argument(
        "--workers", type=_workers, default=0, metavar="N", help="processes (default: one a core)"
    )
    command.add_argument(
        "--scheduler",
        default="",
        metavar="ADDRESS",
        help="run on the workers of this Dask scheduler instead, tcp://host:8786",
    )
    command.add_argument(
        "--retry", action="store_true", help="try the runs again that have failed before"
    )
    command.set_defaults(command=study)


def _workers(text: str) -> int:
    count = int(text)
    if count < 1:
        raise argparse.ArgumentTypeError("should be at least 1")
    return count


def study(options: argparse.Namespace) -> int:
    """Run or resume a study; 1 if it was stopped or any of its runs failed, 0 otherwise."""
    own = tuple(all_given(options.policies, "--policies"))
    runs = read_study(options.study, own)
    folder = StudyFolder(options.out)
    folder.make()
    try:
        with folder.lock():
            if options.study.resolve() != (folder.path / STUDY).resolve():
                folder.begin(runs)
            if options.retry:
                folder.results.forget_failed()
            stopped = _run(folder, own, options)
            found = folder.found(runs)
            folder.write_tables(found)
    except Timeout as error:
        raise Busy(f"{options.out}: another process is running this study") from error
    _report(found, folder)
    if stopped:
        Terminal(stderr=True).say("stopped; the same command goes on with what is left")
    failed = any(result.status == "failed" for result in found.results.values())
    return FAILED if stopped or failed else DONE


def _run(folder: StudyFolder, own: tuple[str, ...], options: argparse.Namespace) -> bool:
    """Run what is left, with progress on stderr; whether it was stopped before its end."""
    runs = folder.read(own)
    with progress_bar() as progress:
        task = progress.add_task("running", total=len(runs.runs))

        def told(now: Stand) -> None:
            failed = f", {now.failed} failed" if now.failed else ""
            progress.update(
                task, total=now.total, completed=now.ended, description=f"running{failed}"
            )

        try:
            run_study(runs, folder.results, Crew(options.workers, options.scheduler), told)
        except KeyboardInterrupt:
            return True
    return False


def _report(found: Found, folder: StudyFolder) -> None:
    """The bands of the first metrics, failures by reason, and where the tables are."""
    terminal = Terminal()
    study = found.runs.study
    terminal.say((study.name, "bold"), f"  {study.question}")
    rows = bands(found)
    groups = list(dict.fromkeys(band.group for band in rows))
    terminal.print(_table(found, rows, groups[:SHOWN_GROUPS]))
    if len(groups) > SHOWN_GROUPS:
        terminal.say(f"and {len(groups) - SHOWN_GROUPS} more in {SUMMARY}")
    if any(band.days > 1 for band in rows):
        terminal.say(("median (5 % to 95 % of days)", "dim"))
    if beyond := beyond_told(found):
        terminal.say((f"over all, {beyond}", "bold red"))
    _failures(terminal, found)
    terminal.say(f"written to {folder.path}")


def _table(found: Found, rows: list[Band], groups: list[tuple[object, ...]]) -> Table:
    """A row a group; what all groups have in common is left out."""
    names = (*found.runs.axes, "policy", "network")
    told = [i for i in range(len(names)) if len({group[i] for group in groups}) > 1]
    metrics = found.metrics[:SHOWN_METRICS]
    table = Table(box=None, header_style="dim", pad_edge=False)
    for i in told:
        table.add_column(names[i])
    for metric in metrics:
        table.add_column(MEASURES[metric].head, justify="right")
    by_cell = {(band.group, band.metric): band for band in rows}
    for group in groups:
        cells = [_told(by_cell.get((group, metric))) for metric in metrics]
        table.add_row(*(f"{group[i]}" for i in told), *cells)
    return table


def _told(band: Band | None) -> str:
    if band is None:
        return "–"
    tell = MEASURES[band.metric].told
    spread = f" ({tell(band.p05)} to {tell(band.p95)})" if band.days > 1 else ""
    return tell(band.p50) + spread


def _failures(terminal: Terminal, found: Found) -> None:
    reasons = Counter(r.reason for r in found.results.values() if r.status == "failed")
    for reason, count in reasons.most_common(SHOWN_REASONS):
        terminal.say((f"{count} runs failed:", "bold red"), f" {reason}")
    if len(reasons) > SHOWN_REASONS:
        terminal.say(f"    and for {len(reasons) - SHOWN_REASONS} more reasons, in runs.csv")
    missing = len({run.key for run in found.runs.runs} - set(found.results))
    if missing:
        terminal.say((f"{missing} runs are still to come", "yellow"))
