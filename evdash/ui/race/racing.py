"""A tab's race: started, watched, stopped, and the last one that came to its end."""

import subprocess
import sys
import tempfile
import weakref
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import streamlit as st

from evdash.domain.quotas import QuotaReached
from evdash.domain.trace import Inputs
from evdash.errors import InputError
from evdash.files.race_folder import RACE, read_race
from evdash.files.scenario_folder import resolved, scenario_files
from evdash.policies.race import Race
from evdash.resources import IMPORTABLE_FROM
from evdash.ui.race.line import Place, line
from evdash.ui.race.work import SCENARIO, Stand, read_stand
from evdash.ui.visitors import visitor

KEY = "evdash:race"
QUEUE = Path(tempfile.gettempdir()) / "evdash-race.lock"
GONE = "The race ended before it was done."


@dataclass(frozen=True, slots=True)
class Finished:
    """A race that came to its end, and the inputs it was of."""

    race: Race
    inputs: Inputs


class Racing:
    """What a tab knows of its race. Its folder goes with the tab, and so does its place in line."""

    def __init__(self) -> None:
        self.finished: Finished | None = None
        self.said = ""
        self._inputs: Inputs | None = None
        self._place: Place | None = None
        self._let_go: weakref.finalize[..., Racing] | None = None
        self._folder: tempfile.TemporaryDirectory[str] | None = None

    @property
    def is_running(self) -> bool:
        return self._place is not None

    @property
    def is_in_line(self) -> bool:
        """Whether other races of this server come first."""
        return self._place is not None and self._place.process is None

    @property
    def ahead(self) -> int:
        """How many other races wait before this one."""
        return line.ahead_of(self._place) if self._place else 0

    def start(self, inputs: Inputs, policies: list[str]) -> None:
        """Race these policies on the day of `inputs`, from its beginning, when its turn comes."""
        self.cancel()
        self.said, self._inputs = "", inputs
        self._folder = tempfile.TemporaryDirectory(
            prefix="evdash-race-", ignore_cleanup_errors=True
        )
        folder = Path(self._folder.name)
        (folder / SCENARIO).mkdir()
        for name, text in scenario_files(resolved(inputs.given, inputs.arrivals)).items():
            (folder / SCENARIO / name).write_text(text, encoding="utf-8", newline="")
        command = [sys.executable, "-m", "evdash.ui.race.work", str(folder), str(QUEUE)]
        try:
            begin = partial(_begun, [*command, inputs.network, *policies])
            self._place = line.join(visitor(), begin)
        except QuotaReached as full:
            self.said = str(full)
            self._clear()
        else:
            self._let_go = weakref.finalize(self, line.leave, self._place)

    def cancel(self) -> None:
        """Stop the race, if one is on; what an earlier one showed stays."""
        if self._place is not None:
            line.leave(self._place)
        self._clear()

    def look(self) -> Stand:
        """How it stands; takes in what came of it where it has ended."""
        if self._place is None or self._folder is None or self._inputs is None:
            return Stand("done")
        ended = self._place.left.is_set()
        folder = Path(self._folder.name)
        stand = read_stand(folder)
        if not ended:
            return stand
        if stand.state == "done":
            self._take(folder / RACE.removesuffix(".json") / RACE, self._inputs)
        else:
            self.said = stand.said or self._place.failure or GONE
        self._clear()
        return stand

    def _take(self, file: Path, inputs: Inputs) -> None:
        try:
            self.finished = Finished(read_race(file), inputs)
        except InputError as error:
            self.said = "; ".join(str(fault) for fault in error.faults)

    def _clear(self) -> None:
        self._place = None
        if self._let_go is not None:
            self._let_go.detach()
        self._let_go = None
        if self._folder is not None:
            self._folder.cleanup()
        self._folder = None


def _begun(command: list[str]) -> subprocess.Popen[bytes]:
    return subprocess.Popen(  # noqa: S603 - our own module
        command,
        cwd=IMPORTABLE_FROM,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def current_racing() -> Racing:
    """This tab's race."""
    if KEY not in st.session_state:
        st.session_state[KEY] = Racing()
    racing: Racing = st.session_state[KEY]
    return racing
