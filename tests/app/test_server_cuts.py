"""The short form of `benchmarks.server_cuts`: a real server killed while people step."""

import asyncio
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from benchmarks.server_cuts import Stepper, cut_off


def test_everybody_goes_on_by_their_link_after_a_server_was_killed(tmp_path: Path) -> None:
    # in a thread of its own, as browser tests leave an event loop in the one they run in
    with ThreadPoolExecutor(1) as thread:
        days = cut_off(tmp_path, kills=2, users=2, think=0.1, seed=1)
        people = thread.submit(asyncio.run, days).result()
    assert [fault for one in people for fault in one.faults] == []
    assert sum(one.counts["steps shown"] for one in people) > 0


def test_a_lost_and_a_doubled_step_would_be_told() -> None:
    for kept in (None, 0, 3, 6):
        one = Stepper(1, "", np.random.default_rng(1), length=24, shown=4, asked=5)
        one.check("kept", kept)
        assert len(one.faults) == 1
    for kept in (4, 5):
        one = Stepper(1, "", np.random.default_rng(1), length=24, shown=4, asked=5)
        one.check("kept", kept)
        assert one.faults == []
