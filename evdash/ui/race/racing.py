"""A tab's race: started, watched, stopped, and the last one that came to its end."""

import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import streamlit as st

from evdash.domain.trace import Inputs
from evdash.errors import InputError
from evdash.files.race_folder import RACE, read_race
from evdash.files.scenario_folder import resolved, scenario_files
from evdash.policies.race import Race
from evdash.ui.race.work import SCENARIO, Stand, read_stand

KEY = "evdash:race"
ROOT = Path(__file__).parents[3]
QUEUE = Path(tempfile.gettempdir()) / "evdash-race.lock"
GONE = "The race ended before it was done."


@dataclass(frozen=True, slots=True)
class Finished:
    """A race that came to its end, and the inputs it was of."""

    race: Race
    inputs: Inputs


class Racing:
    """What a tab knows of its race. Its folder goes with the tab."""

    def __init__(self) -> None:
        self.finished: Finished | None = None
        self.said = ""
        self._inputs: Inputs | None = None
        self._process: subprocess.Popen[bytes] | None = None
        self._folder: tempfile.TemporaryDirectory[str] | None = None

    @property
    def is_running(self) -> bool:
        return self._process is not None

    def start(self, inputs: Inputs, policies: list[str]) -> None:
        """Race these policies on the day of `inputs`, from its beginning."""
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
        self._process = subprocess.Popen(  # noqa: S603 - our own module
            [*command, inputs.network, *policies],
            cwd=ROOT,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    def cancel(self) -> None:
        """Stop the race, if one is on; what an earlier one showed stays."""
        if self._process is not None:
            self._process.terminate()
            self._process.wait(10)
        self._clear()

    def look(self) -> Stand:
        """How it stands; takes in what came of it where it has ended."""
        if self._process is None or self._folder is None or self._inputs is None:
            return Stand("done")
        ended = self._process.poll() is not None
        folder = Path(self._folder.name)
        stand = read_stand(folder)
        if not ended:
            return stand
        if stand.state == "done":
            self._take(folder / RACE.removesuffix(".json") / RACE, self._inputs)
        else:
            self.said = stand.said or GONE
        self._clear()
        return stand

    def _take(self, file: Path, inputs: Inputs) -> None:
        try:
            self.finished = Finished(read_race(file), inputs)
        except InputError as error:
            self.said = "; ".join(str(fault) for fault in error.faults)

    def _clear(self) -> None:
        self._process = None
        if self._folder is not None:
            self._folder.cleanup()
        self._folder = None


def current_racing() -> Racing:
    """This tab's race."""
    if KEY not in st.session_state:
        st.session_state[KEY] = Racing()
    racing: Racing = st.session_state[KEY]
    return racing
