"""Studies kept side by side: each owner's in a folder nobody can guess, all sharing one queue."""

import shutil
import time
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from evdash.domain.quotas import MOST_STUDIES, MOST_STUDIES_EACH
from evdash.domain.study import StudyRuns
from evdash.errors import EvdashError
from evdash.studies.background import stop
from evdash.studies.folder import RESULTS, StudyFolder
from evdash.studies.stand import Stand, read_stand
from evdash.studies.tables import Found
from evdash.studies.waiting import advance, ahead_of, line_up

QUEUE = "turn.lock"
MOST_DAYS = 90.0
"""None is kept longer without being touched."""
DAY_SECONDS = 86_400.0


@dataclass
class Shelf:
    """The studies of one owner, below `root`."""

    root: Path
    owner: str
    _read: dict[str, StudyRuns] = field(default_factory=dict)
    _found: dict[str, tuple[object, Found]] = field(default_factory=dict)

    @property
    def queue(self) -> Path:
        """What all studies below `root` take turns by."""
        return self.root / QUEUE

    def folders(self) -> list[StudyFolder]:
        """The owner's studies, the latest first."""
        place = self.root / self.owner
        paths = place.iterdir() if place.is_dir() else ()
        numbers = sorted((int(path.name) for path in paths if path.name.isdigit()), reverse=True)
        return [StudyFolder(place / f"{number}") for number in numbers]

    def live(self) -> StudyFolder | None:
        """The study being run or waiting for its turn."""
        for folder in self.folders():
            stand = read_stand(folder)
            if stand is not None and stand.is_live:
                return folder
        return None

    def start(self, runs: StudyRuns, visitor: str | None = None) -> StudyFolder:
        """Keep a study and have it run in a process of its own when its turn comes.

        Raises EvdashError, and keeps nothing, where it cannot be lined up.
        """
        prune(self.root, self.owner)
        known = self.folders()
        number = int(known[0].path.name) + 1 if known else 1
        folder = StudyFolder(self.root / self.owner / f"{number}")
        folder.begin(runs)
        try:
            line_up(folder, self.queue, visitor)
        except EvdashError:
            shutil.rmtree(folder.path, ignore_errors=True)
            raise
        return folder

    def resume(self, folder: StudyFolder, retry: bool = False, visitor: str | None = None) -> None:
        """Go on with a study that was stopped or interrupted; raises EvdashError as `start`."""
        if retry:
            folder.results.forget_failed()
        line_up(folder, self.queue, visitor)

    def cancel(self, folder: StudyFolder) -> None:
        """Have a study stop; what is done stays."""
        stop(folder)
        self._advance()

    def ahead_of(self, folder: StudyFolder) -> int:
        """How many studies, whoever's, come before one that waits; begins it if none does."""
        self._advance()
        return ahead_of(folder, self.queue)

    def _advance(self) -> None:
        with suppress(EvdashError):  # whoever looks next does it
            advance(self.queue)

    def study(self, folder: StudyFolder) -> StudyRuns:
        """What is asked in a study, read once."""
        name = folder.path.name
        if name not in self._read:
            self._read[name] = folder.read()
        return self._read[name]

    def found(self, folder: StudyFolder, stand: Stand | None) -> Found:
        """What a study has found so far, read anew only once there is more."""
        name = folder.path.name
        so_far = (stand.state, stand.ended) if stand else None
        known = self._found.get(name)
        if known is None or known[0] != so_far:
            known = (so_far, folder.found(self.study(folder)))
            self._found = {name: known}
        return known[1]


def prune(root: Path, owner: str) -> None:
    """Make room for one more study of an owner: stale ones go, and the oldest of who has most.

    A study that is on or waits stays.
    """
    stale = time.time() - MOST_DAYS * DAY_SECONDS
    kept = [StudyFolder(path.parent) for path in root.glob(f"*/*/{RESULTS}")]
    touched = {folder: _touched(folder.path / RESULTS) for folder in kept}
    own = [folder for folder in kept if folder.path.parent.name == owner]
    own.sort(key=lambda folder: int(folder.path.name), reverse=True)
    going = {*own[MOST_STUDIES_EACH - 1 :], *(one for one in kept if touched[one] < stale)}
    left = [folder for folder in kept if folder not in going]
    going |= set(_beyond(left, touched, MOST_STUDIES - 1))
    for folder in going:
        stand = read_stand(folder)
        if stand is None or not stand.is_live:
            shutil.rmtree(folder.path, ignore_errors=True)


def _touched(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except FileNotFoundError:  # let go by another server meanwhile
        return 0.0


def _beyond(
    kept: list[StudyFolder], touched: dict[StudyFolder, float], most: int
) -> list[StudyFolder]:
    """The studies to let go so that `most` are left: in turn, the oldest of who has most."""
    held: Counter[str] = Counter()
    newer: dict[StudyFolder, int] = {}
    for folder in sorted(kept, key=touched.__getitem__, reverse=True):
        stand = read_stand(folder)
        who = (stand and stand.visitor) or folder.path.parent.name
        newer[folder] = held[who]
        held[who] += 1
    first = sorted(kept, key=lambda folder: (-newer[folder], touched[folder]))
    return first[: max(0, len(kept) - most)]
