"""What one browser tab owns: its run, replaced whole under a lock, and what it has drawn."""

import threading
import time
import weakref
from collections import deque
from collections.abc import Callable, Hashable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal, TypeVar

import streamlit as st

from evdash.domain.arrivals import Arrival
from evdash.domain.events import Event
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Network, Trace
from evdash.errors import legible
from evdash.files.bundled import DEFAULT, bundled_scenarios
from evdash.files.scenario_folder import read_scenario
from evdash.ui import keeping
from evdash.ui import run as runs
from evdash.ui.downloads import Rest
from evdash.ui.keeping import Keeper
from evdash.ui.run import Run
from evdash.ui.whatif import Prompted, prompts
from evdash.ui.words import plain

Mode = Literal["idle", "playing", "finishing"]
T = TypeVar("T")
KEY = "evdash"
PRESET = "preset"
"""What the address calls the scenario that was opened."""
MOST_UNDONE = 200
_opening = threading.Lock()
_open: weakref.WeakSet["Session"] = weakref.WeakSet()


class Session:
    """A tab's run and how it is being driven.

    `refused` is what was typed into fields of numbers and could not be read, by their keys;
    `price_refused` likewise into the table of energy prices, by interval.

    Streamlit aborts a running script at its next call when somebody clicks again. So every
    change is a pure function from run to run and one assignment, without a Streamlit call in
    between, and the lock lets one change follow the other: a click is neither lost nor
    half done. Every change is kept on disk, too, and can be undone.
    """

    def __init__(self, run: Run, keeper: Keeper | None = None) -> None:
        self.run = run
        self.keeper = keeper or Keeper()
        self.rest = Rest()
        self.mode: Mode = "idle"
        self.prompted: Prompted | None = None
        self.shown: dict[str, object] = {}
        self.width_px: dict[str, float] = {}
        self.refused: dict[str, str] = {}
        self.price_first = 0
        self.price_base: tuple[str, ...] = ()
        self.price_latest: tuple[float, ...] = ()
        self.price_refused: dict[int, str] = {}
        self.price_revision = 0
        self._stepped_at = 0.0
        self._past: deque[Run] = deque(maxlen=MOST_UNDONE)
        self._lock = threading.Lock()
        self._drawn: dict[str, tuple[Trace, Hashable, Any]] = {}
        with _opening:
            _open.add(self)

    def _change(self, change: Callable[[Run], Run]) -> None:
        with self._lock:
            before, self.run = self.run, change(self.run)
            if self.run.trace is not before.trace or self.run.opened is not before.opened:
                self._past.append(before)
                self.keeper.keep(self.run)
            if self.run.trace.is_over:
                self.mode = "idle"

    def settled(self) -> None:
        """Wait until no change is under way.

        A click on another page, or a reload, starts a script of its own while the step that was
        clicked before is still being decided. Drawn at once it would show the run before that
        step, and stay so.
        """
        with self._lock:
            return

    def undo(self) -> None:
        """Take back the last change, whatever it was."""
        with self._lock:
            self.mode = "idle"
            if self._past:
                self.prompted = None
                self.run = self._past.pop()
                self.keeper.keep(self.run)

    @property
    def can_undo(self) -> bool:
        """Whether there is a change to take back."""
        return bool(self._past)

    def step(self) -> None:
        """Decide one interval."""
        self._change(runs.decided)
        if self.run.answer is not None:  # nobody can decide it
            self.mode = "idle"
        self._stepped_at = time.monotonic()

    def seconds_since_step(self) -> float:
        """How long the last step has been on the screen."""
        return time.monotonic() - self._stepped_at

    def back(self) -> None:
        """Undo the last step."""
        self.mode = "idle"
        self._change(runs.stepped_back)

    def reset(self) -> None:
        """Return to the start of the day."""
        self.mode = "idle"
        self._change(runs.restarted)

    def restore(self) -> None:
        """Return to the settings of the preset."""
        self._change(runs.restored)

    def set_mode(self, mode: Mode) -> None:
        """Play, run to the end, or stop doing so."""
        self.mode = mode

    def edit(
        self,
        title: str,
        settings: Mapping[str, object],
        price_per_kwh: tuple[float, ...] | None = None,
    ) -> None:
        """Change settings from now on."""
        self._change(lambda run: runs.edited(run, title, settings, price_per_kwh))

    def happen(self, event: Event, before: Trace, after: Trace) -> None:
        """Let an event happen now; `after` is what it makes of `before`, worked out already."""
        self._change(lambda run: runs.happened(run, event, before, after))

    def press(self, key: str) -> None:
        """Do what a prompt asks for of the run as it is now, and remember the run before it."""
        before = self.run
        prompt = next(prompt for prompt in prompts(before) if prompt.key == key)
        if prompt.change is not None:
            self._change(prompt.change)
        changed = self.run.trace is not before.trace
        self.prompted = Prompted(prompt.label, before, self.run) if changed else None

    def dismiss(self) -> None:
        """Tell no more what the last prompt did."""
        self.prompted = None

    def visit(self, guest: Arrival) -> None:
        """Have one more vehicle come now."""
        self._change(lambda run: runs.visited(run, guest))

    def hand_to(self, policy: str) -> None:
        """Have another policy decide the day, from its start."""
        self.mode = "idle"
        self._change(lambda run: runs.handed_to(run, policy))

    def rewire(self, network: Network) -> None:
        """Keep the limits of another network model from now on."""
        self._change(lambda run: runs.rewired(run, network))

    def run_again_in(self, network: Network) -> None:
        """Run the day from its start to its end, limits kept in this network model."""
        self._change(lambda run: runs.restarted(run, network))
        self.mode = "finishing"

    def open(self, folder: Path) -> None:
        """Open another bundled scenario."""
        self.take(runs.open_run(folder, bundled(folder)))

    def take(self, run: Run) -> None:
        """Go on with another run in place of this one."""
        self.prompted = None
        self.mode = "idle"
        self._change(lambda _: run)

    def once(self, name: str, make: Callable[[], T], detail: Hashable = None) -> T:
        """What `make` gives, made anew only for another trace or detail; the last is kept."""
        trace = self.run.trace
        known = self._drawn.get(name)
        if known is None or known[0] is not trace or known[1] != detail:
            known = (trace, detail, make())
            self._drawn[name] = known
        made: T = known[2]
        return made


