"""The AC network model: headroom found by power flow, and a certificate for every plan.

An interval's headroom is the largest station power for which the full AC power flow worsens no
limit, no solution counting as a limit. It is searched upward from zero, so that nothing beyond
the first infeasible power is ever taken for allowed.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evdash.domain.breach import Breach
from evdash.domain.elements import Element
from evdash.domain.limits import Floats, LimitRows
from evdash.domain.scenario import Scenario
from evdash.grid.acbatch import AcBatch
from evdash.grid.lindistflow import base_injections
from evdash.grid.radial import radial_feeder
from evdash.grid.reduction import limit_rows
from evdash.grid.sides import Side, by_side

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
        self.rated = np.flatnonzero(np.isfinite(self.feeder.line_rating_kva))
        own_kva = next(n.rating_kva for n in scenario.nodes if n.node == scenario.station.node)
        self.node_is_rated = own_kva is not None
        self.rating_kva = self.feeder.line_rating_kva[self.rated]
        if own_kva is not None:
            self.rating_kva = np.append(self.rating_kva, own_kva)
        self.elements = self._elements()
        every = np.arange(scenario.intervals)
        self.base = self._solve(every, np.zeros(scenario.intervals))

    def _elements(self) -> tuple[Element, ...]:
        """Lower and upper voltages, imports and exports of what is rated, the power flow."""
        nodes, station = self.feeder.nodes, self.scenario.station.node
        rated = [self.feeder.lines[row] for row in self.rated]
        rated += [Element("node", station)] if self.node_is_rated else []
        return (
            *(Element("voltage_min", node) for node in nodes),
            *(Element("voltage_max", node) for node in nodes),
            *rated,
            *(element.export_side for element in rated),
            Element("power_flow", station),
        )

    def excess(self, intervals: NDArray[np.int64], station_kw: Floats) -> tuple[Floats, Floats]:
        """How far each side of each limit is exceeded, and how far by the feeder itself.

        Both (flows, elements), voltages in pu, ratings in kVA; the first is negative where the
        limit is kept, -inf on the side on which nothing flows, the second never negative. Without
        a solution the last column is 1 and the others say nothing (-inf).
        """
        now, base = self._solve(intervals, station_kw), self.base
        rated = [side.kva - self.rating_kva for side in now.sides]
        own = [
            side.held_kva(of_base.end_kva[intervals]) - self.rating_kva
            for side, of_base in zip(now.sides, base.sides, strict=True)
        ]
        solved = now.solved[:, None]
        found = np.where(solved, np.hstack([now.voltage_excess_pu, *rated]), -np.inf)
        held = np.hstack([base.voltage_excess_pu[intervals], *own])
        unsolved = ~base.solved[intervals, None]
        return (
            np.hstack([found, np.where(solved, -np.inf, 1.0)]),
            np.hstack([np.where(held > 0, held, 0.0), unsolved.astype(float)]),
        )

    def _solve(self, intervals: NDArray[np.int64], station_kw: Floats) -> "_Solved":
        active = self.injections.active_kw[intervals].copy()
        active[:, self.station] -= station_kw
        reactive = self.injections.reactive_kvar[intervals]
        flows, limits = self.batch.solve(active, reactive), self.scenario.feeder
        power = flows.line_power[:, self.rated]
        if self.node_is_rated:
            own = -(active[:, self.station] + 1j * reactive[:, self.station])
            both_ends = np.repeat(own[:, None, None], 2, axis=2)
            power = np.concatenate([power, both_ends], axis=1)
        low = limits.voltage_min_pu - flows.voltage_pu
        high = flows.voltage_pu - limits.voltage_max_pu
        return _Solved(flows.solved, np.hstack([low, high]), by_side(power))

    def worsened(self, excess: Floats, own: Floats) -> NDArray[np.bool_]:
        """Which sides of limits are exceeded by more than the feeder itself does.

        A flow without a solution is never allowed, even where the base case has none either.
        """
        found = excess > own + self._margins()
        found[:, -1] = excess[:, -1] > 0
        return np.asarray(found)

    def _margins(self) -> Floats:
        voltages = 2 * len(self.feeder.nodes)
        return np.where(np.arange(len(self.elements)) < voltages, MARGIN_PU, MARGIN_KVA)

    def breaches(self, station_kw: Floats) -> list[Breach]:
        """The certificate: every limit exceeded with the station drawing (intervals,) kW."""
        excess, own = self.excess(np.arange(self.scenario.intervals), station_kw)
        margins = 10 * self._margins()
        # where there is no solution without the station, it may draw nothing on top of that
        own[station_kw > 0, -1] = 0.0
        return [
            Breach(
                interval=int(t),
                element=self.elements[i],
                depth=float(excess[t, i]),
                base_depth=float(own[t, i]),
                unit=self._unit(int(i)),
                tolerance=float(margins[i]),
            )
            for t, i in zip(*np.nonzero(excess > margins), strict=True)
        ]

    def _unit(self, element: int) -> str:
        if self.elements[element].kind == "power_flow":
            return "solution missing"
        return "pu" if self.elements[element].is_voltage else "kVA"


@dataclass(frozen=True, slots=True)
class _Solved:
    """Flows held against limits: solved (flows,); voltage_excess_pu (flows, 2·nodes), lower limits
    first; both sides of what is rated, (flows, ratings, ends)."""

    solved: NDArray[np.bool_]
    voltage_excess_pu: Floats
    sides: tuple[Side, Side]


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


def ac_headroom(feeder: AcFeeder) -> tuple[Floats, tuple[Element, ...]]:
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
    return allowed_kw, tuple(feeder.elements[int(i)].import_side for i in culprit)


def _fractions() -> Floats:
    return np.arange(1, POINTS + 1) / POINTS


def _try(
    feeder: AcFeeder, intervals: NDArray[np.int64], tried: Floats
) -> tuple[Floats, NDArray[np.bool_]]:
    """Excess and worsened limits at each power tried, (intervals, POINTS, elements)."""
    excess, own = feeder.excess(np.repeat(intervals, POINTS), tried.ravel())
    bad = feeder.worsened(excess, own)
    shape = (len(intervals), POINTS, len(feeder.elements))
    return excess.reshape(shape), bad.reshape(shape)
