"""Many clicks at once: steps of a session follow one another, sessions take turns."""

import threading
import time
from itertools import pairwise

from evdash.files.bundled import DEFAULT
from evdash.files.scenario_folder import read_scenario
from evdash.ui.run import open_run
from evdash.ui.session import Session
from evdash.ui.solving import Turns


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
