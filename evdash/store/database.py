"""The file runs are kept in: SQLite, written as a whole or not at all."""

import random
import sqlite3
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

from evdash.errors import StoreUnavailable

FORMAT = 1
"""Version of what is in the file; another version is refused, never guessed at."""
NAME = "runs.sqlite3"
PATIENCE_SECONDS = 10.0
"""How long to wait for other processes that are just writing, in all."""
WAIT_SECONDS = 0.05
"""How long SQLite itself waits at a time. It looks ever more rarely and always in the same rhythm,
so that who writes without pause could keep another out; between two waits there is a random one."""
PAUSE_SECONDS = 0.03
DAMAGED = (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB)
SCHEMA = """
CREATE TABLE runs (
    link TEXT PRIMARY KEY,
    version INTEGER NOT NULL,
    manifest TEXT NOT NULL,
    touched REAL NOT NULL,
    pinned_by TEXT REFERENCES runs (link) ON DELETE CASCADE,
    title TEXT NOT NULL DEFAULT ''
) WITHOUT ROWID;
CREATE INDEX runs_pinned ON runs (pinned_by);
CREATE INDEX runs_touched ON runs (touched);
CREATE TABLE parts (name TEXT PRIMARY KEY, body BLOB NOT NULL);
CREATE TABLE uses (
    link TEXT NOT NULL REFERENCES runs (link) ON DELETE CASCADE,
    name TEXT NOT NULL REFERENCES parts (name),
    PRIMARY KEY (link, name)
) WITHOUT ROWID;
CREATE INDEX uses_name ON uses (name);
"""
ADDED = """
CREATE TABLE IF NOT EXISTS doomed (
    link TEXT PRIMARY KEY REFERENCES runs (link) ON DELETE CASCADE,
    since REAL NOT NULL
) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS begun_by (
    link TEXT PRIMARY KEY REFERENCES runs (link) ON DELETE CASCADE,
    visitor TEXT NOT NULL
) WITHOUT ROWID;
"""
"""What versions before did not know and do not mind: runs too old, and since when that is known;
who began a run."""
Identity = tuple[tuple[int, int] | None, ...]
"""Which files these are, whatever they are called: device and number of the file and its -wal."""


class Database:
    """One connection for all threads of this process, opened when first needed.

    Whatever goes wrong with the file or its place is told as StoreUnavailable, in words.
    """

    def __init__(self, directory: Path) -> None:
        self.path = directory / NAME
        self._lock = threading.Lock()
        self._connection: sqlite3.Connection | None = None
        self._identity: Identity = ()

    @contextmanager
    def transaction(self) -> Iterator[sqlite3.Connection]:
        """A connection whose changes are all kept at the end, or none of them.

        Where the file was deleted or moved meanwhile, that of another one under its name.
        """
        with self._lock:
            try:
                if self._connection is not None and self._identity != self._found():
                    self._let_go()
                connection = self._connection = self._connection or self._opened()
                self._identity = self._found()
                _begin(connection)
                try:
                    yield connection
                    connection.execute("COMMIT")
                except BaseException:
                    _roll_back(connection)
                    raise
                self._identity = self._found()
            except (sqlite3.Error, OSError, UnicodeDecodeError, _OtherTables) as error:
                opened = self._identity
                self._let_go()
                raise StoreUnavailable(
                    f"{self.path}: {_told(error)}{self._aside(error, opened)}"
                ) from error

    def close(self) -> None:
        """Let go of the file."""
        with self._lock:
            self._let_go()

    def _let_go(self) -> None:
        if self._connection is not None:
            self._connection.close()
        self._connection = None
        self._identity = ()

    def _found(self) -> Identity:
        """The files that are there under our names now."""
        return tuple(_identity(self.path.with_name(self.path.name + end)) for end in ("", "-wal"))

    def _aside(self, error: Exception, opened: Identity) -> str:
        """Put a damaged file aside, so that what comes next is kept in a new one; where it is.

        One server alone does it, and only while the file is the one found damaged: another may
        have done it already, and its new file is good.
        """
        if not _is_damage(error):
            return ""
        try:
            with FileLock(self.path.with_name(f"{self.path.name}.aside"), PATIENCE_SECONDS):
                if opened[:1] not in ((), self._found()[:1]):
                    return (
                        "; another server has put it aside, and what follows is kept in a new file"
                    )
                return self._put_aside()
        except (OSError, Timeout) as failure:
            return f"; it could not be put aside ({failure})"

    def _put_aside(self) -> str:
        aside = self.path.with_name(f"damaged-{time.strftime('%Y%m%dT%H%M%S')}-{self.path.name}")
        self.path.rename(aside)
        for ending in ("-wal", "-shm"):  # they belong to the damaged file and to no other
            beside = self.path.with_name(self.path.name + ending)
            if beside.exists():
                beside.rename(f"{aside}{ending}")
        return f"; it was put aside as {aside.name}, and what follows is kept in a new file"

    def _opened(self) -> sqlite3.Connection:
        self.path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        connection = sqlite3.connect(
            self.path, timeout=WAIT_SECONDS, isolation_level=None, check_same_thread=False
        )
        connection.text_factory = _text
        try:
            self._identity = self._found()
            _patiently(connection, "PRAGMA journal_mode = WAL")
            connection.execute("PRAGMA synchronous = FULL")  # a power cut takes no step back
            connection.execute("PRAGMA foreign_keys = ON")
            self._made(connection)
        except BaseException:
            connection.close()
            raise
        return connection

    def _made(self, connection: sqlite3.Connection) -> None:
        """The tables, made in a new file; an older or newer file is refused."""
        _begin(connection)
        found = connection.execute("PRAGMA user_version").fetchone()[0]
        if found == 0:
            for statement in SCHEMA.split(";"):
                connection.execute(statement)
            connection.execute(f"PRAGMA user_version = {FORMAT}")
        if found in (0, FORMAT):
            for statement in ADDED.split(";"):
                connection.execute(statement)
        connection.execute("COMMIT")
        if found not in (0, FORMAT):
            raise StoreUnavailable(
                f"{self.path}: its format is {found}, this version of evdash keeps {FORMAT}; "
                "move the file away or name another folder in EVDASH_STORE"
            )
        if not OWN_TABLES.items() <= _tables(connection).items():  # a later version may add some
            raise _OtherTables("its tables are not those that evdash makes")


