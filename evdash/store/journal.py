"""One run on its way to disk, change by change."""

from typing import Self

from evdash.store.parts import Kept, Known
from evdash.store.runs import Store, new_link


class Journal:
    """Where a run is kept: its link, the version last written or read, and its parts.

    Two tabs may open the same link. The first to change the run keeps the link; the other's
    next change is kept under a link of its own, which is then `link`. Neither loses anything.
    `visitor` is who a new run counts as; None where that cannot be told.
    """

    def __init__(
        self,
        store: Store,
        link: str = "",
        version: int = 0,
        known: Known | None = None,
        visitor: str | None = None,
    ) -> None:
        self.link = link or new_link()
        self.store = store
        self._version = version
        self._known: Known = known or {}
        self._visitor = visitor

    @classmethod
    def resume(
        cls, store: Store, link: str, visitor: str | None = None
    ) -> tuple[Self, Kept] | None:
        """The run of a link as it was left, ready to go on; None where there is none."""
        found = store.read(link)
        if found is None:
            return None
        version, kept, known = found
        return cls(store, link, version, known, visitor), kept

    def keep(self, kept: Kept) -> None:
        """Keep the run as it now is; raises StoreUnavailable, and then nothing has changed."""
        self.link, self._known = self.store.write(
            self.link, self._version, kept, self._known, self._visitor
        )
        self._version += 1
