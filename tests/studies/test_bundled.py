"""The page of studies says what the code says, and every bundled study runs."""

import subprocess
import sys
from pathlib import Path

import pytest

from evdash.domain.study import Seeds
from evdash.files.bundled import DEFAULT, bundled_scenarios
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario
from evdash.studies.crew import Crew
from evdash.studies.engine import run_study
from evdash.studies.folder import StudyFolder
from evdash.studies.questions import QUESTIONS
from evdash.studies.reading import base_scenario, lay_out, parse_study, read_study

ROOT = Path(__file__).parents[2]
STUDIES = sorted((ROOT / "data" / "studies").glob("*.toml"))


def test_the_page_is_in_step_with_the_declarations() -> None:
    script = "import sys; sys.path.insert(0, 'docs'); import build_studies_doc as page;"
    printed = subprocess.run(
        [sys.executable, "-X", "utf8", "-c", script + "print(page.document(), end='')"],
        capture_output=True,
        encoding="utf-8",
        check=True,
        cwd=ROOT,
    ).stdout
    assert printed == (ROOT / "docs" / "studies.md").read_text(encoding="utf-8")


def test_the_example_of_the_page_can_be_run(tmp_path) -> None:
    page = (ROOT / "docs" / "studies.md").read_text(encoding="utf-8")
    example = page.partition("```toml\n")[2].partition("```")[0]
    study = parse_study(example)
    assert len(lay_out(study, base_scenario(study, tmp_path)).points) == 12


@pytest.mark.parametrize("file", STUDIES, ids=lambda file: file.stem)
def test_every_bundled_study_is_valid_and_runs_in_small(file, tmp_path) -> None:
    whole = read_study(file)
    assert len(whole.runs) > 10
    study = whole.study
    few = study.model_copy(
        update={"seeds": Seeds(count=1), "networks": study.networks[:1], "referee_every": 0}
    )
    base = edit_scenario(
        whole.given, {"arrivals.vehicles_per_day": 4.0, "arrivals_until": 6, "intervals": 24}
    )
    runs = lay_out(few, base)
    small = [run for run in runs.runs if run.point in (0, len(runs.points) - 1)]
    folder = StudyFolder(tmp_path)
    runs = type(runs)(runs.study, runs.given, runs.base, runs.points, tuple(small))
    folder.begin(runs)
    assert run_study(runs, folder.results, Crew(1)).failed == 0
    folder.write_tables(folder.found(runs))
    assert (tmp_path / "summary.csv").read_text(encoding="utf-8").count("\n") > 1


@pytest.mark.parametrize("name", QUESTIONS)
@pytest.mark.parametrize("folder", bundled_scenarios(), ids=lambda folder: folder.name)
def test_every_question_can_be_asked_of_every_bundled_scenario(name, folder) -> None:
    scenario = read_scenario(folder)
    study = QUESTIONS[name].study(scenario).model_copy(update={"seeds": Seeds(count=1)})
    runs = lay_out(study, scenario)
    assert len(runs.points) >= (1 if name in ("sure", "upgrade") else 2)


def test_the_upgrade_is_of_the_line_that_binds() -> None:
    study = QUESTIONS["upgrade"].study(read_scenario(DEFAULT))
    assert study.axis[0].case[2].set == {"line.633-634.rating_kva": 750.0}
