"""A study in a process of its own: it outlives the page, and the server, that asked for it.

`python -m evdash.studies.background FOLDER QUEUE WORKERS` runs the study kept in FOLDER, one of
all those sharing the file QUEUE at a time, the one asked for first going first. It makes way for
everything else on the machine, says how far it is in FOLDER/stand.json, and stops where
FOLDER/stop appears.
"""

import _thread
import os
import subprocess
import sys
import threading
import time
from pathlib import Path

from filelock import FileLock, Timeout

from evdash.errors import EvdashError
from evdash.studies.crew import Crew, cores
from evdash.studies.engine import Progress, run_study
from evdash.studies.folder import StudyFolder
from evdash.studies.stand import STAND, STOP, Stand, State, read_stand, write_stand

ROOT = Path(__file__).parents[2]
LOG = "log.txt"
NICENESS = 15
LOOK_SECONDS = 0.3
SAY_SECONDS = 0.4


def spare_cores() -> int:
    """Processes a study may have so that those who step a day are not held up."""
    return max(1, cores() - 1)


def launch(folder: StudyFolder, queue: Path, workers: int | None = None) -> int:
    """Start or resume the study kept in a folder, and leave it to itself; its process's id."""
    stop(folder, False)
    write_stand(folder, Stand("starting", time.time()))
    command = [sys.executable, "-m", "evdash.studies.background", str(folder.path.resolve())]
    with (folder.path / LOG).open("wb") as log:
        process = subprocess.Popen(  # noqa: S603 - our own module
            [*command, str(queue.resolve()), str(workers or spare_cores())],
            cwd=ROOT,
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
    """Wait for this study's turn and run it; what becomes of it stands in its folder."""
    make_way()
    threading.Thread(target=_watch, args=(folder,), daemon=True).start()
    known = read_stand(folder)
    since = known.since if known else time.time()
    last = Stand("waiting", since)
    try:
        with folder.lock(patience_seconds=5.0):
            write_stand(folder, last)
            try:
                with _turn(folder, queue, since):
                    last = _run(folder, since, workers)
            except KeyboardInterrupt:
                last = _ended(folder, "stopped", since)
            except EvdashError as error:
                last = _ended(folder, "broken", since, f"{error}")
            except Exception as error:
                last = _ended(folder, "broken", since, f"{type(error).__name__}: {error}")
                raise
            finally:
                write_stand(folder, last)
    except Timeout:
        return  # somebody else is at it


def make_way() -> None:
    """Let everybody else on the machine go first."""
    if hasattr(os, "nice"):
        os.nice(NICENESS)


def _watch(folder: StudyFolder) -> None:
    while not (folder.path / STOP).exists():
        time.sleep(LOOK_SECONDS)
    _thread.interrupt_main()


def _turn(folder: StudyFolder, queue: Path, since: float) -> FileLock:
    """Wait until nobody is running and nobody else has waited longer."""
    turn = FileLock(queue)
    while True:
        if not any(_is_ahead(other, since) for other in _others(folder, queue)):
            try:
                turn.acquire(timeout=0)
            except Timeout:
                pass
            else:
                return turn
        time.sleep(LOOK_SECONDS)


def _others(folder: StudyFolder, queue: Path) -> list[StudyFolder]:
    found = (StudyFolder(path.parent) for path in queue.parent.rglob(STAND))
    return [other for other in found if other.path != folder.path]


def _is_ahead(other: StudyFolder, since: float) -> bool:
    stand = read_stand(other)
    return stand is not None and stand.state == "waiting" and stand.since < since


def ahead_of(folder: StudyFolder, queue: Path) -> int:
    """How many studies will be run before a waiting one, the running one among them."""
    own = read_stand(folder)
    stands = [read_stand(other) for other in _others(folder, queue)]
    since = own.since if own else time.time()
    return sum(
        stand is not None
        and (stand.state == "running" or (stand.state == "waiting" and stand.since < since))
        for stand in stands
    )


def _run(folder: StudyFolder, since: float, workers: int) -> Stand:
    runs = folder.read()
    said = 0.0

    def told(now: Progress) -> None:
        nonlocal said
        if time.monotonic() - said >= SAY_SECONDS:
            said = time.monotonic()
            write_stand(folder, _stand("running", since, now))

    end = run_study(runs, folder.results, Crew(workers), told)
    folder.write_tables(folder.found(runs))
    return _stand("done", since, end)


def _stand(state: State, since: float, now: Progress) -> Stand:
    return Stand(state, since, now.total, now.done, now.failed, now.seconds_left)


def _ended(folder: StudyFolder, state: State, since: float, said: str = "") -> Stand:
    """How the study stands where it ended early."""
    last = read_stand(folder) or Stand(state, since)
    return Stand(state, since, last.total, last.done, last.failed, None, said)


if __name__ == "__main__":
    main(StudyFolder(Path(sys.argv[1])), Path(sys.argv[2]), int(sys.argv[3]))
