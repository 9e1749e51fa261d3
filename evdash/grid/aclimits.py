"""The AC network model: headroom found by power flow, and a certificate for every plan.

An interval's headroom is the largest station power for which the full AC power flow worsens no
limit, no solution counting as a limit. It is searched upward from zero, so that nothing beyond
the first infeasible power is ever taken for allowed.
"""

import numpy as np
from numpy.typing import NDArray

from evdash.domain.breach import Breach
from evdash.domain.limits import Floats, LimitRows
from evdash.domain.scenario import Scenario
from evdash.grid.acbatch import AcBatch, Flows
from evdash.grid.lindistflow import base_injections
from evdash.grid.radial import radial_feeder
from evdash.grid.reduction import limit_rows
from evdash.grid.sides import EXPORT, Power, by_side, held_by_side

POINTS = 12
"""Powers tried at once between the largest known to be allowed and the smallest known not to."""
RESOLUTION_KW = 1e-4
RELATIVE_RESOLUTION = 1e-6
MARGIN_PU = 1e-8
MARGIN_KVA = 1e-5
"""What counts as worsened in the search; the certificate forgives ten times as much."""
FIRST_REACH_KW = 10.0
SHORT_OF_COLLAPSE = 0.005
"""Room left where no solution exists beyond: so near the collapse solvers disagree on it."""


class AcFeeder:
    """A scenario's feeder in AC, solved once without the station and held against its limits."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario
        self.feeder = radial_feeder(scenario)
        self.batch = AcBatch(scenario, self.feeder)
        self.injections = base_injections(scenario, self.feeder)
        self.station = self.feeder.node_index(scenario.station.node)
        self.elements = self._element_names()
        self.rating_kva = np.append(self.feeder.line_rating_kva, self._own_rating_kva())
        every = np.arange(scenario.intervals)
        self.allowed = np.maximum(0.0, self._without_station(every))

    def _element_names(self) -> tuple[str, ...]:
        nodes = self.feeder.nodes
        ratings = [f"line:{line}" for line in self.feeder.lines]
        ratings.append(f"node:{self.scenario.station.node}")
        return (
            *(f"voltage_min:{node}" for node in nodes),
            *(f"voltage_max:{node}" for node in nodes),
            *(f"{rated}{side}" for side in ("", EXPORT) for rated in ratings),
            f"power_flow:{self.scenario.station.node}",
        )

    def _own_rating_kva(self) -> float:
        station = self.scenario.station.node
        own = next(n.rating_kva for n in self.scenario.nodes if n.node == station)
        return np.inf if own is None else own

    def excess(self, intervals: NDArray[np.int64], station_kw: Floats) -> Floats:
        """How far each side of each limit is exceeded, negative where kept, (flows, elements).

        Voltages in pu, ratings in kVA, -inf on the side on which nothing flows; without a
        solution the last column is 1 and the others say nothing (-inf).
        """
        flows, node_power = self._solve(intervals, station_kw)
        return self._excess(flows, by_side(flows.line_power), by_side(node_power))

    def _without_station(self, intervals: NDArray[np.int64]) -> Floats:
        """The same of what flows without the station, reactive power counted on both sides."""
        flows, node_power = self._solve(intervals, np.zeros(len(intervals)))
        return self._excess(flows, held_by_side(flows.line_power), held_by_side(node_power))

    def _solve(self, intervals: NDArray[np.int64], station_kw: Floats) -> tuple[Flows, Power]:
        """Power flows, and the net load at the station's node (flows,)."""
        active = self.injections.active_kw[intervals].copy()
        active[:, self.station] -= station_kw
        reactive = self.injections.reactive_kvar[intervals]
        own = -(active[:, self.station] + 1j * reactive[:, self.station])
        return self.batch.solve(active, reactive), own

    def _excess(
        self, flows: Flows, line_kva: tuple[Floats, Floats], node_kva: tuple[Floats, Floats]
    ) -> Floats:
        limits = self.scenario.feeder
        rated = [
            np.column_stack([line.max(axis=2), node]) - self.rating_kva
            for line, node in zip(line_kva, node_kva, strict=True)
        ]
        columns = (
            limits.voltage_min_pu - flows.voltage_pu,
            flows.voltage_pu - limits.voltage_max_pu,
            *rated,
        )
        solved = flows.solved[:, None]
        told = np.where(solved, np.hstack(columns), -np.inf)
        return np.hstack([told, np.where(solved, -np.inf, 1.0)])

    def worsened(self, intervals: NDArray[np.int64], excess: Floats) -> NDArray[np.bool_]:
        """Which sides of limits are exceeded by more than without the station, (flows, elements).

        A flow without a solution is never allowed, even where the base case has none either.
        """
        allowed = self.allowed[intervals]
        allowed[:, -1] = 0.0
        return np.asarray(excess > allowed + self._margins())

    def _margins(self) -> Floats:
        voltages = 2 * len(self.feeder.nodes)
        return np.where(np.arange(len(self.elements)) < voltages, MARGIN_PU, MARGIN_KVA)

    def breaches(self, station_kw: Floats) -> list[Breach]:
        """The certificate: every limit exceeded with the station drawing (intervals,) kW."""
        every = np.arange(self.scenario.intervals)
        excess = self.excess(every, station_kw)
        margins = 10 * self._margins()
        before = self.allowed.copy()
        # where there is no solution without the station, it may draw nothing on top of that
        before[station_kw > 0, -1] = 0.0
        return [
            Breach(
                interval=int(t),
                element=self.elements[i],
                depth=float(excess[t, i]),
                base_depth=float(before[t, i]),
                unit=self._unit(int(i)),
                tolerance=float(margins[i]),
            )
            for t, i in zip(*np.nonzero(excess > margins), strict=True)
        ]

    def _unit(self, element: int) -> str:
        if element == len(self.elements) - 1:
            return "solution missing"
        return "pu" if element < 2 * len(self.feeder.nodes) else "kVA"


