"""A study comes to the same whoever does it, whatever stops it on the way, and whatever fails."""

import os
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import pytest

from evdash.cli.main import main
from evdash.horizon.day import run_day, start_day
from evdash.metrics.service import totals
from evdash.scheduling.p1 import p1_policy
from evdash.studies import work as works
from evdash.studies.crew import DIED, Crew
from evdash.studies.days import with_seed
from evdash.studies.engine import run_study
from evdash.studies.folder import StudyFolder
from evdash.studies.reading import read_study, scenario_at
from evdash.studies.work import OtherCode, Task, work
from tests.studies.small import STUDY, dies_at_seed_4, finished, rows, write_study

TABLES = ("runs.csv", "summary.csv", "differences.csv", "study.toml")
ROOT = Path(__file__).parents[2]


def texts(folder: StudyFolder) -> dict[str, bytes]:
    return {name: (folder.path / name).read_bytes() for name in TABLES}


def landed(folder: StudyFolder) -> dict[str, float]:
    """The processor time of every run kept: no second try takes the same to the last digit."""
    if not (folder.path / "results.sqlite3").exists():
        return {}
    with sqlite3.connect(folder.path / "results.sqlite3", timeout=10) as data:
        try:
            return dict(data.execute("SELECT key, seconds FROM results").fetchall())
        except sqlite3.OperationalError:
            return {}


def test_one_worker_and_two_find_the_same(tmp_path) -> None:
    file = write_study(tmp_path, STUDY.format(count=6))
    alone = finished(file, tmp_path / "alone")
    assert len(rows(alone, "runs.csv")) == 24
    assert {row["status"] for row in rows(alone, "runs.csv")} == {"done"}
    assert texts(finished(file, tmp_path / "two", Crew(2))) == texts(alone)


def test_a_run_is_the_day_one_would_run(tmp_path) -> None:
    file = write_study(tmp_path, STUDY.format(count=2))
    runs = read_study(file)
    table = rows(finished(file, tmp_path / "out"), "runs.csv")
    for run, row in zip(runs.runs, table, strict=True):
        scenario = with_seed(scenario_at(runs, run.point), run.seed)
        assert scenario.station.chargers == int(row["station.chargers"])
        rating = next(one.rating_kva for one in scenario.lines if one.name == "s-a")
        assert rating == float(row["line s-a, kVA"])
        day = totals(run_day(start_day(scenario), p1_policy()))
        assert float(row["profit"]) == day.profit
        assert int(row["admitted"]) == day.admitted
    assert len({row["profit"] for row in table}) > 4


def test_a_study_killed_half_way_is_resumed_to_the_very_same_tables(tmp_path) -> None:
    file = write_study(tmp_path, STUDY.format(count=15))
    folder = StudyFolder(tmp_path / "out")
    command = [sys.executable, "-m", "evdash", "study", str(file), "--out", str(folder.path)]
    process = subprocess.Popen(
        [*command, "--workers", "2"], cwd=ROOT, start_new_session=True, stderr=subprocess.DEVNULL
    )
    until = time.monotonic() + 120
    while len(landed(folder)) < 15 and process.poll() is None and time.monotonic() < until:
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL, "the study was over before it could be killed"
    before = landed(folder)
    assert 15 <= len(before) < 60
    assert not folder.is_running

    again = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert "written to" in again.stdout
    after = landed(folder)
    assert len(after) == 60
    assert before.items() <= after.items(), "a finished run was done again"
    assert texts(folder) == texts(finished(file, tmp_path / "never-killed"))


def test_what_is_new_in_a_changed_study_is_all_that_is_run(tmp_path) -> None:
    few = write_study(tmp_path, STUDY.format(count=3))
    folder = finished(few, tmp_path / "out")
    before = landed(folder)
    more = write_study(tmp_path, STUDY.format(count=5))
    runs = read_study(more)
    progress = run_study(runs, folder.results, Crew(1))
    assert (progress.total, progress.earlier, progress.done) == (20, 12, 20)
    assert before.items() <= landed(folder).items()


