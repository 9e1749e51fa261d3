"""A study's folder: its file and base scenario, the results, and the tables made of them."""

import json
import os
from dataclasses import dataclass
from pathlib import Path

import tomlkit
from filelock import FileLock, Timeout

from evdash.domain.study import Result, Study, StudyRuns
from evdash.errors import EvdashError, Fault, InputError
from evdash.files.exchange import refuse_inside_scenario, resolved, unwritable
from evdash.files.run_export import versions
from evdash.files.scenario_folder import FILE_NAMES, scenario_files
from evdash.studies.code import code_version
from evdash.studies.reading import read_study
from evdash.studies.results import Results
from evdash.studies.tables import (
    Found,
    bands,
    bands_table,
    csv_text,
    reference_bands,
    runs_table,
)

STUDY, SCENARIO, RESULTS = "study.toml", "scenario", "results.sqlite3"
RUNS, SUMMARY, DIFFERENCES = "runs.csv", "summary.csv", "differences.csv"
ABOUT, LOCK = "about.json", "running.lock"


class Busy(EvdashError):
    """Another process is just running the study of this folder."""


@dataclass(frozen=True, slots=True)
class StudyFolder:
    """The folder a study lives in; everything in it can be made again but `results.sqlite3`."""

    path: Path

    @property
    def results(self) -> Results:
        return Results(self.path / RESULTS)

    def lock(self, patience_seconds: float = 2.0) -> FileLock:
        """Held by the process that runs the study; gone with it, however it ends."""
        return FileLock(self.path / LOCK, timeout=patience_seconds)

    @property
    def is_running(self) -> bool:
        """Whether some process is at it."""
        if not (self.path / LOCK).exists():
            return False
        try:
            with self.lock(0):
                return False
        except Timeout:
            return True

    def make(self) -> None:
        """Make the folder, or refuse a place that cannot or must not be written to."""
        place = f"--out {self.path}"
        refuse_inside_scenario(self.path, place)
        target = resolved(self.path, place)
        try:
            target.mkdir(parents=True, exist_ok=True)
            there = {path.name for path in target.iterdir()} - {LOCK}
        except OSError as error:
            raise unwritable(place, error) from error
        if there and not (target / RESULTS).is_file():
            rule = "should be new, empty, or an earlier study's"
            raise InputError([Fault(place, "a folder with other things in it", rule)])

    def begin(self, runs: StudyRuns) -> None:
        """Keep the study and its base scenario, so that it can be resumed from here alone."""
        given = scenario_files(runs.given)
        try:
            (self.path / SCENARIO).mkdir(parents=True, exist_ok=True)
            self.results.make()  # first: by it the folder is known as a study's
            for name in set(FILE_NAMES) - set(given):
                (self.path / SCENARIO / name).unlink(missing_ok=True)
            for name, text in given.items():
                _replace(self.path / SCENARIO / name, text)
            here = runs.study.model_copy(update={"base": SCENARIO})
            _replace(self.path / STUDY, study_text(here))
        except OSError as error:
            raise unwritable(f"--out {self.path}", error) from error

    def read(self, own: tuple[str, ...] = ()) -> StudyRuns:
        """The study kept here; with policies given by hand, as `read_study`."""
        return read_study(self.path / STUDY, own)

    def found(self, runs: StudyRuns) -> Found:
        """The study's runs with what has been found so far."""
        return Found(runs, self.results.read(run.key for run in runs.runs))

    def write_tables(self, found: Found) -> None:
        """Write the tables of what has been found so far."""
        tables = {
            RUNS: csv_text(runs_table(found)),
            SUMMARY: csv_text(bands_table(found, bands(found))),
            DIFFERENCES: csv_text(bands_table(found, reference_bands(found))),
            ABOUT: json.dumps(about(found), indent=2) + "\n",
        }
        try:
            for name, text in tables.items():
                _replace(self.path / name, text)
        except OSError as error:
            raise EvdashError(f"{self.path}: the tables could not be written ({error})") from error


def about(found: Found) -> dict[str, object]:
    """Circumstances of a study; nothing that differs between machines of the same kind."""
    results: list[Result] = list(found.results.values())
    return {
        "format": "evdash study 1",
        "name": found.runs.study.name,
        "runs": len(found.runs.runs),
        "done": sum(result.status == "done" for result in results),
        "failed": sum(result.status == "failed" for result in results),
        "code": code_version(),
        "versions": versions(),
    }


def study_text(study: Study) -> str:
    """A study as its file's text; reading it gives the same study."""
    told = study.model_dump(exclude_none=True)
    told["axis"] = [
        {key: value for key, value in axis.items() if value not in ((), [], {}, None)}
        for axis in told["axis"]
    ]
    for axis in told["axis"]:
        if "case" in axis:
            axis["case"] = [dict(case) for case in axis["case"]]
    filled = {key: value for key, value in told.items() if value not in ((), [], {}, "")}
    return tomlkit.dumps(filled)


def _replace(path: Path, text: str) -> None:
    """Write a file as a whole or not at all."""
    beside = path.with_name(f".{path.name}.part")
    beside.write_text(text, encoding="utf-8", newline="")
    os.replace(beside, path)