@lru_cache(maxsize=32)
def bundled(folder: Path) -> Scenario:
    """A bundled scenario, read once."""
    return read_scenario(folder)


@lru_cache(maxsize=1)
def bundled_names() -> dict[str, Path]:
    """Folder of every bundled scenario by its folder's name, the default first."""
    return {folder.name: folder for folder in bundled_scenarios()}


def current() -> Session:
    """This tab's session: the run the address links to, or a new day of the preset it names."""
    if KEY not in st.session_state:
        st.session_state[KEY] = _begun()
    session: Session = st.session_state[KEY]
    session.settled()
    return session


def await_changes(link: str) -> None:
    """Wait until no tab of this server is changing the run of a link.

    Who reloads in mid-step gets a new session, which would else read the run before the step
    that the old one is about to keep.
    """
    with _opening:
        same = [session for session in _open if session.keeper.link == link]
    for session in same:
        session.settled()


def _begun() -> Session:
    run, keeper = None, Keeper()
    if link := st.query_params.get(keeping.LINK):
        await_changes(link)
        run, keeper = keeping.resume(link)
    if run is None:
        asked = st.query_params.get(PRESET, "")
        folder = bundled_names().get(asked, DEFAULT)
        run = runs.open_run(folder, bundled(folder))
        if asked and asked != folder.name:
            keeper.said = f"{keeper.said} {no_preset(asked, bundled(folder).name)}".strip()
    return Session(run, keeper)


def no_preset(asked: str, opened: str) -> str:
    """What is said of an address that names a preset there is none of."""
    names = ", ".join(plain(name) for name in bundled_names())
    return (
        f"This address asks for a preset called {plain(legible(asked))}, and there is none: "
        f"{plain(opened)} was opened. Presets are {names}."
    )
