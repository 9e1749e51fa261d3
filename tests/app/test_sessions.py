"""Many clicks at once: steps of a session follow one another, sessions take turns."""

import threading
import time
from itertools import pairwise
from pathlib import Path

import pytest

from evdash.files.bundled import DEFAULT
from evdash.files.scenario_folder import read_scenario
from evdash.store.runs import Store
from evdash.ui import keeping
from evdash.ui.run import Run, open_run, stepped
from evdash.ui.session import Session, await_changes
from evdash.ui.solving import Turns, policy


def test_clicks_at_the_same_time_are_steps_one_after_the_other() -> None:
    session = Session(open_run(DEFAULT, read_scenario(DEFAULT)))
    clicks = [threading.Thread(target=session.step) for _ in range(8)]
    for click in clicks:
        click.start()
    for click in clicks:
        click.join()
    steps = session.run.trace.steps
    assert [step.interval for step in steps] == list(range(8))
    assert all(a.after is b.before for a, b in pairwise(steps))


def test_who_reloads_in_mid_step_reads_the_run_with_that_step(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = Store(tmp_path)
    monkeypatch.setattr(keeping, "store", lambda: store)
    session = Session(open_run(DEFAULT, read_scenario(DEFAULT)))
    session.step()
    begun, go_on = threading.Event(), threading.Event()

    def slowly(run: Run) -> Run:
        begun.set()
        go_on.wait(60)
        return stepped(run, policy)

    click = threading.Thread(target=session._change, args=(slowly,))
    click.start()
    begun.wait(60)
    read: list[int] = []

    def reload() -> None:
        await_changes(session.keeper.link)
        run, _ = keeping.resume(session.keeper.link)
        assert run is not None
        read.append(len(run.trace.steps))

    page = threading.Thread(target=reload)
    page.start()
    page.join(0.2)
    assert read == []  # it waits
    await_changes("somebody else's link")  # and nobody else does
    go_on.set()
    click.join()
    page.join()
    assert read == [2]


def test_turns_are_given_first_come_first_served() -> None:
    turns = Turns(1)
    order: list[int] = []

    def wait_for_turn(number: int) -> None:
        with turns.one():
            order.append(number)

    with turns.one():
        waiting = []
        for number in range(5):
            waiting.append(threading.Thread(target=wait_for_turn, args=(number,)))
            waiting[-1].start()
            until = time.monotonic() + 5
            while len(turns._waiting) <= number and time.monotonic() < until:
                time.sleep(0.001)
    for thread in waiting:
        thread.join()
    assert order == [0, 1, 2, 3, 4]
