"""A run brought back is the run that was kept, to the bit, and nothing was solved for it."""

import os
import sqlite3
import threading
import time
from dataclasses import fields, is_dataclass
from pathlib import Path

import numpy as np
import pytest
from pydantic import BaseModel

from evdash.domain.trace import Trace
from evdash.errors import StoreUnavailable
from evdash.files.bundled import DEFAULT, bundled_scenarios
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import start_day, step
from evdash.horizon.revise import revise
from evdash.scheduling.p1 import p1_policy
from evdash.store import place, runs
from evdash.store.database import FORMAT
from evdash.store.journal import Journal
from evdash.store.parts import Kept
from evdash.store.runs import Limits, Store

P1 = p1_policy()


def same(one: object, other: object) -> bool:
    """Equal down to every bit of every array, found by walking both without the store's code."""
    if type(one) is not type(other):
        return False
    if isinstance(one, np.ndarray):
        return (
            one.dtype == other.dtype
            and one.shape == other.shape
            and (one.tobytes() == other.tobytes())
        )
    if is_dataclass(one):
        return all(same(getattr(one, f.name), getattr(other, f.name)) for f in fields(one))
    if isinstance(one, BaseModel):
        return one == other and repr(one) == repr(other)
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(same, one, other))
    return one == other and repr(one) == repr(other)


def stepped(trace: Trace, steps: int) -> Trace:
    for _ in range(steps):
        trace = step(trace, P1)
    return trace


@pytest.fixture(scope="module")
def day() -> Trace:
    """A day with revisions of every kind on the way, stopped in mid-day."""
    trace = stepped(start_day(read_scenario(DEFAULT)), 8)
    trace = stepped(revise(trace, edit_scenario(trace.scenario, {"station.chargers": 9})), 4)
    trace = stepped(revise(trace, trace.scenario, "ac"), 4)
    return revise(trace, edit_scenario(trace.scenario, {"arrivals.seed": 5}))


def kept(trace: Trace) -> Kept:
    return Kept("summer-weekday", read_scenario(DEFAULT), trace)


def resumed(store: Store, link: str) -> tuple[Journal, Kept]:
    found = Journal.resume(store, link)
    assert found is not None
    return found


def test_a_run_comes_back_to_the_bit_without_solving(day: Trace, tmp_path: Path, monkeypatch):
    journal = Journal(Store(tmp_path))
    journal.keep(kept(day))
    monkeypatch.setattr("evdash.horizon.inputs.prepare", None)
    monkeypatch.setattr("highspy.Highs", None)
    _, back = resumed(Store(tmp_path), journal.link)
    assert same(back, kept(day))
    assert not same(back.trace.state, day.steps[-1].before)  # the comparison can fail


def test_what_was_shared_is_shared_again(day: Trace, tmp_path: Path) -> None:
    journal = Journal(Store(tmp_path))
    journal.keep(kept(day))
    _, back = resumed(Store(tmp_path), journal.link)
    steps = back.trace.steps
    assert steps[0].after is steps[1].before
    assert steps[0].inputs is steps[7].inputs
    assert steps[8].inputs is not steps[7].inputs
    assert not steps[3].plan.power_kw.flags.writeable


def test_a_day_that_was_brought_back_goes_on_as_it_would_have(day: Trace, tmp_path: Path) -> None:
    journal = Journal(Store(tmp_path))
    journal.keep(kept(day))
    _, back = resumed(Store(tmp_path), journal.link)
    one, other = stepped(day, 3), stepped(back.trace, 3)
    assert same(one.state, other.state)


@pytest.mark.parametrize("folder", bundled_scenarios(), ids=lambda folder: folder.name)
def test_every_bundled_day_comes_back(folder: Path, tmp_path: Path) -> None:
    scenario = read_scenario(folder)
    whole = Kept(folder.name, scenario, stepped(start_day(scenario), 3))
    journal = Journal(Store(tmp_path))
    journal.keep(whole)
    assert same(resumed(Store(tmp_path), journal.link)[1], whole)


