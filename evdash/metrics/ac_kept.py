"""AC power flow of executed intervals, with what intervals have in common kept between them."""

import logging
from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import TypeVar

from evdash.domain.scenario import Scenario
from evdash.grid.acflow import AcNetwork, AcResult
from evdash.metrics.ac import AcPoint, ac_point, unchecked_point, without_station

MOST_NETWORKS = 64
MOST_NODES = 20_000
"""Of all networks kept; the latest is kept whatever its size."""
MOST_BASES = 500
ATTEMPTS = 2
"""The second with a network built anew: what failed may have left the first in disorder."""

log = logging.getLogger(__name__)
T = TypeVar("T")


class KeptFlows:
    """Networks, and intervals without the station, as last used. For one thread at a time."""

    def __init__(self) -> None:
        self._networks: OrderedDict[Hashable, AcNetwork] = OrderedDict()
        self._bases: OrderedDict[Hashable, AcResult] = OrderedDict()

    def point(self, scenario: Scenario, interval: int, station_kw: float) -> AcPoint:
        """An interval's AC state with the station drawing `station_kw`; a failure is told in it."""
        failure = ""
        for _ in range(ATTEMPTS):
            try:
                base = self._base(scenario, interval)
                return ac_point(self._network(scenario), scenario, interval, station_kw, base)
            except Exception as error:  # whatever it is, the next is asked for all the same
                log.exception("AC power flow of interval %d failed", interval)
                failure = f"{type(error).__name__}: {error}"
                self._networks.pop(feeder_key(scenario), None)
        return unchecked_point(scenario, failure)

    def prepare(self, scenario: Scenario, interval: int) -> None:
        """Solve, while nobody waits, what will be asked of an interval that is yet to come."""
        if interval < scenario.intervals:
            try:
                self._base(scenario, interval)
            except Exception:  # it is told where it is asked for
                log.exception("AC power flow of interval %d failed", interval)
                self._networks.pop(feeder_key(scenario), None)

    def _base(self, scenario: Scenario, interval: int) -> AcResult:
        """The interval without the station."""
        row = scenario.profile[interval]
        key = feeder_key(scenario), row.load_pu, row.generation_pu
        base = _kept(
            self._bases,
            key,
            lambda: without_station(self._network(scenario), scenario, interval),
        )
        while len(self._bases) > MOST_BASES:
            self._bases.popitem(last=False)
        return base

    def _network(self, scenario: Scenario) -> AcNetwork:
        key = feeder_key(scenario)
        network = _kept(self._networks, key, lambda: AcNetwork(scenario))
        while len(self._networks) > 1 and (
            len(self._networks) > MOST_NETWORKS
            or sum(len(kept.feeder.nodes) for kept in self._networks.values()) > MOST_NODES
        ):
            self._networks.popitem(last=False)
        return network


def _kept(known: OrderedDict[Hashable, T], key: Hashable, make: Callable[[], T]) -> T:
    """What is known under a key, or is made now; the latest used is last."""
    if key not in known:
        known[key] = make()
    known.move_to_end(key)
    return known[key]


def feeder_key(scenario: Scenario) -> Hashable:
    """All that a network is built from."""
    return scenario.feeder, scenario.nodes, scenario.lines
