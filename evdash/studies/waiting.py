"""Studies that wait for their turn: a word in each one's folder, and no process before it comes.

Whoever asks for one, looks at one that waits, cancels one, or has just run one, sees to it that the
one that has waited longest is begun where none is on. So the line outlives every server.
"""

import time
from dataclasses import replace
from pathlib import Path

from filelock import FileLock

from evdash.domain.quotas import WAITING_STUDIES
from evdash.errors import EvdashError
from evdash.studies.background import launch, stop
from evdash.studies.folder import StudyFolder
from evdash.studies.stand import STAND, STOP, Stand, read_stand, write_stand

LOOKING = "line.lock"
PATIENCE_SECONDS = 10.0
Standing = tuple[StudyFolder, Stand]


def line_up(folder: StudyFolder, queue: Path, visitor: str | None = None) -> None:
    """Put a study at the end of the line; raises QuotaReached where that is too long.

    Raises EvdashError where the line cannot be kept.
    """
    with _looking(queue):
        waiting = [stand for _, stand in _all(queue) if stand.state == "waiting"]
        if _is_on(queue):
            WAITING_STUDIES.check_one(visitor, [stand.visitor for stand in waiting])
        stop(folder, False)
        write_stand(folder, Stand("waiting", time.time(), visitor=visitor))
    advance(queue)


def advance(queue: Path) -> None:
    """Begin the study that has waited longest, where none is on."""
    with _looking(queue):
        for folder, stand in _waiting(queue):
            if (folder.path / STOP).exists():
                write_stand(folder, replace(stand, state="stopped"))
            elif not _is_on(queue):
                launch(folder, queue)


def ahead_of(folder: StudyFolder, queue: Path) -> int:
    """How many studies will be run before a waiting one, the running one among them."""
    before = [other.path for other, _ in _waiting(queue)]
    place = before.index(folder.path) if folder.path in before else len(before)
    return place + _is_on(queue)


def _looking(queue: Path) -> FileLock:
    """Held by the one who looks whose turn it is."""
    lock = FileLock(queue.with_name(LOOKING), timeout=PATIENCE_SECONDS)
    try:
        queue.parent.mkdir(parents=True, exist_ok=True)
        return lock.acquire().lock
    except OSError as error:  # waited in vain, too
        said = f"{lock.lock_file}: the line of studies could not be looked at ({error})"
        raise EvdashError(said) from error


def _all(queue: Path) -> list[Standing]:
    found = (StudyFolder(path.parent) for path in queue.parent.glob(f"*/*/{STAND}"))
    return [(folder, stand) for folder in found if (stand := read_stand(folder)) is not None]


def _waiting(queue: Path) -> list[Standing]:
    """Those that wait, the one that has waited longest first."""
    waiting = [(folder, stand) for folder, stand in _all(queue) if stand.state == "waiting"]
    return sorted(waiting, key=lambda one: (one[1].since, one[0].path))


def _is_on(queue: Path) -> bool:
    return any(stand.state in ("starting", "running") for _, stand in _all(queue))
