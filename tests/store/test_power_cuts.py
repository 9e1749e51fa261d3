"""Kills, full disks, read-only places, damaged and older files: told, and nothing kept is lost."""

import os
import shutil
import sqlite3
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from benchmarks.power_cuts import cut_power, soundness
from evdash.domain.refusal import CLAUSES
from evdash.domain.trace import Trace
from evdash.errors import StoreUnavailable
from evdash.explain.refusals import explain_vehicle
from evdash.horizon.day import start_day, step
from evdash.metrics.records import refused_by_reason, vehicle_records
from evdash.scheduling.p1 import p1_policy
from evdash.store import database
from evdash.store.database import NAME
from evdash.store.journal import Journal
from evdash.store.parts import Kept
from evdash.store.runs import Store
from evdash.ui import keeping
from evdash.ui.keeping import Keeper
from evdash.ui.run import Run
from tests.builders import make_scenario, vehicle

ROOT = Path(__file__).parents[2]
OLDER = Path(__file__).parent / "older" / "format1.sqlite3"


@pytest.fixture(scope="module")
def days() -> list[Trace]:
    scenario = make_scenario(vehicles=[vehicle("1", 0), vehicle("2", 1)])
    traces = [start_day(scenario)]
    while not traces[-1].is_over:
        traces.append(step(traces[-1], p1_policy()))
    return traces


def kept(trace: Trace) -> Kept:
    return Kept("", trace.scenario, trace)


def steps_of(directory: Path, link: str) -> int:
    found = Journal.resume(Store(directory), link)
    assert found is not None
    return len(found[1].trace.steps)


def test_killed_at_any_instant_it_opens_again_with_the_last_step_told(tmp_path):
    """The short form of `benchmarks.power_cuts`."""
    writers = cut_power(tmp_path, kills=2, seed=3, writers=2)
    assert [fault for writer in writers for fault in writer.faults] == []
    assert sum(writer.counts["steps kept"] for writer in writers) > 0


def test_a_lost_step_would_be_told(tmp_path):
    (writer,) = cut_power(tmp_path, kills=1, seed=1, writers=1)
    assert writer.faults == []
    writer.told = (writer.told + 5) % len(writer.days)
    writer.check()
    assert len(writer.faults) == 1


def test_two_servers_on_one_store_do_each_other_no_harm(days, tmp_path):
    journals = [Journal(Store(tmp_path)) for _ in range(2)]

    def write(journal: Journal) -> None:
        for trace in days * 5:
            journal.keep(kept(trace))

    threads = [threading.Thread(target=write, args=(journal,)) for journal in journals]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert soundness(tmp_path) == "ok"
    assert [steps_of(tmp_path, journal.link) for journal in journals] == [4, 4]


WITHOUT_PAUSE = """
import sys, time
from pathlib import Path
from evdash.store.journal import Journal
from evdash.store.runs import Store
from tests.builders import make_scenario
from evdash.horizon.day import start_day
from evdash.store.parts import Kept
scenario = make_scenario()
journal, until = Journal(Store(Path(sys.argv[1]))), time.monotonic() + 1.0
kept = 0
while kept < 20 or time.monotonic() < until:
    journal.keep(Kept("", scenario, start_day(scenario)))
    kept += 1
print(kept)
"""


def test_two_processes_that_write_without_pause_both_get_their_turns(tmp_path):
    """A turn that never came would raise StoreUnavailable in one of them."""
    command = [sys.executable, "-c", WITHOUT_PAUSE, str(tmp_path)]
    writers = [
        subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        for _ in range(2)
    ]
    said = [writer.communicate() for writer in writers]
    assert [writer.returncode for writer in writers] == [0, 0], said
    assert all(int(out) >= 20 for out, _ in said)
    assert soundness(tmp_path) == "ok"


def test_a_turn_that_never_comes_is_told_in_words(days, tmp_path, monkeypatch):
    monkeypatch.setattr(database, "PATIENCE_SECONDS", 0.1)
    journal = Journal(Store(tmp_path))
    journal.keep(kept(days[1]))
    other = sqlite3.connect(tmp_path / NAME, isolation_level=None)
    other.execute("BEGIN IMMEDIATE")
    with pytest.raises(StoreUnavailable, match="other servers kept writing"):
        journal.keep(kept(days[2]))
    other.execute("ROLLBACK")
    other.close()
    journal.keep(kept(days[2]))
    assert steps_of(tmp_path, journal.link) == 2


FULL = """
import resource, signal, sys
from pathlib import Path
from evdash.errors import StoreUnavailable
from evdash.store.journal import Journal
from evdash.store.runs import Store
directory, link = Path(sys.argv[1]), sys.argv[2]
journal, kept = Journal.resume(Store(directory), link)
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
size = (directory / "runs.sqlite3").stat().st_size
resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
try:
    journal.keep(kept)
except StoreUnavailable as error:
    print("told:", error)
"""


