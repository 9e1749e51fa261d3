"""A study in a process of its own: it outlives the page, and the server, that asked for it.

`python -m evdash.studies.background FOLDER QUEUE WORKERS` runs the study kept in FOLDER, one of
all those sharing the file QUEUE at a time. It makes way for everything else on the machine, says
how far it is in FOLDER/stand.json, stops where FOLDER/stop appears, and in the end begins the study
that has waited longest (`evdash.studies.waiting`), which until then is a word in a file.
"""

import _thread
import os
import subprocess
import sys
import threading
import time
from dataclasses import replace
from pathlib import Path

from filelock import FileLock, Timeout

from evdash.errors import EvdashError
from evdash.resources import IMPORTABLE_FROM
from evdash.studies.crew import Crew, cores
from evdash.studies.engine import Progress, run_study
from evdash.studies.folder import StudyFolder
from evdash.studies.stand import STOP, Stand, State, read_stand, write_stand

LOG = "log.txt"
NICENESS = 15
LOOK_SECONDS = 0.3
SAY_SECONDS = 0.4


def spare_cores() -> int:
    """Processes a study may have so that those who step a day are not held up."""
    return max(1, cores() - 1)


def launch(folder: StudyFolder, queue: Path, workers: int | None = None) -> int:
    """Start or resume the study kept in a folder, and leave it to itself; its process's id."""
    known = read_stand(folder)
    visitor = known.visitor if known else None
    write_stand(folder, Stand("starting", time.time(), visitor=visitor))
    command = [sys.executable, "-m", "evdash.studies.background", str(folder.path.resolve())]
    with (folder.path / LOG).open("wb") as log:
        process = subprocess.Popen(  # noqa: S603 - our own module
            [*command, str(queue.resolve()), str(workers or spare_cores())],
            cwd=IMPORTABLE_FROM,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=log,
            start_new_session=True,
        )
    return process.pid


def stop(folder: StudyFolder, stopped: bool = True) -> None:
    """Have a study stop, keeping what is done; or take that wish back."""
    if stopped:
        (folder.path / STOP).touch()
    else:
        (folder.path / STOP).unlink(missing_ok=True)


def main(folder: StudyFolder, queue: Path, workers: int) -> None:
    """Run a study whose turn it is; what becomes of it stands in its folder."""
    make_way()
    wished = threading.Event()
    threading.Thread(target=_watch, args=(folder, wished), daemon=True).start()
    first = last = read_stand(folder) or Stand("starting", time.time())
    try:
        with folder.lock(patience_seconds=5.0):
            try:
                with FileLock(queue):  # free at once, unless a process was slow to come up
                    last = run(folder, first, workers, wished)
            except KeyboardInterrupt:
                last = _ended(folder, "stopped", first)
            except EvdashError as error:
                last = _ended(folder, "broken", first, f"{error}")
            except Exception as error:
                last = _ended(folder, "broken", first, f"{type(error).__name__}: {error}")
                raise
            finally:
                write_stand(folder, last)
    except Timeout:
        return  # somebody else is at it


def make_way() -> None:
    """Let everybody else on the machine go first."""
    if hasattr(os, "nice"):
        os.nice(max(0, NICENESS - os.nice(0)))  # begun by another study it has made way already


def _watch(folder: StudyFolder, wished: threading.Event) -> None:
    while not (folder.path / STOP).exists():
        time.sleep(LOOK_SECONDS)
    _thread.interrupt_main()
    wished.set()  # after it, so that who heeds the wish is not interrupted once more


def run(folder: StudyFolder, first: Stand, workers: int, wished: threading.Event) -> Stand:
    """Do the runs of a study; how it then stands.

    Raises KeyboardInterrupt after the run under way once it is `wished` that the study stop: an
    interrupt can be lost, as Python drops one that comes while a callback of a library runs.
    """
    runs = folder.read()
    said = 0.0

    def told(now: Progress) -> None:
        nonlocal said
        if wished.is_set():
            raise KeyboardInterrupt
        if time.monotonic() - said >= SAY_SECONDS:
            said = time.monotonic()
            write_stand(folder, _stand("running", first, now))

    end = run_study(runs, folder.results, Crew(workers), told)
    folder.write_tables(folder.found(runs))
    return _stand("done", first, end)


def _stand(state: State, first: Stand, now: Progress) -> Stand:
    return Stand(
        state, first.since, now.total, now.done, now.failed, now.seconds_left, "", first.visitor
    )


def _ended(folder: StudyFolder, state: State, first: Stand, said: str = "") -> Stand:
    """How the study stands where it ended early."""
    last = read_stand(folder) or first
    return replace(last, state=state, seconds_left=None, said=said)


if __name__ == "__main__":
    from evdash.studies.waiting import advance  # which launches, and so knows of this module

    try:
        main(StudyFolder(Path(sys.argv[1])), Path(sys.argv[2]), int(sys.argv[3]))
    finally:
        advance(Path(sys.argv[2]))
