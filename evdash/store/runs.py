"""Runs under links nobody can guess: kept change by change, brought back, pinned, pruned."""

import secrets
import sqlite3
import time
from dataclasses import dataclass
from pathlib import Path

from evdash.errors import StoreUnavailable
from evdash.store.database import Database
from evdash.store.parts import DamagedPart, Kept, Known, Putting, Taking

LINK_BYTES = 16
DAY_SECONDS = 86_400.0
MOST_DAYS, MOST_RUNS, MOST_BYTES = 90.0, 2_000, 500_000_000
"""A run goes when nobody has changed it for so long, or to make room for others: first the oldest
of whoever has most."""
DOUBT_SECONDS = 3 * DAY_SECONDS
"""So long after it was first found too old a run still stays."""
PRUNE_EVERY = 200
OLDEST_SHARE = 10
BYTES = (
    "(SELECT sum(length(body)) FROM runs AS own JOIN uses ON uses.link = own.link JOIN parts "
    "USING (name) WHERE own.link = runs.link OR own.pinned_by = runs.link)"
)
"""SQL for what a run and its pins take, shared parts included."""
FAIR_SHARE = 10
"""Who holds less than one such part of all bytes is not asked to make room for others' runs."""


def new_link() -> str:
    """A link of 128 random bits."""
    return secrets.token_urlsafe(LINK_BYTES)


@dataclass(frozen=True, slots=True)
class Limits:
    """How much is kept, and for how long."""

    days: float = MOST_DAYS
    runs: int = MOST_RUNS
    size_bytes: int = MOST_BYTES


@dataclass(frozen=True, slots=True)
class Pin:
    """A run put aside beside another one, under a link of its own."""

    link: str
    title: str


class Store:
    """All runs kept in one folder."""

    def __init__(self, directory: Path, limits: Limits | None = None) -> None:
        self.database = Database(directory)
        self.limits = limits or Limits()
        self._writes = 0

    def write(
        self, link: str, version: int, kept: Kept, known: Known, visitor: str | None = None
    ) -> tuple[str, Known]:
        """Keep the next version of a run, whole; the link it is kept under, and its parts.

        `visitor` is who has it if it is new; None where that cannot be told.

        That is another link where the run has been changed by somebody else since: what
        they did stays theirs, and this becomes a copy, pins and all.
        """
        with self.database.transaction() as data:
            row = data.execute("SELECT version FROM runs WHERE link = ?", (link,)).fetchone()
            # parts of a run that is no longer there, or in another file, may be gone with it
            there = _parts_of(data, link)
            taken = Taking({at: part for at, part in known.items() if part[1] in there})
            manifest = taken.manifest(kept)
            origin = link
            if row is not None and row[0] != version:
                link, row = new_link(), None
            if row is None:
                _insert(data, link, manifest)
                if visitor is not None:
                    data.execute("INSERT INTO begun_by VALUES (?, ?)", (link, visitor))
            data.execute(
                "UPDATE runs SET version = ?, manifest = ?, touched = ? WHERE link = ?",
                (version + 1, manifest, time.time(), link),
            )
            _use(data, link, taken)
            if link != origin:
                _copy_pins(data, origin, link)
            if self._writes % PRUNE_EVERY == 0:
                prune(data, self.limits)
            self._writes += 1
        return link, taken.known

    def read(self, link: str) -> tuple[int, Kept, Known] | None:
        """A run with its version, or None where there is none under this link."""
        with self.database.transaction() as data:
            row = data.execute(
                "SELECT version, manifest FROM runs WHERE link = ?", (link,)
            ).fetchone()
            if row is None:
                return None
            select = "SELECT parts.name, body FROM uses JOIN parts USING (name) WHERE uses.link = ?"
            bodies: dict[str, bytes] = dict(data.execute(select, (link,)).fetchall())
        putting = Putting(bodies.__getitem__)
        try:
            return int(row[0]), putting.kept(row[1]), putting.known
        except DamagedPart as error:
            raise StoreUnavailable(f"{self.database.path}: {error}") from error
        except ValueError as error:
            raise StoreUnavailable(
                f"{self.database.path}: the run was kept by another version of evdash"
            ) from error

    def pin(self, owner: str, kept: Kept, title: str) -> Pin:
        """Put a run aside as it is now. It stays as long as the run `owner` does."""
        taken = Taking({})
        manifest = taken.manifest(kept)
        pin = Pin(new_link(), title)
        with self.database.transaction() as data:
            _insert(data, pin.link, manifest, owner, title)
            _use(data, pin.link, taken)
        return pin

    def pins(self, owner: str) -> list[Pin]:
        """What was put aside beside a run, the first one first."""
        select = "SELECT link, title FROM runs WHERE pinned_by = ? ORDER BY touched, link"
        with self.database.transaction() as data:
            return [Pin(link, title) for link, title in data.execute(select, (owner,)).fetchall()]

    def unpin(self, pin: Pin) -> None:
        """Let a pinned run go."""
        with self.database.transaction() as data:
            data.execute("DELETE FROM runs WHERE link = ? AND pinned_by IS NOT NULL", (pin.link,))


