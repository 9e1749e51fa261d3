"""AC power flow of what was executed, found in the background: it takes seconds to load.

One process for the whole server; what it found is kept, bounded, and shared by all sessions. Where
it fails, that is a finding, too: a page that waited for it would wait for ever.
"""

import logging
import queue
import threading
import time
from collections import OrderedDict
from collections.abc import Hashable
from typing import Protocol

from evdash.domain.digest import digest
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Step, Trace
from evdash.metrics.ac import AcPoint, unchecked_point
from evdash.metrics.ac_kept import feeder_key
from evdash.metrics.ac_process import AcProcess

MOST_RESULTS = 5_000
MOST_DIGESTS = 64
FIRST_PAGE_SECONDS = 4.0
"""Loading waits so long after the first page asked, so that its browser is served first."""
IDLE_SECONDS = 0.5
"""Who has asked for nothing so long is at rest, and something can be done ahead."""
ATTEMPTS = 2
"""The second in a process begun anew: the first may have been ended by the system."""

log = logging.getLogger(__name__)


class Flows(Protocol):
    """Who solves: `KeptFlows` here, or `AcProcess` elsewhere."""

    def point(self, scenario: Scenario, interval: int, station_kw: float) -> AcPoint:
        """An interval's AC state."""
        ...

    def prepare(self, scenario: Scenario, interval: int) -> None:
        """Solve ahead what an interval will be asked for."""
        ...


class Referee:
    """Finds the AC state of executed intervals, one after the other, in a process of its own."""

    def __init__(self, flows: Flows) -> None:
        self.flows = flows
        self._found: OrderedDict[Hashable, AcPoint] = OrderedDict()
        self._asked: set[Hashable] = set()
        self._queue: queue.SimpleQueue[tuple[Hashable, Step]] = queue.SimpleQueue()
        self._latest: Step | None = None
        self._lock = threading.Lock()
        self._worker: threading.Thread | None = None
        self.is_ready = False

    def findings(self, trace: Trace, patience_seconds: float = 0.0) -> dict[int, AcPoint]:
        """What is known of the executed intervals; the rest is asked for and comes later.

        Waits up to `patience_seconds` for it, but never for the power flow to load.
        """
        keys = {step.interval: _key(step) for step in trace.steps}
        with self._lock:
            for step in trace.steps:
                key = keys[step.interval]
                if key not in self._found and key not in self._asked:
                    self._asked.add(key)
                    self._queue.put((key, step))
            if self._worker is None:
                self._worker = threading.Thread(
                    target=self._work, args=(trace.scenario,), name="ac", daemon=True
                )
                self._worker.start()
        until = time.monotonic() + (patience_seconds if self.is_ready else 0.0)
        while True:
            with self._lock:
                known = {t: self._found[key] for t, key in keys.items() if key in self._found}
            if len(known) == len(keys) or time.monotonic() >= until:
                return known
            time.sleep(0.005)

    def _work(self, first: Scenario) -> None:
        time.sleep(FIRST_PAGE_SECONDS)
        self._prepare(first, 0)  # it takes seconds to import, and the first step need not wait
        self.is_ready = True
        while True:
            try:
                key, step = self._queue.get(timeout=IDLE_SECONDS)
            except queue.Empty:
                if self._latest is not None:
                    self._prepare(self._latest.inputs.scenario, self._latest.interval + 1)
                key, step = self._queue.get()
            finding = self._find(step)
            with self._lock:
                self._found[key] = finding
                self._asked.discard(key)
                while len(self._found) > MOST_RESULTS:
                    self._found.popitem(last=False)
            self._latest = step

    def _prepare(self, scenario: Scenario, interval: int) -> None:
        """Have solved, while nobody waits, what will be asked of an interval that is to come."""
        try:
            self.flows.prepare(scenario, interval)
        except Exception:  # it is told where it is asked for
            log.exception("the AC power flow could not be made ready")

    def _find(self, step: Step) -> AcPoint:
        scenario, failure = step.inputs.scenario, ""
        for _ in range(ATTEMPTS):
            try:
                return self.flows.point(scenario, step.interval, step.station_kw)
            except Exception as error:  # whatever it is, the worker goes on
                log.exception("the AC power flow of interval %d failed", step.interval)
                failure = f"{type(error).__name__}: {error}"
        return unchecked_point(scenario, failure)


class Digests:
    """Digests of the latest scenarios' feeders: every node is read once, not at each step."""

    def __init__(self) -> None:
        self._known: OrderedDict[int, tuple[Scenario, bytes]] = OrderedDict()

    def of(self, scenario: Scenario) -> bytes:
        """A digest of all that an AC power flow is built from."""
        known = self._known.get(id(scenario))
        if known is None:
            known = (scenario, digest(feeder_key(scenario)))
            self._known[id(scenario)] = known  # holds the scenario, so that its id stays its own
            while len(self._known) > MOST_DIGESTS:
                self._known.popitem(last=False)
        return known[1]


digests = Digests()


def _key(step: Step) -> Hashable:
    """All that an interval's AC state depends on."""
    scenario = step.inputs.scenario
    row = scenario.profile[step.interval]
    station_kw = round(step.station_kw, 9)
    feeder = digests.of(scenario)
    return feeder, scenario.station.node, row.load_pu, row.generation_pu, station_kw, step.interval


referee = Referee(AcProcess())
"""The referee of this server."""
