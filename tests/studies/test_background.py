"""Studies in processes of their own: in turns, stopped, killed, gone on with."""

import os
import signal
import sqlite3
import subprocess
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from evdash.domain.quotas import MOST_STUDIES_EACH, WAITING_STUDIES, QuotaReached
from evdash.studies.background import NICENESS, launch, run
from evdash.studies.folder import StudyFolder
from evdash.studies.reading import read_study
from evdash.studies.shelf import Shelf
from evdash.studies.stand import Stand, read_stand, write_stand
from tests.studies.small import STUDY, finished, write_study

PATIENCE_SECONDS = 900.0


def until(told: Callable[[], object]) -> None:
    """Wait for something to become true; the machine may be slow, but not for ever."""
    end = time.monotonic() + PATIENCE_SECONDS
    while not told():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.05)


def state(folder: StudyFolder) -> str:
    stand = read_stand(folder)
    return stand.state if stand else ""


def landed(folder: StudyFolder) -> dict[str, float]:
    with sqlite3.connect(folder.path / "results.sqlite3", timeout=10) as data:
        return dict(data.execute("SELECT key, seconds FROM results").fetchall())


def test_two_peoples_studies_take_turns_and_a_stopped_one_goes_on(tmp_path) -> None:
    long = read_study(write_study(tmp_path, STUDY.format(count=2000)))
    short = read_study(write_study(tmp_path, STUDY.format(count=2)))
    one, other = Shelf(tmp_path / "kept", "one"), Shelf(tmp_path / "kept", "other")
    first = one.start(long)
    until(lambda: len(landed(first)) > 3)
    assert one.live() is not None
    second = other.start(short)
    until(lambda: state(second) == "waiting")
    assert state(first) == "running"
    assert other.ahead_of(second) == 1
    assert landed(second) == {}

    one.cancel(first)
    until(lambda: state(first) == "stopped")
    kept = landed(first)
    assert 3 < len(kept) < 8000
    stand = read_stand(first)
    assert stand is not None
    assert stand.total == 8000
    assert one.live() is None
    until(lambda: state(second) == "done")
    assert len(landed(second)) == 8

    one.resume(first)
    until(lambda: len(landed(first)) > len(kept) + 3)
    assert kept.items() <= landed(first).items()
    one.cancel(first)
    until(lambda: state(first) == "stopped")


def test_a_killed_one_is_told_as_interrupted_and_loses_nothing(tmp_path) -> None:
    file = write_study(tmp_path, STUDY.format(count=40))
    folder = StudyFolder(tmp_path / "kept" / "1")
    folder.begin(read_study(file))
    process = launch(folder, tmp_path / "kept" / "turn.lock", workers=1)
    until(lambda: len(landed(folder)) > 3)
    niceness = subprocess.run(
        ["ps", "-o", "ni=", "-p", f"{process}"], capture_output=True, text=True, check=True
    )
    assert int(niceness.stdout) >= NICENESS
    os.kill(process, signal.SIGKILL)
    until(lambda: state(folder) == "interrupted")
    kept = landed(folder)
    launch(folder, tmp_path / "kept" / "turn.lock", workers=1)
    until(lambda: state(folder) == "done")
    assert kept.items() <= landed(folder).items()
    whole = finished(file, tmp_path / "whole")
    for name in ("runs.csv", "summary.csv", "differences.csv"):
        assert (folder.path / name).read_bytes() == (whole.path / name).read_bytes()


def test_what_cannot_be_run_is_told(tmp_path) -> None:
    folder = StudyFolder(tmp_path / "kept" / "1")
    folder.begin(read_study(write_study(tmp_path, STUDY.format(count=1))))
    (folder.path / "scenario" / "lines.csv").unlink()
    launch(folder, tmp_path / "turn.lock")
    until(lambda: state(folder) == "broken")
    stand = read_stand(folder)
    assert stand is not None
    assert "lines.csv: found no such file" in stand.said


def test_a_process_that_never_came_up_counts_as_lost(tmp_path) -> None:
    folder = StudyFolder(tmp_path)
    write_stand(folder, Stand("starting", time.time()))
    assert state(folder) == "starting"
    write_stand(folder, Stand("starting", time.time() - 1000))
    assert state(folder) == "interrupted"
    assert read_stand(StudyFolder(tmp_path / "none")) is None


