"""Runs set aside under a name, kept on disk beside the run they were pinned from."""

import threading
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import streamlit as st

from evdash.domain.scenario import Scenario
from evdash.domain.trace import PAPERS, Trace
from evdash.errors import StoreUnavailable
from evdash.metrics.key_figures import common_steps, until
from evdash.policies.registry import described
from evdash.store.runs import Pin as KeptPin
from evdash.ui import run as runs
from evdash.ui.edits import with_settings_kept
from evdash.ui.keeping import kept_form, run_of, store
from evdash.ui.run import Run
from evdash.ui.session import Session
from evdash.ui.settings import NETWORK_NAMES, changes

KEY = "evdash:pins"
MOST_PINS = 5
LONGEST_NAME = 60
PRESENT = "Present run"


@dataclass(frozen=True, slots=True)
class Pin:
    """A run as it stood when it was pinned, or since run on; `number` never comes twice."""

    number: int
    name: str
    run: Run


@dataclass(frozen=True, slots=True)
class Shelved:
    """A pin as it was kept last, and where."""

    kept: KeptPin
    pin: Pin


class Pins:
    """A tab's pins. As with the run, every change is one assignment under a lock.

    `said` is why they will not outlast the tab, if they will not.
    """

    def __init__(self) -> None:
        self.all: tuple[Pin, ...] = ()
        self.finishing = False
        self.said = ""
        self._owner = ""
        self._shelf: dict[int, Shelved] = {}
        self._given = 0
        self._lock = threading.Lock()

    @property
    def is_full(self) -> bool:
        return len(self.all) >= MOST_PINS

    def add(self, name: str, run: Run) -> None:
        """Pin a run; nothing happens where there is no room for one more."""
        with self._lock:
            if self.is_full:
                return
            self._given += 1
            name = self._free_name(name or suggested_name(run))
            self.all = (*self.all, Pin(self._given, name, run))

    def remove(self, number: int) -> None:
        """Take a pin away."""
        with self._lock:
            self.all = tuple(pin for pin in self.all if pin.number != number)

    def rename(self, number: int, name: str) -> None:
        """Call a pin by another name; a blank one changes nothing."""
        if name.strip():
            self._replace(number, lambda pin: replace(pin, name=self._free_name(name, number)))

    def step(self, number: int) -> None:
        """Decide one more interval of a pinned run."""
        self._replace(number, lambda pin: replace(pin, run=runs.decided(pin.run)))

    def keep(self, session: Session) -> None:
        """Have what is kept on disk say what is pinned; a run that goes on first finishes.

        Another link of the present run, under which it was brought back or goes on as a copy,
        has pins of its own: those are taken over.
        """
        try:
            if self.all and not session.keeper.link:
                session.keeper.keep(session.run)
            owner = session.keeper.link
            if owner and owner != self._owner:
                self._take_over(owner)
            if owner and not self.finishing:
                self._shelve(owner)
        except StoreUnavailable as error:
            self.said = f"Pins will not outlast this tab. {error}"
        else:
            self.said = ""

    def _take_over(self, owner: str) -> None:
        """The pins kept beside a run; those made in this tab meanwhile come after them."""
        found = []
        for kept in store().pins(owner):
            read = store().read(kept.link)
            if read is not None:
                self._given += 1
                pin = Pin(self._given, kept.title, run_of(read[1]))
                self._shelf[pin.number] = Shelved(kept, pin)
                found.append(pin)
        names = {pin.name for pin in found}
        self.all = (*found, *(pin for pin in self.all if pin.name not in names))[:MOST_PINS]
        self._owner = owner

    def _shelve(self, owner: str) -> None:
        pinned = {pin.number: pin for pin in self.all}
        for number, shelved in list(self._shelf.items()):
            if pinned.get(number) is not shelved.pin:
                store().unpin(shelved.kept)
                del self._shelf[number]
        for number, pin in pinned.items():
            if number not in self._shelf:
                kept = store().pin(owner, kept_form(pin.run), pin.name)
                self._shelf[number] = Shelved(kept, pin)

    def _replace(self, number: int, change: Callable[[Pin], Pin]) -> None:
        with self._lock:
            self.all = tuple(change(pin) if pin.number == number else pin for pin in self.all)

    def _free_name(self, name: str, own: int = 0) -> str:
        """The name, with a number behind it where another pin has it already."""
        name = name.strip()[:LONGEST_NAME]
        taken = {pin.name for pin in self.all if pin.number != own} | {PRESENT}
        others = (f"{name} ({n})" for n in range(2, MOST_PINS + 3))
        return name if name not in taken else next(o for o in others if o not in taken)


def current_pins(session: Session) -> Pins:
    """The pins of this tab, as they are kept beside its run."""
    if KEY not in st.session_state:
        st.session_state[KEY] = Pins()
    pins: Pins = st.session_state[KEY]
    pins.keep(session)
    return pins


def is_alike(a: Trace, b: Trace) -> bool:
    """Whether two days stand the same: inputs, what was decided, and what is planned."""
    if a is b:
        return True
    return (
        a.now == b.now
        and a.inputs.network == b.inputs.network
        and a.policy == b.policy
        and a.inputs.given == b.inputs.given
        and np.array_equal(a.state.tail_kw, b.state.tail_kw)
        and all(
            one.plan.vehicles == other.plan.vehicles
            and np.array_equal(one.plan.power_kw, other.plan.power_kw)
            for one, other in zip(a.steps, b.steps, strict=True)
        )
    )


def suggested_name(run: Run) -> str:
    """The scenario's name, and what was changed since it was opened."""
    now = run.trace.scenario
    what = [told.replace("\\", "") for told in changes(run.opened, now)]
    if run.trace.inputs.network != "lindistflow":
        what.append(NETWORK_NAMES[run.trace.inputs.network])
    if run.trace.policy != PAPERS:
        what.append(described(run.trace.policy).title)
    return ", ".join([now.name, *what])[:LONGEST_NAME]


@dataclass(frozen=True, slots=True)
class Held:
    """A run held against others: its name, all of it, and the part that all have come through."""

    name: str
    run: Run
    common: Trace

    @property
    def whole(self) -> Trace:
        return self.run.trace

    @property
    def scenario(self) -> Scenario:
        """What another run of its day would begin with: its settings as they are now."""
        return with_settings_kept(self.run.trace, self.run.opened)


def held_together(session: Session, pins: Pins) -> list[Held]:
    """All pins, and the present run unless it is pinned as it stands."""
    named = [(pin.name, pin.run) for pin in pins.all]
    if not any(is_alike(run.trace, session.run.trace) for _, run in named):
        named.append((PRESENT, session.run))
    counts = common_steps([run.trace for _, run in named])
    return [
        Held(name, run, until(run.trace, count))
        for (name, run), count in zip(named, counts, strict=True)
    ]
