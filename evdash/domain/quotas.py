"""How much of a server one visitor may hold, and all together: the limits and their words.

A server that is open to many is to have room for whoever comes next. Each limit is in the unit its
name says; who meets one is told what stands in the way and what to do.
"""

from collections.abc import Hashable, Iterable
from dataclasses import dataclass

from evdash.errors import EvdashError

MB = 1_000_000


class QuotaReached(EvdashError):
    """There is no room for more just now; says why and what to do."""


@dataclass(frozen=True, slots=True)
class Quota:
    """`each` for one visitor and `total` for the server, told by two sentences."""

    each: int
    total: int
    told_each: str
    told_total: str

    def check(self, own: int, everybody: int, more: int = 1) -> None:
        """Refuse `more` beside what one visitor and all hold; raises QuotaReached."""
        if own + more > self.each:
            raise QuotaReached(self.told_each)
        if everybody + more > self.total:
            raise QuotaReached(self.told_total)

    def check_one(self, visitor: Hashable, holders: Iterable[Hashable]) -> None:
        """Refuse one more to a visitor beside those of `holders`; raises QuotaReached.

        Nobody (None) is whoever sits at the server itself, and may hold as much as all.
        """
        held = list(holders)
        self.check(held.count(visitor) if visitor is not None else 0, len(held))


TABS = Quota(
    100,
    300,
    "100 pages of evdash are open from your address, and no more can be. Close some of them, wait "
    "a few seconds, and load this one again.",
    "300 pages are open on this server, and it has no room for more. Try again in a few minutes.",
)
"""Pages open at a time."""
UPLOADED_BYTES = Quota(
    40 * MB,
    200 * MB,
    "40 MB of files are on their way in from you, and no more can be. Bring them a few at a time: "
    "what was taken in or refused makes room.",
    "This server has 200 MB of files on their way in, and no room for more. Try again in a minute.",
)
"""Bytes of uploaded files that have not been taken in or refused yet."""
WAITING_RACES = Quota(
    5,
    20,
    "5 races from your address are waiting for their turn, and no more can. Stop one of them, or "
    "begin this one once one of them has begun.",
    "20 races are waiting for their turn on this server, and no more can. Try again in a few "
    "minutes.",
)
"""Races that wait for another one to end."""
WAITING_STUDIES = Quota(
    5,
    20,
    "5 studies from your address are waiting for their turn, and no more can. Cancel one of them, "
    "or begin this one once one of them has begun.",
    "20 studies are waiting for their turn on this server, and no more can. Try again later; this "
    "one can be saved as a file and run on the command line, too.",
)
"""Studies that wait for another one to end."""
MOST_STUDIES_EACH, MOST_STUDIES = 20, 500
"""Studies kept for an owner and by a server. More push out old ones, of whoever has most first."""
