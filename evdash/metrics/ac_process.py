"""The AC check in a process of its own: a power flow would hold up every page of the server.

It also spares the server pandapower's memory. `ac_process` gives a pool of one process; what it
is asked are `point` and `prepare`. It ends with the server, however that ends.
"""

import multiprocessing
import os
import signal
import threading
from concurrent.futures import Executor, ProcessPoolExecutor
from multiprocessing.connection import wait

from evdash.domain.scenario import Scenario
from evdash.metrics.ac import AcPoint
from evdash.metrics.ac_kept import KeptFlows

flows = KeptFlows()
"""Of this process."""


def ac_process() -> Executor:
    """A pool of one new process; it begins with the first thing asked."""
    spawned = multiprocessing.get_context("spawn")  # forking a server with threads may hang
    return ProcessPoolExecutor(1, mp_context=spawned, initializer=_begin)


def point(scenario: Scenario, interval: int, station_kw: float) -> AcPoint:
    """An interval's AC state, found in the process this is called in."""
    return flows.point(scenario, interval, station_kw)


def prepare(scenario: Scenario, interval: int) -> None:
    """Solve ahead what an interval will be asked for, in the process this is called in."""
    flows.prepare(scenario, interval)


def _begin() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is the server's affair
    threading.Thread(target=_end_with_server, name="server", daemon=True).start()


def _end_with_server() -> None:
    server = multiprocessing.parent_process()
    if server is not None:
        wait([server.sentinel])
        os._exit(0)
