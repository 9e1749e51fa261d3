"""A small day and small studies of it."""

import csv
import io
from pathlib import Path

from evdash.domain.scenario import Scenario
from evdash.files.scenario_folder import scenario_files
from evdash.studies.crew import Crew
from evdash.studies.engine import run_study
from evdash.studies.folder import StudyFolder
from evdash.studies.reading import read_study
from evdash.studies.work import Task, work
from tests.builders import generator, line, make_scenario, node

STUDY = """
format = 1
name = "small"
base = "base"
referee_every = 0
metrics = ["profit", "admitted", "least_headroom_kw", "tightest", "lowest_ac_pu", "ac_losses_kwh"]

[seeds]
first = 3
count = {count}

[[axis]]
key = "station.chargers"
values = [1, 3]

[[axis]]
name = "line s-a, kVA"
key = "line.s-a.rating_kva"
values = [30, 60]
"""


def small() -> Scenario:
    """Six hours on two nodes; whose line limits, and who comes, differ with what a study varies."""
    return make_scenario(
        nodes=(node("s"), node("a", load_kw=20), node("b", load_kw=5)),
        lines=(line("s", "a", rating=45), line("a", "b")),
        price=(0.1, 0.2, 0.15, 0.05, 0.3, 0.1),
        arrivals=generator(),
    )


def write_study(folder: Path, text: str, base: Scenario | None = None) -> Path:
    """A study file beside its base scenario's folder."""
    (folder / "base").mkdir(parents=True, exist_ok=True)
    for name, content in scenario_files(base or small()).items():
        (folder / "base" / name).write_text(content, encoding="utf-8")
    (folder / "study.toml").write_text(text, encoding="utf-8")
    return folder / "study.toml"


def finished(file: Path, out: Path, crew: Crew = Crew(1), do=work) -> StudyFolder:  # noqa: B008
    """A study run to its end, its tables written."""
    runs, folder = read_study(file), StudyFolder(out)
    folder.begin(runs)
    run_study(runs, folder.results, crew, do=do)
    folder.write_tables(folder.found(runs))
    return folder


def rows(folder: StudyFolder, name: str) -> list[dict[str, str]]:
    """A table of a study's folder."""
    return list(csv.DictReader(io.StringIO((folder.path / name).read_text(encoding="utf-8"))))


def dies_at_seed_4(task: Task):
    """Work as usual, but for one seed, whose process is gone."""
    if task.seed == 4:
        import os

        os._exit(11)
    return work(task)