def at_once(folder: StudyFolder, queue: Path) -> int:
    write_stand(folder, Stand("done", time.time(), visitor=asker(folder)))
    return 0


def asker(folder: StudyFolder) -> str | None:
    known = read_stand(folder)
    return known.visitor if known else None


def test_the_oldest_studies_go(tmp_path, monkeypatch) -> None:
    runs = read_study(write_study(tmp_path, STUDY.format(count=1)))
    monkeypatch.setattr("evdash.studies.waiting.launch", at_once)
    shelf = Shelf(tmp_path / "kept", "one")
    for _ in range(MOST_STUDIES_EACH + 2):
        shelf.start(runs)
    numbers = [int(folder.path.name) for folder in shelf.folders()]
    assert numbers == list(range(MOST_STUDIES_EACH + 2, 2, -1))


def test_whoever_has_most_studies_makes_room(tmp_path, monkeypatch) -> None:
    """Fifty owners' studies of one visitor push out that visitor's own, and nobody else's."""
    runs = read_study(write_study(tmp_path, STUDY.format(count=1)))
    monkeypatch.setattr("evdash.studies.waiting.launch", at_once)
    monkeypatch.setattr("evdash.studies.shelf.MOST_STUDIES", 8)
    root = tmp_path / "kept"
    first = [Shelf(root, f"first-{n}").start(runs, "first") for n in range(3)]
    unknown = Shelf(root, "unknown").start(runs)
    many = [Shelf(root, f"many-{n}").start(runs, "many") for n in range(20)]
    assert all(folder.path.exists() for folder in [*first, unknown, *many[-4:]])
    assert not any(folder.path.exists() for folder in many[:-4])


def test_what_waits_is_a_word_in_a_file_and_bounded(tmp_path, monkeypatch) -> None:
    runs = read_study(write_study(tmp_path, STUDY.format(count=1)))
    begun: list[StudyFolder] = []

    def launch(folder: StudyFolder, queue: Path) -> int:
        write_stand(folder, Stand("starting", time.time()))
        begun.append(folder)
        return 0

    monkeypatch.setattr("evdash.studies.waiting.launch", launch)
    root, each, total = tmp_path / "kept", WAITING_STUDIES.each, WAITING_STUDIES.total
    shelves = [Shelf(root, f"{n}") for n in range(total + each + 3)]
    first = shelves.pop().start(runs, "one")
    waiting = [shelves.pop().start(runs, "one") for _ in range(each)]
    assert begun == [first]  # and no process for any other
    assert [state(folder) for folder in waiting] == ["waiting"] * each
    refused = shelves.pop()
    with pytest.raises(QuotaReached, match="Cancel one of them"):
        refused.start(runs, "one")
    assert refused.folders() == []
    others = [shelves.pop().start(runs, f"other {n}") for n in range(total - each)]
    with pytest.raises(QuotaReached, match="20 studies are waiting"):
        refused.start(runs, "another")
    shelf = Shelf(root, waiting[0].path.parent.name)
    assert shelf.ahead_of(waiting[0]) == 1
    shelf.cancel(waiting[0])
    assert state(waiting[0]) == "stopped"
    refused.start(runs, "another")
    write_stand(first, Stand("done", time.time()))
    assert Shelf(root, "0").ahead_of(others[0]) == 1 + len(waiting[2:])
    assert begun == [first, waiting[1]]  # whoever looks has the next one begun


def test_folders_of_others_are_not_taken_for_studies(tmp_path: Path) -> None:
    (tmp_path / "one" / "notes").mkdir(parents=True)
    assert Shelf(tmp_path, "one").folders() == []
    assert Shelf(tmp_path, "two").live() is None


def test_a_wish_to_stop_is_heeded_where_its_interrupt_was_lost(tmp_path: Path) -> None:
    """Python drops an interrupt that comes in a callback; a study then went on to its end."""
    folder = StudyFolder(tmp_path / "kept" / "1")
    folder.begin(read_study(write_study(tmp_path, STUDY.format(count=50))))
    wished = threading.Event()
    wished.set()
    with pytest.raises(KeyboardInterrupt):
        run(folder, Stand("starting", time.time()), 1, wished)
    assert len(landed(folder)) <= 1
