"""How a tab's run outlives the tab: kept after every change, brought back by its link."""

from functools import lru_cache

from evdash.errors import StoreUnavailable
from evdash.files.bundled import bundled_scenarios
from evdash.store.journal import Journal
from evdash.store.parts import Kept
from evdash.store.place import store_directory
from evdash.store.runs import Store
from evdash.ui.run import Run
from evdash.ui.visitors import visitor
from evdash.ui.words import plain

LINK = "run"
"""What the address calls the run."""
OWN = ""
"""The source of a scenario of the user's own."""
GONE = "The run of this link is not kept any more. A new day has begun."
COPIED = (
    "This run was changed in another tab meanwhile. Nothing is lost: here it goes on as a copy, "
    "with a link of its own."
)


@lru_cache(maxsize=1)
def store() -> Store:
    """Where this server keeps runs."""
    return Store(store_directory())


class Keeper:
    """Keeps a run after every change. What goes wrong is told and never stops the run.

    `link` is empty until something has been kept. `said` is what a person should know.
    """

    def __init__(self, journal: Journal | None = None, said: str = "") -> None:
        self._visitor = visitor()
        self._journal = journal
        self.link = journal.link if journal else ""
        self.said = said

    def keep(self, run: Run) -> None:
        """Keep the run as it now is."""
        journal = self._journal = self._journal or Journal(store(), visitor=self._visitor)
        before = journal.link
        try:
            journal.keep(kept_form(run))
        except StoreUnavailable as error:
            self.said = (
                f"This run will not outlast this tab; it could not be kept. {plain(f'{error}')}"
            )
        else:
            self.link = journal.link
            self.said = COPIED if journal.link != before else ""


def resume(link: str) -> tuple[Run | None, Keeper]:
    """The run of a link and its keeper, or none where it cannot be brought back."""
    try:
        found = Journal.resume(store(), link, visitor())
    except StoreUnavailable as error:
        return None, Keeper(said=f"This link's run could not be opened. {plain(f'{error}')}")
    if found is None:
        return None, Keeper(said=GONE)
    journal, kept = found
    return run_of(kept), Keeper(journal)


def kept_form(run: Run) -> Kept:
    """A run as the store keeps it."""
    return Kept(run.folder.name if run.folder else OWN, run.opened, run.trace)


def run_of(kept: Kept) -> Run:
    """A run as the app holds it."""
    folders = {folder.name: folder for folder in bundled_scenarios()}
    return Run(folders.get(kept.source), kept.opened, kept.trace)
