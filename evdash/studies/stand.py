"""How far a study in a process of its own is, as it says itself and as the system knows."""

import json
import os
import time
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Literal

from evdash.files.nested import read_json
from evdash.studies.folder import StudyFolder

STAND, STOP = "stand.json", "stop"
START_SECONDS = 120.0
"""How long a process may take to come up before it counts as lost."""
State = Literal["starting", "waiting", "running", "done", "stopped", "broken", "interrupted"]
LIVE: tuple[State, ...] = ("starting", "waiting", "running")


@dataclass(frozen=True, slots=True)
class Stand:
    """A study's state. `since` is when it was asked for, or its process begun; `said` why it is
    broken; `visitor` who asked for it, where that can be told; the rest as in `engine.Progress`.
    One that waits has no process."""

    state: State
    since: float
    total: int = 0
    done: int = 0
    failed: int = 0
    seconds_left: float | None = None
    said: str = ""
    visitor: str | None = None

    @property
    def is_live(self) -> bool:
        """Whether somebody is at it or about to be."""
        return self.state in LIVE

    @property
    def ended(self) -> int:
        return self.done + self.failed


def write_stand(folder: StudyFolder, stand: Stand) -> None:
    """Say how far the study is."""
    beside = folder.path / f".{STAND}.{os.getpid()}"
    beside.write_text(json.dumps(asdict(stand)), encoding="utf-8")
    os.replace(beside, folder.path / STAND)


@lru_cache(maxsize=2048)
def _read(path: Path, _number: int, _changed_ns: int) -> Stand:
    """A file of this number and time, read once: who looks for a turn looks at all of them."""
    return Stand(**read_json(path.read_text(encoding="utf-8")))


def read_stand(folder: StudyFolder) -> Stand | None:
    """How far the study is; None where nobody has begun it. What says it is running while no
    process is at it was interrupted."""
    path = folder.path / STAND
    try:
        found = path.stat()
        stand = _read(path, found.st_ino, found.st_mtime_ns)
    except (OSError, ValueError, TypeError):
        return None
    fresh = stand.state == "starting" and time.time() - stand.since < START_SECONDS
    if stand.state in ("starting", "running") and not fresh and not folder.is_running:
        return replace(stand, state="interrupted", seconds_left=None, said="")
    return stand
