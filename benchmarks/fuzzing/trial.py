"""What is done with an input, and whether what came of it is allowed.

Allowed is a refusal in words or a right run: a day that keeps every promise and limit and whose
files the audit passes. Everything else is told as what it is.
"""

import io
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from benchmarks.soundness import problems_of_day
from evdash.audit.audit import audit_run
from evdash.domain.arrivals import RecordedArrivals
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.errors import Fault, InputError
from evdash.files.draft import files_of, read_draft, scenario_of
from evdash.files.exchange import output_folder
from evdash.files.folder import read_zip
from evdash.files.overrides import parse_settings
from evdash.files.run_export import RunLabel, judge, run_files
from evdash.files.run_folder import is_run, write_run
from evdash.files.scenario_folder import parse_scenario, scenario_files
from evdash.horizon.day import run_day, start_day
from evdash.horizon.inputs import prepare
from evdash.metrics.breaches import linear_breaches
from evdash.scheduling.p1 import p1_policy

REFUSED, RAN, LARGE, WRONG = "refused", "ran", "right, too large to run here", "WRONG"
ALLOWED = (REFUSED, RAN, LARGE)
MOST_INTERVALS, MOST_VEHICLES, MOST_NODES = 12, 30, 60
PREPARED_VEHICLES = 2_000
LONGEST_FAULT = 2_000


@dataclass(frozen=True, slots=True)
class Outcome:
    """How an input was answered, and what is wrong with that, if anything."""

    kind: str
    problem: str = ""


def tried(act: Callable[[], Scenario | None]) -> Outcome:
    """What `act` makes of its input: a scenario to run, None for something else that is right."""
    try:
        scenario = act()
    except InputError as error:
        return refusal(error)
    return Outcome(RAN) if scenario is None else run(scenario)


def refusal(error: InputError) -> Outcome:
    """Whether a refusal can be read: every fault says where, what and what is allowed."""
    if not error.faults:
        return Outcome(WRONG, "refused without a fault")
    if len(error.faults) < 100 and len(set(error.faults)) < len(error.faults):
        return Outcome(WRONG, f"the same fault twice: {error.faults}"[:300])
    for fault in error.faults:
        if problem := _unreadable(fault):
            return Outcome(WRONG, f"{problem}: {str(fault)[:300]!r}")
    return Outcome(REFUSED)


def _unreadable(fault: Fault) -> str:
    text = str(fault)
    if not (fault.place and fault.found and fault.allowed):
        return "a fault without place, finding or rule"
    if len(text) > LONGEST_FAULT:
        return f"a fault of {len(text)} characters"
    if "Traceback" in text or " object at 0x" in text:
        return "a fault in the program's own words"
    try:
        text.encode()
    except UnicodeEncodeError:
        return "a fault that cannot be written"
    return ""


def run(scenario: Scenario) -> Outcome:
    """Read what was written of it back, then run the day and check it."""
    again = parse_scenario({k: v.encode() for k, v in scenario_files(scenario).items()})
    if again != scenario:
        return Outcome(WRONG, "what was written of it reads back as something else")
    vehicles = _expected_vehicles(scenario)
    if vehicles > PREPARED_VEHICLES:
        return Outcome(LARGE)
    if (
        scenario.intervals > MOST_INTERVALS
        or len(scenario.nodes) > MOST_NODES
        or vehicles > MOST_VEHICLES
    ):
        prepare(scenario)
        return Outcome(LARGE)
    try:
        trace = run_day(start_day(scenario), p1_policy())
    except InputError as error:
        return refusal(error)
    problems = list(_problems(trace))
    return Outcome(WRONG, "; ".join(problems[:3])) if problems else Outcome(RAN)


def _expected_vehicles(scenario: Scenario) -> float:
    known = scenario.arrivals
    if isinstance(known, RecordedArrivals):
        return len(known.vehicles)
    return known.vehicles_per_day * scenario.arrivals_end * scenario.interval_hours / 24


def _problems(trace: Trace) -> Iterator[str]:
    happened = bool(trace.inputs.given.events)
    if not happened:
        yield from problems_of_day(trace)
    verdict = judge(trace, linear_breaches(trace))
    if not happened and verdict.broken_by_station("lindistflow"):
        yield f"a limit worsened: {verdict.broken_by_station('lindistflow')[0]}"
    files = run_files(
        trace, verdict, RunLabel("p1", "lindistflow", trace.scenario.arrivals.seed, 0.0)
    )
    with tempfile.TemporaryDirectory() as place:
        with output_folder(Path(place) / "run", "run", is_run, force=True) as claim:
            write_run(claim, files)
        for finding in audit_run(Path(place) / "run").findings:
            if not (happened and "a broken promise" in finding):
                yield f"audit: {finding}"


def folder(files: dict[str, bytes]) -> Outcome:
    """A scenario folder, as the command line takes it."""
    return tried(lambda: parse_scenario(files))


def draft(files: dict[str, bytes]) -> Outcome:
    """The same files as the Scenario page takes them: a draft, checked, written out again."""

    def act() -> Scenario:
        taken = read_draft(files)
        files_of(taken)
        return scenario_of(taken)

    return tried(act)


def archive(content: bytes) -> Outcome:
    """A .zip."""
    return tried(lambda: parse_scenario(read_zip(io.BytesIO(content), "upload.zip")))


def settings(given: tuple[dict[str, bytes], list[str]]) -> Outcome:
    """A right folder with settings laid over it."""
    files, texts = given
    return tried(lambda: parse_scenario(files, parse_settings(texts)))
