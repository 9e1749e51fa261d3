"""The short form of `benchmarks.many_users`: a few people at once on a real server."""

import argparse
import asyncio
import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from rich.console import Console

from benchmarks.crowd.days import day_of, is_as_decided_alone
from benchmarks.crowd.server import serving
from benchmarks.many_users import all_at_once

ROOM = argparse.Namespace(users=4, minutes=0.6, think=0.5, stay=0, seed=1, heavy=False)
# What Streamlit itself is known to do to quick clicks on a starved machine: docs/reliability.md.
DROPPED = re.compile("double click|waited in vain")


def test_nobody_sees_anothers_day_and_no_step_is_lost_or_repeated(tmp_path: Path) -> None:
    # in a thread of its own, as browser tests leave an event loop in the one they run in
    with serving(tmp_path) as server, ThreadPoolExecutor(1) as thread:
        everybody = all_at_once(server, ROOM, Console(quiet=True))
        crowd = thread.submit(asyncio.run, everybody).result()
        for user in crowd.users:
            assert is_as_decided_alone(tmp_path, user.link, day_of(user.number))
    assert any(user.done for user in crowd.users)
    faults = {user.number: user.faults for user in crowd.users}
    assert not [told for told in faults.values() if "saw data" in f"{told}" or "copy" in f"{told}"]
    heard_all = [told for told in faults.values() if "waited in vain" not in told]
    assert heard_all
    assert [f for told in heard_all for f in told if not DROPPED.search(f)] == []
