"""The file of runs in trouble: bits flipped, deleted, moved, shared, and a clock that is wrong."""

import contextlib
import os
import random
import shutil
import sqlite3
from pathlib import Path

import pytest

from evdash.domain.trace import Trace
from evdash.errors import StoreUnavailable
from evdash.files.bundled import DEFAULT
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import start_day, step
from evdash.scheduling.p1 import p1_policy
from evdash.store import runs
from evdash.store.database import NAME
from evdash.store.journal import Journal
from evdash.store.parts import Kept
from evdash.store.runs import DAY_SECONDS, DOUBT_SECONDS, MOST_DAYS, Store
from evdash.ui import keeping
from evdash.ui.run import Run

FLIPS = 150
P1 = p1_policy()


@pytest.fixture(scope="module")
def days() -> list[Trace]:
    traces = [start_day(read_scenario(DEFAULT))]
    for _ in range(3):
        traces.append(step(traces[-1], P1))
    return traces


def kept(trace: Trace) -> Kept:
    return Kept("summer-weekday", trace.inputs.given, trace)


def steps_of(directory: Path, link: str) -> int | None:
    found = Journal.resume(Store(directory), link)
    return None if found is None else len(found[1].trace.steps)


@pytest.fixture
def whole(days: list[Trace], tmp_path_factory: pytest.TempPathFactory) -> tuple[bytes, str]:
    """A file with one run in it, and its link."""
    place = tmp_path_factory.mktemp("whole")
    journal = Journal(Store(place))
    journal.keep(kept(days[2]))
    journal.store.database.close()
    return (place / NAME).read_bytes(), journal.link


@pytest.mark.parametrize("where", ["schema", "anywhere"])
def test_a_flipped_bit_is_told_in_words_and_the_run_goes_on(
    where: str, whole: tuple[bytes, str], days: list[Trace], tmp_path: Path
) -> None:
    """Whatever bit it is: nothing but StoreUnavailable, and never another run than was kept."""
    content, link = whole
    draw = random.Random(7)  # noqa: S311 - nothing secret
    schema = (content.index(b"CREATE TABLE"), content.rindex(b"CREATE") + 80)
    for flip in range(FLIPS):
        low, high = schema if where == "schema" else (0, len(content))
        at = draw.randrange(low, high)
        spoilt = bytearray(content)
        spoilt[at] ^= 1 << draw.randrange(8)
        place = tmp_path / f"{flip}"
        place.mkdir()
        (place / NAME).write_bytes(spoilt)
        with contextlib.suppress(StoreUnavailable):
            found = Journal.resume(Store(place), link)
            assert found is None or len(found[1].trace.steps) == 2
        store = Store(place)
        for _ in range(3):  # put aside at first, and perhaps a part that is let go
            try:
                journal = Journal(store)
                journal.keep(kept(days[3]))
                break
            except StoreUnavailable as error:
                told = f"{at}: {error}"
        else:
            pytest.fail(told)
        assert steps_of(place, journal.link) == 3
        shutil.rmtree(place)


def test_of_two_servers_on_a_damaged_file_the_second_keeps_the_good_new_one(
    days: list[Trace], whole: tuple[bytes, str], tmp_path: Path
) -> None:
    (tmp_path / NAME).write_bytes(whole[0])
    one, other = Store(tmp_path), Store(tmp_path)
    for store in (one, other):
        Journal(store).keep(kept(days[1]))
        store.database._connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    size = (tmp_path / NAME).stat().st_size
    with (tmp_path / NAME).open("r+b") as file:  # in place, as a failing disk would
        file.write(b"\0" * size)
    for store in (one, other):
        store.database._connection.execute("PRAGMA cache_size = 0")
        store.database._connection.execute("PRAGMA shrink_memory")
    with pytest.raises(StoreUnavailable, match="put aside as damaged-"):
        Journal(one).keep(kept(days[2]))
    journal = Journal(one)
    journal.keep(kept(days[3]))
    good = os.stat(tmp_path / NAME).st_ino
    mine = Journal(other)
    try:
        mine.keep(kept(days[2]))
    except StoreUnavailable:
        mine.keep(kept(days[2]))
    assert os.stat(tmp_path / NAME).st_ino == good
    assert len(list(tmp_path.glob(f"damaged-*-{NAME}"))) == 1
    assert steps_of(tmp_path, journal.link) == 3
    assert steps_of(tmp_path, mine.link) == 2