def test_each_change_adds_only_what_is_new(tmp_path: Path) -> None:
    store = Store(tmp_path)
    journal = Journal(store)
    trace = start_day(read_scenario(DEFAULT))
    sizes = []
    for _ in range(6):
        trace = step(trace, P1)
        journal.keep(kept(trace))
        sizes.append(stored_bytes(store))
        assert same(resumed(Store(tmp_path), journal.link)[1].trace, trace)
    assert max(np.diff(sizes)) < sizes[0] / 4


def stored_bytes(store: Store) -> int:
    with store.database.transaction() as data:
        return int(data.execute("SELECT sum(length(body)) FROM parts").fetchone()[0])


def test_going_back_is_kept_too(day: Trace, tmp_path: Path) -> None:
    journal = Journal(Store(tmp_path))
    journal.keep(kept(day))
    begun = start_day(day.scenario)
    journal.keep(kept(begun))
    assert same(resumed(Store(tmp_path), journal.link)[1].trace, begun)


def test_two_tabs_with_one_link_part_ways_and_lose_nothing(tmp_path: Path) -> None:
    trace = stepped(start_day(read_scenario(DEFAULT)), 2)
    first = Journal(Store(tmp_path))
    first.keep(kept(trace))
    link = first.link
    second, back = resumed(Store(tmp_path), link)
    hers = stepped(trace, 1)
    his = revise(back.trace, edit_scenario(trace.scenario, {"arrivals.seed": 9}))
    first.keep(kept(hers))
    second.keep(kept(his))
    assert first.link == link
    assert second.link != link
    assert same(resumed(Store(tmp_path), first.link)[1].trace, hers)
    assert same(resumed(Store(tmp_path), second.link)[1].trace, his)
    copy, later = second.link, stepped(his, 1)
    second.keep(kept(later))
    assert second.link == copy
    assert same(resumed(Store(tmp_path), copy)[1].trace, later)