def test_a_failed_run_is_told_and_ends_nothing(tmp_path, monkeypatch) -> None:
    file = write_study(tmp_path, STUDY.format(count=3))
    told = works.figures

    def figures(day):
        if day.trace.scenario.arrivals.seed == 4:
            raise ZeroDivisionError("of a test")
        return told(day)

    monkeypatch.setattr(works, "figures", figures)
    folder = finished(file, tmp_path / "out")
    table = rows(folder, "runs.csv")
    failed = [row for row in table if row["status"] == "failed"]
    assert {row["seed"] for row in failed} == {"4"}
    assert {row["reason"] for row in failed} == {"ZeroDivisionError: of a test"}
    assert {row["profit"] for row in failed} == {""}
    assert {row["days"] for row in rows(folder, "summary.csv")} == {"2"}

    monkeypatch.setattr(works, "figures", told)
    runs = read_study(file)
    assert run_study(runs, folder.results, Crew(1)).failed == 4, "failures are kept, too"
    folder.results.forget_failed()
    progress = run_study(runs, folder.results, Crew(1))
    assert (progress.failed, progress.earlier) == (0, 8)


def test_a_process_that_dies_costs_its_own_run_alone(tmp_path) -> None:
    file = write_study(tmp_path, STUDY.format(count=4))
    table = rows(finished(file, tmp_path / "out", Crew(2), dies_at_seed_4), "runs.csv")
    dead = [row for row in table if row["status"] == "failed"]
    assert [row["seed"] for row in dead] == ["4"] * 4
    assert all(row["reason"].startswith(DIED) for row in dead)
    assert sum(row["status"] == "done" for row in table) == 12


def test_results_of_other_code_are_neither_taken_nor_made(tmp_path, monkeypatch) -> None:
    file = write_study(tmp_path, STUDY.format(count=1))
    folder = finished(file, tmp_path / "out")
    before = {run.key for run in read_study(file).runs}
    monkeypatch.setattr("evdash.studies.reading.code_of", lambda _: "other")
    assert not before & {run.key for run in read_study(file).runs}
    assert run_study(read_study(file), folder.results, Crew(1)).earlier == 0
    with pytest.raises(OtherCode, match="another version"):
        work(Task("k", "{}", 1, "p1", "lindistflow", False, "other"))


def test_an_interrupt_leaves_what_is_done(tmp_path) -> None:
    file = write_study(tmp_path, STUDY.format(count=3))
    runs, folder = read_study(file), StudyFolder(tmp_path / "out")
    folder.begin(runs)

    def stop(progress) -> None:
        if progress.ended == 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_study(runs, folder.results, Crew(1), stop)
    assert len(landed(folder)) == 5
    assert run_study(runs, folder.results, Crew(1)).earlier == 5


def test_time_left_is_told_from_the_pace_since_this_start(tmp_path) -> None:
    file = write_study(tmp_path, STUDY.format(count=2))
    runs, folder, told = read_study(file), StudyFolder(tmp_path / "out"), []
    folder.begin(runs)
    run_study(runs, folder.results, Crew(1), told.append)
    assert told[0].seconds_left is None
    assert told[3].seconds_left == pytest.approx(told[3].busy_seconds / 3 * 5)
    assert told[-1].seconds_left == 0
    assert [one.ended for one in told] == list(range(9))


def test_a_study_under_way_is_not_given_another_file(tmp_path) -> None:
    """Who comes second is told so, and what the first reads stays what it was."""
    file = write_study(tmp_path, STUDY.format(count=1))
    folder = StudyFolder(tmp_path / "out")
    folder.make()
    with folder.lock():
        folder.begin(read_study(file))
        before = (folder.path / "study.toml").read_bytes()
        write_study(tmp_path, STUDY.format(count=2))
        assert main(["study", str(file), "--out", str(folder.path)]) == 1
        assert (folder.path / "study.toml").read_bytes() == before


@pytest.mark.parametrize("below", ["file/out", "scenario/out"])
def test_a_place_that_cannot_be_written_is_told(tmp_path, below, capsys) -> None:
    file = write_study(tmp_path, STUDY.format(count=1))
    (tmp_path / "file").write_text("", encoding="utf-8")
    (tmp_path / "scenario").mkdir()
    (tmp_path / "scenario" / "scenario.toml").write_text("", encoding="utf-8")
    assert main(["study", str(file), "--out", str(tmp_path / below)]) == 2
    assert "evdash failed" not in capsys.readouterr().err


def test_own_files_beside_a_studys_scenario_stay(tmp_path) -> None:
    file = write_study(tmp_path, STUDY.format(count=1))
    folder = StudyFolder(tmp_path / "out")
    folder.begin(read_study(file))
    (folder.path / "scenario" / "notes.txt").write_text("mine", encoding="utf-8")
    folder.begin(read_study(file))
    assert (folder.path / "scenario" / "notes.txt").read_text(encoding="utf-8") == "mine"