def test_who_finds_the_damage_second_leaves_the_new_file_alone(
    days: list[Trace], tmp_path: Path
) -> None:
    """Even if it had opened the damaged one just before it was put aside."""
    store = Store(tmp_path)
    journal = Journal(store)
    journal.keep(kept(days[1]))
    opened = store.database._identity
    error = sqlite3.DatabaseError("database disk image is malformed")
    error.sqlite_errorcode = sqlite3.SQLITE_CORRUPT
    assert "put aside as" in store.database._aside(error, opened)
    Journal(Store(tmp_path)).keep(kept(days[2]))
    assert "another server" in store.database._aside(error, opened)
    assert (tmp_path / NAME).exists()


@pytest.mark.parametrize("fate", ["deleted", "moved", "replaced by an older copy", "wal deleted"])
def test_what_is_said_to_be_kept_is_in_the_file_that_is_there(
    fate: str, days: list[Trace], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = Store(tmp_path)
    monkeypatch.setattr(keeping, "store", lambda: store)
    keeper = keeping.Keeper()
    keeper.keep(Run(None, days[0].scenario, days[1]))
    (tmp_path / "copy").mkdir()
    if fate == "replaced by an older copy":
        with (
            sqlite3.connect(tmp_path / NAME) as data,
            sqlite3.connect(tmp_path / "copy" / NAME) as copy,
        ):
            data.backup(copy)
        copy.close(), data.close()
    keeper.keep(Run(None, days[0].scenario, days[2]))
    if fate == "wal deleted":
        (tmp_path / f"{NAME}-wal").unlink()
    else:
        for path in list(tmp_path.glob(f"{NAME}*")):
            path.rename(tmp_path / f"away-{path.name}") if fate == "moved" else path.unlink()
    if fate == "replaced by an older copy":
        shutil.copy(tmp_path / "copy" / NAME, tmp_path / NAME)
    keeper.keep(Run(None, days[0].scenario, days[3]))
    assert "could not be kept" not in keeper.said
    assert steps_of(tmp_path, keeper.link) == 3


@pytest.mark.parametrize("ahead", [MOST_DAYS + 1, -MOST_DAYS - 1, 10_000])
def test_a_clock_that_is_wrong_once_lets_nothing_go(
    ahead: float, days: list[Trace], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runs, "PRUNE_EVERY", 1)
    now = 1.8e9
    monkeypatch.setattr(runs.time, "time", lambda: now)
    store = Store(tmp_path)
    journals = [Journal(store) for _ in range(3)]
    for journal in journals:
        journal.keep(kept(days[1]))
    now += ahead * DAY_SECONDS
    journals[2].keep(kept(days[2]))
    now -= ahead * DAY_SECONDS
    journals[2].keep(kept(days[3]))
    for day in range(1, 8):
        now = 1.8e9 + day * DAY_SECONDS
        journals[2].keep(kept(days[day % 3]))
    assert [Journal.resume(store, journal.link) is None for journal in journals] == [False] * 3
    now = 1.8e9 + MOST_DAYS * DAY_SECONDS + 2 * DAY_SECONDS
    journals[2].keep(kept(days[1]))
    assert Journal.resume(store, journals[0].link) is not None
    now += DOUBT_SECONDS + 1
    journals[2].keep(kept(days[2]))
    assert Journal.resume(store, journals[0].link) is None  # it was right after all
    assert Journal.resume(store, journals[2].link) is not None