def test_many_tabs_at_once_never_spoil_a_run(tmp_path: Path) -> None:
    trace = stepped(start_day(read_scenario(DEFAULT)), 2)
    origin = Journal(Store(tmp_path))
    origin.keep(kept(trace))
    store = Store(tmp_path)
    tabs = [resumed(store, origin.link)[0] for _ in range(8)]
    later = [stepped(trace, 1 + n % 3) for n in range(8)]

    def change(n: int) -> None:
        tabs[n].keep(kept(later[n]))

    threads = [threading.Thread(target=change, args=(n,)) for n in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len({tab.link for tab in tabs}) == 8
    for tab, expected in zip(tabs, later, strict=True):
        assert same(resumed(Store(tmp_path), tab.link)[1].trace.state, expected.state)


def test_links_cannot_be_guessed_and_unknown_ones_find_nothing(tmp_path: Path) -> None:
    links = {runs.new_link() for _ in range(500)}
    assert len(links) == 500
    assert min(map(len, links)) >= 22
    store = Store(tmp_path)
    for link in ("", "nobody", "' OR 1=1 --", "%"):
        assert Journal.resume(store, link) is None


def test_pins_are_runs_of_their_own_and_go_with_their_owner(day: Trace, tmp_path: Path) -> None:
    store = Store(tmp_path)
    journal = Journal(store)
    journal.keep(kept(day))
    begun = kept(start_day(day.scenario))
    one = store.pin(journal.link, kept(day), "as it is")
    two = store.pin(journal.link, begun, "at its start")
    assert store.pins(journal.link) == [one, two]
    assert same(resumed(Store(tmp_path), two.link)[1], begun)
    store.unpin(one)
    assert store.pins(journal.link) == [two]
    store.unpin(runs.Pin(journal.link, "not a pin"))
    assert Journal.resume(store, journal.link) is not None
    other, _ = resumed(Store(tmp_path), journal.link)
    journal.keep(begun)
    other.keep(begun)  # parts ways, its pins with it
    assert [pin.title for pin in store.pins(other.link)] == ["at its start"]
    forget(store, journal.link)
    assert Journal.resume(store, two.link) is None
    assert same(resumed(store, store.pins(other.link)[0].link)[1], begun)


def forget(store: Store, link: str) -> None:
    """As if this run had not been touched for a year, and that had been seen a year ago."""
    with store.database.transaction() as data:
        data.execute("UPDATE runs SET touched = 0 WHERE link = ?", (link,))
        runs.prune(data, store.limits)
        data.execute("UPDATE doomed SET since = 0")
        runs.prune(data, store.limits)


def test_a_run_that_was_pruned_while_its_tab_was_open_is_kept_again(
    day: Trace, tmp_path: Path
) -> None:
    store = Store(tmp_path)
    journal = Journal(store)
    journal.keep(kept(day))
    forget(store, journal.link)
    assert Journal.resume(store, journal.link) is None
    assert stored_parts(store) == 0
    journal.keep(kept(day))
    assert same(resumed(Store(tmp_path), journal.link)[1].trace, day)


def stored_parts(store: Store) -> int:
    with store.database.transaction() as data:
        return int(data.execute("SELECT count(*) FROM parts").fetchone()[0])


def test_old_and_many_runs_are_pruned_the_oldest_first(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(runs, "PRUNE_EVERY", 1)
    store = Store(tmp_path, Limits(runs=3))
    trace = start_day(read_scenario(DEFAULT))
    journals = [Journal(store) for _ in range(5)]
    for journal in journals:
        journal.keep(kept(trace))
    there = [Journal.resume(store, journal.link) is not None for journal in journals]
    assert there == [False, False, True, True, True]
    small = Store(tmp_path, Limits(size_bytes=1))
    journals[4] = Journal(small)
    journals[4].keep(kept(trace))
    assert Journal.resume(small, journals[4].link) is not None
    assert Journal.resume(small, journals[3].link) is None


@pytest.mark.parametrize("limit", ["runs", "size_bytes"])
def test_runs_of_whoever_has_most_make_room(limit: str, tmp_path: Path, monkeypatch) -> None:
    """Sixty new runs of one visitor push out that visitor's own, and nobody else's."""
    monkeypatch.setattr(runs, "PRUNE_EVERY", 1)
    begun = start_day(read_scenario(DEFAULT))

    def run_of(store: Store, visitor: str | None, seed: int) -> str:
        scenario = edit_scenario(begun.scenario, {"arrivals.seed": seed})
        journal = Journal(store, visitor=visitor)
        journal.keep(kept(start_day(scenario)))
        store.pin(journal.link, kept(start_day(scenario)), "a pin")
        return journal.link

    store = Store(tmp_path)
    others = [run_of(store, who, n) for n, who in enumerate(["b", "b", "c", None, None])]
    with store.database.transaction() as data:
        size = int(data.execute("SELECT sum(length(body)) FROM parts").fetchone()[0])
    store.limits = Limits(**{limit: {"runs": 12, "size_bytes": 3 * size}[limit]})
    many = [run_of(store, "a", 100 + n) for n in range(60)]

    def there(links: list[str]) -> list[bool]:
        return [Journal.resume(store, link) is not None for link in links]

    assert all(there(others))
    assert there(many)[-1]
    left = there(many)
    assert left == sorted(left)  # the oldest went first
    assert 0 < sum(left) < 30
    with store.database.transaction() as data:
        told = data.execute("SELECT count(*) FROM begun_by").fetchone()[0]
    assert told == 3 + sum(left)


def test_a_file_of_before_is_read_and_one_of_later_is_let_be(tmp_path: Path) -> None:
    journal = Journal(Store(tmp_path))
    journal.keep(kept(start_day(read_scenario(DEFAULT))))
    journal.store.database.close()
    with sqlite3.connect(tmp_path / "runs.sqlite3") as data:
        data.execute("DROP TABLE begun_by")
        data.execute("CREATE TABLE later (link TEXT PRIMARY KEY)")
    again = Journal(Store(tmp_path), visitor="a")
    again.keep(kept(start_day(read_scenario(DEFAULT))))
    assert Journal.resume(Store(tmp_path), journal.link) is not None
    assert [path.name for path in tmp_path.glob("damaged-*")] == []


def test_a_place_that_cannot_be_written_is_told_in_words(day: Trace, tmp_path: Path) -> None:
    occupied = tmp_path / "file"
    occupied.write_text("not a folder")
    journal = Journal(Store(occupied))
    with pytest.raises(StoreUnavailable, match="file"):
        journal.keep(kept(day))
    occupied.unlink()
    journal.keep(kept(day))  # as soon as there is room again
    assert same(resumed(Store(occupied), journal.link)[1].trace, day)


def test_a_full_disk_leaves_what_was_kept(day: Trace, tmp_path: Path) -> None:
    store = Store(tmp_path)
    journal = Journal(store)
    begun = start_day(day.scenario)
    journal.keep(kept(begun))
    with store.database.transaction() as data:
        pages = data.execute("PRAGMA page_count").fetchone()[0]
    store.database._connection.execute(f"PRAGMA max_page_count = {pages}")
    with pytest.raises(StoreUnavailable, match="full"):
        journal.keep(kept(day))
    assert same(resumed(Store(tmp_path), journal.link)[1].trace, begun)
    journal.keep(kept(day))
    assert same(resumed(Store(tmp_path), journal.link)[1].trace, day)


def test_another_format_or_a_spoilt_file_is_refused_in_words(day: Trace, tmp_path: Path) -> None:
    Journal(Store(tmp_path / "a")).keep(kept(day))
    file = tmp_path / "a" / "runs.sqlite3"
    with sqlite3.connect(file) as data:
        data.execute(f"PRAGMA user_version = {FORMAT + 1}")
    with pytest.raises(StoreUnavailable, match=f"its format is {FORMAT + 1}"):
        Store(tmp_path / "a").read("any")
    spoilt = tmp_path / "b"
    spoilt.mkdir()
    (spoilt / "runs.sqlite3").write_bytes(b"this was never a database" * 100)
    with pytest.raises(StoreUnavailable, match="not a database"):
        Store(spoilt).read("any")


def test_a_run_of_another_versions_classes_is_refused_in_words(day: Trace, tmp_path: Path) -> None:
    store = Store(tmp_path)
    journal = Journal(store)
    journal.keep(kept(day))
    with store.database.transaction() as data:
        data.execute("UPDATE runs SET manifest = replace(manifest, 'before', 'earlier')")
    with pytest.raises(StoreUnavailable, match="another version"):
        Journal.resume(store, journal.link)


def test_the_place_is_a_setting(monkeypatch, tmp_path: Path) -> None:
    monkeypatch.setenv(place.VARIABLE, str(tmp_path))
    assert place.store_directory() == tmp_path
    monkeypatch.delenv(place.VARIABLE)
    repository = Path(__file__).parents[2]
    assert repository not in [place.store_directory(), *place.store_directory().parents]


@pytest.mark.skipif(os.name == "nt", reason="permissions of a file system that has them")
def test_nobody_else_on_this_machine_reads_them(day: Trace, tmp_path: Path) -> None:
    Journal(Store(tmp_path / "own")).keep(kept(day))
    assert (tmp_path / "own").stat().st_mode & 0o077 == 0


def test_keeping_a_step_takes_milliseconds(tmp_path: Path) -> None:
    journal = Journal(Store(tmp_path))
    trace = start_day(read_scenario(DEFAULT))
    seconds = []
    for _ in range(12):
        trace = step(trace, P1)
        began = time.thread_time()  # its own work, however busy the machine
        journal.keep(kept(trace))
        seconds.append(time.thread_time() - began)
    assert np.median(seconds[1:]) < 0.005
