"""The same code on a cluster: a local Dask scheduler with two workers."""

import shlex
import subprocess
import sys
import time
from pathlib import Path

import psutil
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


def dask_commands(text: str) -> list[str]:
    return [line for line in text.splitlines() if line.startswith("python -m distributed.cli.")]


@pytest.mark.parametrize("page", ["README.md", "docs/studies.md"])
def test_every_command_told_says_on_which_address_to_listen(page: str) -> None:
    """Whoever reaches Dask can run code; left alone, it listens on all addresses."""
    commands = dask_commands((ROOT / page).read_text(encoding="utf-8"))
    assert len(commands) == 2
    for command in commands:
        assert "--host " in command
        assert "--dashboard-address 127.0.0.1:0" in command


def test_the_commands_of_the_readme_listen_on_this_machine_only() -> None:
    scheduler, worker = dask_commands((ROOT / "README.md").read_text(encoding="utf-8"))
    started = [start_dask(scheduler)]
    try:
        assert listening(started[0], 1) == {"127.0.0.1"}
        started.append(start_dask(worker))
        # of each of two workers its own socket, and that of the nanny who watches it
        assert listening(started[1], 4) == {"127.0.0.1"}
    finally:
        for process in started:
            end_all(process)


def start_dask(command: str) -> subprocess.Popen[bytes]:
    arguments = [sys.executable, *shlex.split(command)[1:]]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    return subprocess.Popen(arguments, **quiet)


def listening(process: subprocess.Popen[bytes], sockets: int) -> set[str]:
    """Addresses a process and those it began listen on, once it has at least so many sockets."""
    until = time.monotonic() + 120
    while time.monotonic() < until:
        assert process.poll() is None
        parent = psutil.Process(process.pid)
        found = [
            connection.laddr.ip
            for each in (parent, *parent.children(recursive=True))
            for connection in each.net_connections("tcp")
            if connection.status == psutil.CONN_LISTEN
        ]
        if len(found) >= sockets:
            return set(found)
        time.sleep(0.2)
    raise AssertionError(f"{process.args} does not listen")


def end_all(process: subprocess.Popen[bytes]) -> None:
    parent = psutil.Process(process.pid)
    for each in (*parent.children(recursive=True), parent):
        each.kill()
    process.wait(30)
