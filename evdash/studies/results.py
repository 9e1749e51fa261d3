"""The results of a study on disk, in SQLite: each landed when it comes, and none lost by a kill."""

import json
import sqlite3
from collections.abc import Iterable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from evdash.domain.study import Result
from evdash.errors import StoreUnavailable

FORMAT = 1
"""Version of what is in the file; another version is refused, never guessed at."""
PATIENCE_SECONDS = 10.0
SCHEMA = """
CREATE TABLE IF NOT EXISTS results (
    key TEXT PRIMARY KEY,
    status TEXT NOT NULL,
    reason TEXT NOT NULL,
    figures TEXT NOT NULL,
    seconds REAL NOT NULL
) WITHOUT ROWID
"""
AT_ONCE = 500


class Results:
    """One file of results, by the key of the run each belongs to. Several processes may read
    while one writes."""

    def __init__(self, path: Path) -> None:
        self.path = path

    @contextmanager
    def _open(self) -> Iterator[sqlite3.Connection]:
        try:
            with closing(
                sqlite3.connect(self.path, timeout=PATIENCE_SECONDS, isolation_level=None)
            ) as data:
                data.execute("PRAGMA journal_mode = WAL")
                data.execute("PRAGMA synchronous = NORMAL")
                found = data.execute("PRAGMA user_version").fetchone()[0]
                if found not in (0, FORMAT):
                    raise StoreUnavailable(
                        f"{self.path}: its format is {found}, this version of evdash keeps {FORMAT}"
                    )
                data.execute(SCHEMA)
                data.execute(f"PRAGMA user_version = {FORMAT}")
                yield data
        except (sqlite3.Error, OSError) as error:
            raise StoreUnavailable(f"{self.path}: {error}") from error

    def make(self) -> None:
        """Make the file, empty, unless there is one."""
        with self._open():
            pass

    @contextmanager
    def writing(self) -> Iterator["Landing"]:
        """A way in for many results, each kept at once."""
        with self._open() as data:
            yield Landing(data)

    def read(self, keys: Iterable[str]) -> dict[str, Result]:
        """The results there are of these runs, by key."""
        wanted = list(keys)
        if not self.path.exists():
            return {}
        found: dict[str, Result] = {}
        with self._open() as data:
            for start in range(0, len(wanted), AT_ONCE):
                some = wanted[start : start + AT_ONCE]
                marks = ",".join("?" * len(some))
                rows = data.execute(f"SELECT * FROM results WHERE key IN ({marks})", some)  # noqa: S608
                found |= {row[0]: _result(row) for row in rows}
        return found

    def status_of(self, keys: Iterable[str]) -> dict[str, str]:
        """Which of these runs are done or have failed, by key."""
        if not self.path.exists():
            return {}
        with self._open() as data:
            known = dict(data.execute("SELECT key, status FROM results").fetchall())
        return {key: known[key] for key in keys if key in known}

    def content(self) -> bytes:
        """The whole file as it is at this moment, also while somebody writes it."""
        with self._open() as data:
            return data.serialize()

    def forget_failed(self) -> None:
        """Have every failed run be tried again."""
        if self.path.exists():
            with self._open() as data:
                data.execute("DELETE FROM results WHERE status = 'failed'")


class Landing:
    """An open file that takes results in one by one."""

    def __init__(self, data: sqlite3.Connection) -> None:
        self._data = data

    def land(self, result: Result) -> None:
        """Keep a result; it is on its way to disk when this returns."""
        try:
            self._data.execute(
                "INSERT OR REPLACE INTO results VALUES (?, ?, ?, ?, ?)",
                (
                    result.key,
                    result.status,
                    result.reason,
                    json.dumps(dict(result.figures)),
                    result.seconds,
                ),
            )
        except sqlite3.Error as error:
            raise StoreUnavailable(f"a result could not be kept: {error}") from error


def _result(row: tuple[str, str, str, str, float]) -> Result:
    key, status, reason, figures, seconds = row
    return Result(
        key, "done" if status == "done" else "failed", reason, json.loads(figures), seconds
    )
