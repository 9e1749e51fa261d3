"""Files that wait for the user's word before anything of them is taken in."""

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

from evdash.errors import InputError
from evdash.grid.nets.records import Net
from evdash.imports.feeder import ImportedFeeder, feeder_of_net
from evdash.imports.tables import ForeignTable

T = TypeVar("T")


@dataclass(slots=True)
class WaitingTable:
    """Tables of any columns in one file, by sheet, and the sheet that is meant.

    `number` tells it from others of its name; `taken` once it was taken in, when it stays so that
    other days of it can be chosen.
    """

    tables: Mapping[str, ForeignTable]
    number: int
    sheet: str = ""
    taken: bool = False
    _known: tuple[Hashable, Any] | None = None

    def __post_init__(self) -> None:
        self.sheet = self.sheet or next(iter(self.tables))

    @property
    def table(self) -> ForeignTable:
        """The table of the sheet that is meant."""
        return self.tables[self.sheet]

    @property
    def key(self) -> str:
        """What the keys of this table's widgets begin with."""
        return f"table:{self.number}:{self.sheet}"

    def once(self, key: Hashable, make: Callable[[], T]) -> T:
        """What `make` gives, made anew only for another key."""
        if self._known is None or self._known[0] != key:
            self._known = (key, make())
        made: T = self._known[1]
        return made


@dataclass(slots=True)
class WaitingNetwork:
    """A network as read, and what was not read of it; converted for a source when asked for."""

    name: str
    net: Net
    unread: tuple[str, ...]
    number: int
    _feeders: dict[str | None, ImportedFeeder | InputError] = field(default_factory=dict)

    def feeder(self, source: str | None) -> ImportedFeeder:
        """The feeder supplied from a bus; InputError where it cannot be one."""
        if source not in self._feeders:
            try:
                self._feeders[source] = feeder_of_net(self.net, self.unread, source)
            except InputError as error:
                self._feeders[source] = error
        found = self._feeders[source]
        if isinstance(found, InputError):
            raise found
        return found