@pytest.mark.skipif(os.name == "nt", reason="limits of a system that has them")
def test_a_file_that_cannot_grow_is_told_and_what_was_kept_stays(days, tmp_path):
    journal = Journal(Store(tmp_path))
    journal.keep(kept(days[2]))
    journal.store.database.close()
    command = [sys.executable, "-c", FULL, str(tmp_path), journal.link]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.startswith("told: ")
    assert steps_of(tmp_path, journal.link) == 2
    assert soundness(tmp_path) == "ok"


def test_what_the_file_system_refuses_is_told_in_the_app_and_stops_nothing(
    days, tmp_path, monkeypatch
):
    """As on a full disk or in a read-only place, whoever runs the test."""
    store = Store(tmp_path)
    monkeypatch.setattr(keeping, "store", lambda: store)
    keeper = Keeper()
    keeper.keep(Run(None, days[0].scenario, days[1]))
    assert keeper.said == ""
    store.database._connection.execute("PRAGMA query_only = ON")
    keeper.keep(Run(None, days[0].scenario, days[2]))
    assert "could not be kept" in keeper.said
    assert "readonly" in keeper.said
    keeper.keep(Run(None, days[0].scenario, days[3]))  # tried anew on a new connection
    assert keeper.said == ""
    assert steps_of(tmp_path, keeper.link) == 3


@pytest.mark.parametrize("damage", ["not a database", "torn", "zeroed"])
def test_a_damaged_file_is_told_put_aside_and_followed_by_a_new_one(days, tmp_path, damage):
    journal = Journal(Store(tmp_path))
    journal.keep(kept(days[2]))
    journal.store.database.close()
    file = tmp_path / NAME
    content = file.read_bytes()
    spoilt = {
        "not a database": b"this was never a database" * 200,
        "torn": content[: len(content) // 3 // 4096 * 4096],
        "zeroed": content[:4096] + bytes(len(content) - 4096),
    }[damage]
    file.write_bytes(spoilt)
    store = Store(tmp_path)
    with pytest.raises(StoreUnavailable, match="put aside as damaged-"):
        Journal(store).keep(kept(days[1]))
    (aside,) = tmp_path.glob(f"damaged-*-{NAME}")
    assert aside.read_bytes() == spoilt
    again = Journal(store)
    again.keep(kept(days[1]))
    assert steps_of(tmp_path, again.link) == 1


def test_an_older_file_is_opened_or_refused_in_words_and_left_as_it_is(tmp_path):
    """It was written by the first version; its runs are small."""
    shutil.copy(OLDER, tmp_path / NAME)
    store = Store(tmp_path)
    try:
        found = Journal.resume(store, "an-older-link")
    except StoreUnavailable as error:
        assert "another version of evdash" in str(error)  # noqa: PT017 - either will do
    else:
        assert found is not None
        assert found[1].opened.name == "an older day"
        assert len(found[1].trace.steps) == 2
    store.database.close()
    with sqlite3.connect(tmp_path / NAME) as data:
        assert data.execute("SELECT count(*) FROM runs").fetchone()[0] == 1


def test_reasons_kept_as_sentences_by_an_older_version_stay_and_can_be_explained(tmp_path):
    """Its refusals were text; the file was written by the version before reasons had kinds."""
    shutil.copy(OLDER.with_name("reasons_as_text.sqlite3"), tmp_path / NAME)
    found = Journal.resume(Store(tmp_path), "7KHrIZAv1V1XPO16sKhdig")
    assert found is not None
    trace = found[1].trace
    records = {record.vehicle: record for record in vehicle_records(trace)}
    assert records["dear"].why_not == (
        "energy costs at least 0.5 $/kWh before its deadline, it pays 0.4 $/kWh"
    )
    assert records["late"].why_not == "arrives after the last interval has begun"
    assert records["c"].reason is None
    assert sum(map(len, refused_by_reason(records.values()).values())) == 4
    dear = explain_vehicle(trace, "dear")
    assert dear.detail.startswith(f"Refused because {records['dear'].why_not}.")
    assert f"refused it because {CLAUSES['energy']}" in dear.detail
    assert explain_vehicle(trace, "late").cause.kind == "after the end"
    journal = Journal(Store(tmp_path))
    journal.keep(kept(trace))
    again = Journal.resume(Store(tmp_path), journal.link)
    assert again is not None
    assert [s.plan.refused for s in again[1].trace.steps] == [s.plan.refused for s in trace.steps]


def test_a_new_run_is_kept_beside_older_ones(days, tmp_path):
    shutil.copy(OLDER, tmp_path / NAME)
    journal = Journal(Store(tmp_path))
    journal.keep(kept(days[2]))
    assert steps_of(tmp_path, journal.link) == 2
