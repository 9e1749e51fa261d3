"""The draft a tab is working on: what was typed so far, what it came from, what was said of it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import streamlit as st

from evdash.domain.arrivals import GeneratedArrivals
from evdash.domain.scenario import Scenario
from evdash.errors import Fault, InputError
from evdash.files.draft import Draft, Rows, draft_of, files_of, scenario_of
from evdash.files.scenario_folder import SETTINGS
from evdash.files.validate import Raw
from evdash.imports.scenario_book import ScenarioBook
from evdash.ui.downloads import Rest
from evdash.ui.edits import with_settings_kept
from evdash.ui.scenario.waiting import WaitingNetwork, WaitingTable
from evdash.ui.session import Session

KEY = "evdash:draft"
MOST_ROWS = 5_000
MOST_INTERVALS = 1_000
MOST_UNDONE, MOST_ROWS_UNDONE = 10, 100_000
"""So many drafts can be had back, the latest ones, as long as they have no more rows in all."""
CAP = "more than the app takes at a time; the command line takes more"


@dataclass(frozen=True, slots=True)
class Said:
    """What the page has to say of the last thing taken in."""

    title: str
    faults: tuple[Fault, ...] = ()
    notes: tuple[str, ...] = ()


class Editor:
    """One tab's draft. Widgets never own it: what is typed is laid over it before all else.

    `shown` is what each widget showed last, so that a difference is known for an edit, and
    `laid` how an edit is laid over the draft, by the widgets' keys; `revision` of a table counts
    how often it was replaced from elsewhere, as a table editor keeps only differences to what it
    was first given; `text` is a scenario.toml as typed that cannot be taken over yet.
    """

    def __init__(self, scenario: Scenario, rest: Rest) -> None:
        self.base = scenario
        self.rest = rest
        self.draft = self.clean = draft_of(scenario)
        self.shown: dict[str, object] = {}
        self.laid: dict[str, Callable[[Any], None]] = {}
        self.bases: dict[str, Rows] = {}
        self.text: str | None = None
        self.revision = 0
        self.said: Said | None = None
        self.uploads = 0
        self.not_kept = ""
        self.waiting: WaitingTable | None = None
        self.network: WaitingNetwork | None = None
        self._number = 0
        self._came: dict[str, tuple[object, ScenarioBook]] = {}
        self._before: list[Draft] = []
        self._checked: tuple[Draft, Scenario | None, tuple[Fault, ...]] | None = None

    @property
    def is_edited(self) -> bool:
        """Whether anything differs from the scenario the draft began from."""
        return files_of(self.draft) != files_of(self.clean)

    @property
    def can_undo(self) -> bool:
        return bool(self._before)

    def next_number(self) -> int:
        """A number of its own for whatever comes to wait."""
        self._number += 1
        return self._number

    def take(
        self, draft: Draft, said: Said | None = None, books: Sequence[ScenarioBook] = ()
    ) -> None:
        """Replace the draft as a whole; what it was can be had back.

        What `books` hold is told by sheet and row as long as it stands as it came.
        """
        self._before = [*self._before, self.draft][-MOST_UNDONE:]
        while len(self._before) > 1 and sum(map(_rows_in, self._before)) > MOST_ROWS_UNDONE:
            self._before.pop(0)
        self._show(draft)
        self.said = said
        for book in books:
            self._came |= {file: (_part(draft, file), book) for file in book.files}

    def undo(self) -> None:
        """Back to before the last replacement."""
        if self._before:
            self._show(self._before.pop())
            self.said = None

    def follow(self, scenario: Scenario) -> None:
        """Show another scenario as it is, and call it the one begun from."""
        self.base, self.clean = scenario, draft_of(scenario)
        self._before = []
        self._show(self.clean)
        self.said = None

    def _show(self, draft: Draft) -> None:
        self.draft = draft
        self.text = None
        self.revision += 1

    def get(self, path: tuple[str, ...]) -> Any:
        """The value of a key of scenario.toml; None where it is not there."""
        node: Any = self.draft.settings
        for part in path:
            if not isinstance(node, dict) or part not in node:
                return None
            node = node[part]
        return node

    def set(self, path: tuple[str, ...], value: object) -> None:
        """Lay a value over a key; None takes the key out."""
        self.draft = self.draft.with_settings(_laid(self.draft.settings, path, value))

    def set_rows(self, file: str, rows: Rows) -> None:
        """Lay rows over a table."""
        self.draft = self.draft.with_table(file, rows)

    def take_typed(self) -> bool:
        """Lay all over the draft that was typed since it was shown. It can take anything."""
        for key, lay in self.laid.items():
            if key in st.session_state and st.session_state[key] != self.shown[key]:
                self.shown[key] = st.session_state[key]
                lay(st.session_state[key])
        return True

    def check(self) -> tuple[Scenario | None, tuple[Fault, ...]]:
        """The scenario the draft stands for, or every fault that keeps it from being one."""
        if self._checked is None or self._checked[0] is not self.draft:
            scenario, faults = _checked(self.draft)
            self._checked = (self.draft, scenario, tuple(self._placed(f) for f in faults))
        return self._checked[1:]

    def _placed(self, fault: Fault) -> Fault:
        """A fault where its part of the draft came from, if that stands as it came."""
        file = fault.place.partition(",")[0]
        came, book = self._came.get(file, (None, None))
        if book is None or came is not _part(self.draft, file):
            return fault
        return book.placed([fault])[0]


def _rows_in(draft: Draft) -> int:
    return sum(len(rows) for rows in draft.tables.values())


def _part(draft: Draft, file: str) -> object:
    """What a draft has of a file, the same object as long as nobody changes it."""
    return draft.settings if file == SETTINGS else draft.tables.get(file)


def _laid(node: Raw, path: tuple[str, ...], value: object) -> Raw:
    head, *rest = path
    if rest:
        inner = node.get(head)
        return node | {head: _laid(inner if isinstance(inner, dict) else {}, tuple(rest), value)}
    if value is None:
        return {key: kept for key, kept in node.items() if key != head}
    return node | {head: value}


def _checked(draft: Draft) -> tuple[Scenario | None, tuple[Fault, ...]]:
    faults = [
        Fault(file, f"{len(rows):,} rows", f"at most {MOST_ROWS:,}: {CAP}")
        for file, rows in draft.tables.items()
        if len(rows) > MOST_ROWS
    ]
    if faults:
        return None, tuple(faults)
    try:
        scenario = scenario_of(draft)
    except InputError as error:
        return None, error.faults
    known = scenario.arrivals
    if scenario.intervals > MOST_INTERVALS:
        rule = f"at most {MOST_INTERVALS:,}: {CAP}"
        faults.append(Fault("scenario.toml, intervals", f"{scenario.intervals:,}", rule))
    if isinstance(known, GeneratedArrivals):
        days = scenario.intervals * scenario.interval_hours / 24
        if (expected := known.vehicles_per_day * days) > MOST_ROWS:
            place = "scenario.toml, arrivals.vehicles_per_day"
            found = f"{known.vehicles_per_day:,g}, or {expected:,.0f} vehicles in all"
            faults.append(Fault(place, found, f"at most {MOST_ROWS:,} in all: {CAP}"))
    return (None, tuple(faults)) if faults else (scenario, ())


def current_editor(session: Session) -> Editor:
    """This tab's draft. As long as nothing in it was edited it follows the present run."""
    scenario = present_scenario(session)
    if KEY not in st.session_state:
        st.session_state[KEY] = Editor(scenario, session.rest)
    editor: Editor = st.session_state[KEY]
    if not editor.is_edited and editor.base != scenario:
        editor.follow(scenario)
    return editor


def present_scenario(session: Session) -> Scenario:
    """What another run of the present day would begin with: its settings as they are now."""
    run = session.run
    return session.once("present", lambda: with_settings_kept(run.trace, run.opened))
