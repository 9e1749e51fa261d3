"""Studies kept side by side: each owner's in a folder nobody can guess, all sharing one queue."""

import shutil
import time
from dataclasses import dataclass, field
from pathlib import Path

from evdash.domain.study import StudyRuns
from evdash.studies.background import ahead_of, launch, stop
from evdash.studies.folder import RESULTS, StudyFolder
from evdash.studies.stand import Stand, read_stand
from evdash.studies.tables import Found

QUEUE = "turn.lock"
MOST_STUDIES, MOST_DAYS = 20, 90.0
"""So many an owner keeps, the oldest going first; none is kept longer without being touched."""
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

    def start(self, runs: StudyRuns) -> StudyFolder:
        """Keep a study and have it run in a process of its own."""
        self._prune()
        known = self.folders()
        number = int(known[0].path.name) + 1 if known else 1
        folder = StudyFolder(self.root / self.owner / f"{number}")
        folder.begin(runs)
        launch(folder, self.queue)
        return folder

    def resume(self, folder: StudyFolder, retry: bool = False) -> None:
        """Go on with a study that was stopped or interrupted."""
        if retry:
            folder.results.forget_failed()
        launch(folder, self.queue)

    def cancel(self, folder: StudyFolder) -> None:
        """Have a study stop; what is done stays."""
        stop(folder)

    def ahead_of(self, folder: StudyFolder) -> int:
        """How many studies, whoever's, come before one that waits."""
        return ahead_of(folder, self.queue)

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

    def _prune(self) -> None:
        stale = time.time() - MOST_DAYS * DAY_SECONDS
        old = self.folders()[MOST_STUDIES - 1 :]
        old += [
            StudyFolder(path.parent)
            for path in self.root.glob(f"*/*/{RESULTS}")
            if path.stat().st_mtime < stale
        ]
        for folder in old:
            if not folder.is_running:
                shutil.rmtree(folder.path, ignore_errors=True)
