"""A day with events, stopped and brought back: from the store at any step, or from its folder."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.random_days import random_scenario
from benchmarks.random_events import random_events
from benchmarks.soundness import without_times
from evdash.audit.audit import audit_run
from evdash.domain.trace import Network, Trace
from evdash.files.exchange import output_folder
from evdash.files.run_export import RunLabel, judge, run_files
from evdash.files.run_folder import is_run, write_run
from evdash.horizon.day import run_day, start_day, step
from evdash.horizon.happen import happen
from evdash.metrics.breaches import linear_breaches
from evdash.metrics.ledger import ledger
from evdash.reports.again import decided_again, earlier_run
from evdash.scheduling.p1 import p1_policy
from evdash.store.journal import Journal
from evdash.store.parts import Kept
from evdash.store.runs import Store
from tests.builders import make_scenario, vehicle
from tests.horizon.test_events import event
from tests.store.test_store import same

P1 = p1_policy()
LATER = event("chargers_return", value=1, interval=3).model_dump()
LIVE = {
    1: (event("chargers", value=0),),
    2: (event("chargers", value=1, interval=2), event("price_factor", value=2.0, interval=2)),
    4: (event("no_show", subject="d", interval=4),),
}
"""What a person lets happen; the scenario itself has one more event, at 03:00."""
VEHICLES = [
    vehicle("a", need_kwh=12.0, option="C2"),
    vehicle("b", need_kwh=12.0, option="C2"),
    vehicle("c", hour=1.5, need_kwh=4.0),
    vehicle("d", hour=2.5, need_kwh=16.0, option="C2"),
]


def brought_back(trace: Trace, directory: Path) -> Trace:
    """The day through the store and out of it again."""
    store = Store(directory)
    journal = Journal(store)
    journal.keep(Kept("made for a test", trace.inputs.given, trace))
    found = Journal.resume(Store(directory), journal.link)
    assert found is not None
    return found[1].trace


def lived(network: Network, at: int | None = None, store: Path | None = None) -> Trace:
    """The day with all that happens, brought back from a store before interval `at`."""
    price = [0.3, 0.3, 0.1, 0.1, 0.2, 0.1, 0.1]
    scenario = make_scenario(price=price, vehicles=VEHICLES, events=[LATER])
    trace = start_day(scenario, network)
    while not trace.is_over:
        if trace.now in LIVE:
            trace = happen(trace, LIVE[trace.now])
        if trace.now == at and store is not None:
            trace = brought_back(trace, store)
        trace = step(trace, P1)
    return trace


@pytest.fixture(scope="module", params=["lindistflow", "ac"])
def whole(request: pytest.FixtureRequest) -> Trace:
    return lived(request.param)


def files_of(trace: Trace, directory: Path) -> dict[str, str]:
    """The run's folder, written to `directory`; its files but for times taken."""
    label = RunLabel("p1", trace.inputs.network, trace.inputs.given.arrivals.seed, 0.0)
    files = run_files(trace, judge(trace, linear_breaches(trace)), label)
    with output_folder(directory, "run", is_run, force=True) as claim:
        write_run(claim, files)
    return {name: text for name, text in files.items() if name != "intervals.csv"}


def test_the_day_has_promises_short_made_good_and_waiting(whole: Trace) -> None:
    assert len(whole.happenings) == 4
    assert {entry.status for entry in ledger(whole)} == {"short", "kept", "released"}
    assert any(taken.before.waiting for taken in whole.steps)


@pytest.mark.parametrize("at", range(7))
def test_brought_back_at_any_step_it_ends_as_it_would_have(
    at: int, whole: Trace, tmp_path: Path
) -> None:
    resumed = lived(whole.inputs.network, at, tmp_path)
    assert without_times(resumed) == without_times(whole)
    assert same(resumed.happenings, whole.happenings)
    assert same(resumed.state, whole.state)
    assert resumed.inputs.given == whole.inputs.given
    assert ledger(resumed) == ledger(whole)


def test_the_files_are_the_same_and_audited_to_broken_promises_alone(
    whole: Trace, tmp_path: Path
) -> None:
    resumed = lived(whole.inputs.network, 2, tmp_path / "store")
    assert files_of(resumed, tmp_path / "resumed") == files_of(whole, tmp_path / "whole")
    findings = audit_run(tmp_path / "resumed").findings
    assert len(findings) == sum(entry.status == "short" for entry in ledger(whole))
    assert all("a broken promise" in finding for finding in findings)


def test_from_its_own_folder_the_day_is_decided_to_the_same(whole: Trace, tmp_path: Path) -> None:
    files_of(whole, tmp_path / "run")
    again = decided_again(
        earlier_run(tmp_path / "run"),
        lambda scenario, network, _: run_day(start_day(scenario, network), P1),
    )
    assert without_times(again) == without_times(whole)
    assert ledger(again) == ledger(whole)
    assert same(again.happenings, whole.happenings)


@pytest.mark.parametrize("seed", [2, 19])
def test_random_days_with_random_events_go_on_alike(seed: int, tmp_path: Path) -> None:
    """Kept and brought back before every single step."""
    rng = np.random.default_rng(seed + 1_000_000)
    trace = other = start_day(random_scenario(seed))
    while not trace.is_over:
        if events := random_events(rng, trace):
            trace, other = happen(trace, events), happen(other, events)
        other = brought_back(other, tmp_path)
        trace, other = step(trace, P1), step(other, P1)
    assert without_times(other) == without_times(trace)
    assert same(other.happenings, trace.happenings)
    assert ledger(other) == ledger(trace)
