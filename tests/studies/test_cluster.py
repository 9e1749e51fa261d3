"""The same code on a cluster: a local Dask scheduler with two workers."""

import subprocess
import sys
from pathlib import Path

import pytest

from evdash.errors import EvdashError, InputError
from evdash.studies.crew import Crew
from tests.studies.small import STUDY, finished, rows, write_study

TABLES = ("runs.csv", "summary.csv", "differences.csv")
ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def cluster():
    from distributed import LocalCluster

    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with LocalCluster(**options) as local:
        yield local


def test_two_workers_of_a_cluster_find_what_one_process_finds(tmp_path, cluster) -> None:
    file = write_study(tmp_path, STUDY.format(count=5))
    alone = finished(file, tmp_path / "alone")
    spread = finished(file, tmp_path / "spread", Crew(scheduler=cluster.scheduler_address))
    for name in TABLES:
        assert (spread.path / name).read_bytes() == (alone.path / name).read_bytes()
    assert len(rows(spread, "runs.csv")) == 20


def test_the_command_line_takes_its_address_and_resumes_what_cores_began(tmp_path, cluster) -> None:
    few = write_study(tmp_path, STUDY.format(count=2))
    folder = finished(few, tmp_path / "out")
    write_study(tmp_path, STUDY.format(count=4))
    command = [sys.executable, "-m", "evdash", "study", str(few), "--out", str(folder.path)]
    told = subprocess.run(
        [*command, "--scheduler", cluster.scheduler_address],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert told.returncode == 0, told.stderr
    assert [row["status"] for row in rows(folder, "runs.csv")] == ["done"] * 16


def test_an_address_where_nothing_answers_is_told(tmp_path) -> None:
    file = write_study(tmp_path, STUDY.format(count=1))
    with pytest.raises(InputError, match="nothing that answers"):
        finished(file, tmp_path / "out", Crew(scheduler="tcp://127.0.0.1:9"))


def test_a_scheduler_without_workers_is_told(tmp_path) -> None:
    from distributed import LocalCluster

    file = write_study(tmp_path, STUDY.format(count=1))
    with (
        LocalCluster(n_workers=0, dashboard_address=None) as empty,
        pytest.raises(EvdashError, match="no workers"),
    ):
        finished(file, tmp_path / "out", Crew(scheduler=empty.scheduler_address))