def ac_limit_rows(scenario: Scenario) -> LimitRows:
    """Headroom of every interval by AC power flow, one row for each element that ever binds.

    A row's limit is infinite in the intervals in which another element binds.
    """
    headroom_kw, binding = ac_headroom(AcFeeder(scenario))
    elements = tuple(dict.fromkeys(binding))
    limit_kw = np.full((scenario.intervals, len(elements)), np.inf)
    for t, element in enumerate(binding):
        limit_kw[t, elements.index(element)] = headroom_kw[t]
    return LimitRows(elements, np.ones((len(elements), 1)), limit_kw)


def ac_headroom(feeder: AcFeeder) -> tuple[Floats, tuple[str, ...]]:
    """Headroom of each interval, kW, and the element that sets it; never above the true limit."""
    every = np.arange(feeder.scenario.intervals)
    low = np.zeros(len(every))
    reach = limit_rows(feeder.scenario).headroom_kw()
    high = np.where(np.isfinite(reach), reach * (1 + 1 / POINTS), 0.0) + FIRST_REACH_KW
    culprit = np.full(len(every), -1)
    bracketed = np.zeros(len(every), dtype=bool)
    open_now = every
    while len(open_now):
        tried = low[open_now, None] + (high - low)[open_now, None] * _fractions()
        excess, bad = _try(feeder, open_now, tried)
        fails: NDArray[np.bool_] = np.any(bad, axis=2)
        first = np.where(fails.any(axis=1), fails.argmax(axis=1), POINTS)
        for row, t in enumerate(open_now):
            if first[row] == POINTS:  # all allowed: reach further
                low[t], high[t] = tried[row, -1], 2 * high[t]
                continue
            bracketed[t] = True
            high[t] = tried[row, first[row]]
            low[t] = low[t] if first[row] == 0 else tried[row, first[row] - 1]
            at_fault = np.where(bad[row, first[row]], excess[row, first[row]], -np.inf)
            culprit[t] = int(at_fault.argmax())
        width = (high - low)[open_now]
        done = bracketed[open_now] & (
            width <= np.maximum(RESOLUTION_KW, RELATIVE_RESOLUTION * low[open_now])
        )
        open_now = open_now[~done]
    collapses = culprit == len(feeder.elements) - 1
    allowed_kw = np.where(collapses, (1 - SHORT_OF_COLLAPSE) * low, low)
    return allowed_kw, tuple(feeder.elements[i] for i in culprit)


def _fractions() -> Floats:
    return np.arange(1, POINTS + 1) / POINTS


def _try(
    feeder: AcFeeder, intervals: NDArray[np.int64], tried: Floats
) -> tuple[Floats, NDArray[np.bool_]]:
    """Excess and worsened limits at each power tried, (intervals, POINTS, elements)."""
    repeated = np.repeat(intervals, POINTS)
    excess = feeder.excess(repeated, tried.ravel())
    bad = feeder.worsened(repeated, excess)
    shape = (len(intervals), POINTS, len(feeder.elements))
    return excess.reshape(shape), bad.reshape(shape)