def _insert(
    data: sqlite3.Connection, link: str, manifest: str, owner: str | None = None, title: str = ""
) -> None:
    data.execute(
        "INSERT INTO runs (link, version, manifest, touched, pinned_by, title) "
        "VALUES (?, 1, ?, ?, ?, ?)",
        (link, manifest, time.time(), owner, title),
    )


def _parts_of(data: sqlite3.Connection, link: str) -> set[str]:
    """Names of the parts a run is made of as it is kept."""
    return {name for (name,) in data.execute("SELECT name FROM uses WHERE link = ?", (link,))}


def _use(data: sqlite3.Connection, link: str, taken: Taking) -> None:
    """Keep the run's new parts, and remember which ones it is made of.

    Parts it is no longer made of are let go by pruning, with those of runs that are gone.
    """
    data.executemany(
        "INSERT INTO parts VALUES (?, ?) ON CONFLICT (name) DO UPDATE SET body = excluded.body "
        "WHERE body <> excluded.body",  # one there already may be damaged, and the run with it
        taken.new.items(),
    )
    known = _parts_of(data, link)
    data.executemany(
        "INSERT INTO uses VALUES (?, ?)", [(link, name) for name in taken.names - known]
    )
    data.executemany(
        "DELETE FROM uses WHERE link = ? AND name = ?",
        [(link, name) for name in known - taken.names],
    )


def _copy_pins(data: sqlite3.Connection, origin: str, link: str) -> None:
    select = "SELECT link, manifest, title FROM runs WHERE pinned_by = ? ORDER BY touched, link"
    for pinned, manifest, title in data.execute(select, (origin,)).fetchall():
        copy = new_link()
        _insert(data, copy, manifest, link, title)
        data.execute(
            "INSERT INTO uses SELECT ?, name FROM uses WHERE link = ?",
            (copy, pinned),
        )


def prune(data: sqlite3.Connection, limits: Limits) -> None:
    """Let go of runs that are too old or too many, then of parts that belong to none."""
    _drop_aged(data, time.time(), limits.days * DAY_SECONDS)
    _drop(data, _count(data) - limits.runs, "1", 0)
    _drop_unused(data)
    while (count := _count(data)) > 1 and _size_bytes(data) > limits.size_bytes:
        _drop(data, -(-count // OLDEST_SHARE), BYTES, limits.size_bytes // FAIR_SHARE)
        _drop_unused(data)


def _drop_aged(data: sqlite3.Connection, now: float, most_seconds: float) -> None:
    """Let go of runs found too old twice, DOUBT_SECONDS apart: a clock may be wrong once."""
    aged = "SELECT link FROM runs WHERE pinned_by IS NULL AND touched < ?"
    data.execute(f"DELETE FROM doomed WHERE link NOT IN ({aged})", (now - most_seconds,))  # noqa: S608
    data.execute("UPDATE doomed SET since = ? WHERE since > ?", (now, now))
    data.execute(
        "DELETE FROM runs WHERE link IN (SELECT link FROM doomed WHERE since <= ?)",
        (now - DOUBT_SECONDS,),
    )
    data.execute(
        f"INSERT OR IGNORE INTO doomed SELECT link, ? FROM ({aged})",  # noqa: S608 - no user's text
        (now, now - most_seconds),
    )


def _count(data: sqlite3.Connection) -> int:
    return int(data.execute("SELECT count(*) FROM runs WHERE pinned_by IS NULL").fetchone()[0])


def _size_bytes(data: sqlite3.Connection) -> int:
    select = (
        "SELECT (SELECT coalesce(sum(length(body)), 0) FROM parts)"
        " + (SELECT coalesce(sum(length(manifest)), 0) FROM runs)"
    )
    return int(data.execute(select).fetchone()[0])


def _drop(data: sqlite3.Connection, number: int, weight: str, fair: int) -> None:
    """Let go of so many runs: those of whoever has most newer ones, and of these the oldest.

    `weight` is what a run counts as. Newer ones of up to `fair` count alike, so that the oldest
    goes, whosever it is. A run of nobody known is the only one of its owner.
    """
    data.execute(
        "WITH newer AS (SELECT runs.link, touched, coalesce(sum("  # noqa: S608 - no user's text
        f"{weight}) OVER (PARTITION BY coalesce(visitor, runs.link) ORDER BY touched DESC, "
        "runs.link ROWS BETWEEN UNBOUNDED PRECEDING AND 1 PRECEDING), 0) AS held"
        " FROM runs LEFT JOIN begun_by USING (link) WHERE pinned_by IS NULL) "
        "DELETE FROM runs WHERE link IN "
        "(SELECT link FROM newer ORDER BY max(held, ?) DESC, touched LIMIT ?)",
        (fair, max(0, number)),
    )


def _drop_unused(data: sqlite3.Connection) -> None:
    data.execute("DELETE FROM parts WHERE name NOT IN (SELECT name FROM uses)")