def _text(stored: bytes) -> str:
    """Text as it is stored; damaged, as what nothing equals, where Python would have no word."""
    return stored.decode("utf-8", "replace")


class _OtherTables(Exception):
    """A file of our format whose tables are not ours: its list of tables is damaged."""


def _tables(connection: sqlite3.Connection) -> dict[str, str]:
    """What every table and index was made with, by name."""
    found = connection.execute("SELECT name, sql FROM sqlite_master").fetchall()
    return {name: " ".join((sql or "").split()) for name, sql in found}


def _own_tables() -> dict[str, str]:
    with closing(sqlite3.connect(":memory:")) as connection:
        connection.executescript(SCHEMA + ADDED)
        return _tables(connection)


OWN_TABLES = _own_tables()


def _identity(path: Path) -> tuple[int, int] | None:
    try:
        found = path.stat()
    except FileNotFoundError:
        return None
    return found.st_dev, found.st_ino


def _is_damage(error: Exception) -> bool:
    """Whether the file itself is spoilt: SQLite says so, or its list of tables is not text."""
    if isinstance(error, sqlite3.Error):
        return _kind(error) in DAMAGED
    return isinstance(error, UnicodeDecodeError | _OtherTables)


def _begin(connection: sqlite3.Connection) -> None:
    """Become the one that writes."""
    _patiently(connection, "BEGIN IMMEDIATE")


def _patiently(connection: sqlite3.Connection, statement: str) -> None:
    """Execute a statement as soon as nobody else is writing; raises sqlite3.Error if never."""
    until = time.monotonic() + PATIENCE_SECONDS
    while True:
        try:
            connection.execute(statement)
        except sqlite3.OperationalError as error:
            if _kind(error) != sqlite3.SQLITE_BUSY or time.monotonic() >= until:
                raise
            time.sleep(random.uniform(0, PAUSE_SECONDS))  # noqa: S311 - nothing secret
        else:
            return


def _kind(error: sqlite3.Error) -> int:
    """SQLite's own code of an error, without what it adds to say it more closely."""
    return int(getattr(error, "sqlite_errorcode", 0)) & 0xFF


def _told(error: Exception) -> str:
    """An error in words: SQLite's own, but for the one people meet without any fault of theirs."""
    if isinstance(error, sqlite3.Error) and _kind(error) == sqlite3.SQLITE_BUSY:
        return (
            f"other servers kept writing for {PATIENCE_SECONDS:g} s; "
            "the next change is kept together with this one"
        )
    if isinstance(error, UnicodeDecodeError):
        return "what it holds is not text where text should be"
    return str(error)


def _roll_back(connection: sqlite3.Connection) -> None:
    if connection.in_transaction:
        connection.execute("ROLLBACK")
