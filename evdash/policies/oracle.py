"""The oracle: the whole day known in advance, so the ceiling of every policy within the limits."""

import time
from dataclasses import dataclass

import numpy as np

from evdash.domain.plan import Plan, Policy, Refusal, Snapshot, SolveReport
from evdash.domain.refusal import RefusalReason
from evdash.domain.trace import Inputs
from evdash.domain.vehicles import ENERGY_TOLERANCE_KWH, Request
from evdash.horizon.advance import initial_state, snapshot_of
from evdash.scheduling.clean import cleaned
from evdash.scheduling.effort import Effort
from evdash.scheduling.fast.solver import solved
from evdash.scheduling.foresight import known_day
from evdash.scheduling.problem import Problem, Solution
from evdash.scheduling.refused import alone_at_the_station

WORK = 1e9
"""As `Effort` counts; only a safety: nodes decide."""


@dataclass(frozen=True, slots=True)
class Foresight:
    """The best day and the profit no policy within the limits can exceed, $."""

    problem: Problem
    solution: Solution
    first: int

    @property
    def most_profit(self) -> float:
        return -self.solution.bound


def foresee(inputs: Inputs) -> Foresight:
    """The best day of these inputs from its start."""
    return _from_here(snapshot_of(inputs, initial_state(inputs.scenario.intervals)), inputs)


class Oracle:
    """The policy that knows everyone who comes.

    It carries the best day out. Where the day is not the one it foresaw, as after an event or
    a change in mid-day, it looks ahead again from there.
    """

    def __init__(self, inputs: Inputs) -> None:
        self.inputs = inputs
        self.foresight = foresee(inputs)

    def __call__(self, snapshot: Snapshot, /) -> Plan:
        began = time.perf_counter()
        if not _holds(self.foresight, snapshot):
            self.foresight = _from_here(snapshot, self.inputs)
        return _part(self.foresight, snapshot, began)


def oracle(inputs: Inputs) -> Policy:
    """The oracle of a day, its arrivals known."""
    return Oracle(inputs)


def _holds(foresight: Foresight, snapshot: Snapshot) -> bool:
    """Whether the day has gone as foreseen, limits, prices and contracts alike."""
    problem, begin = foresight.problem, snapshot.now - foresight.first
    if begin < 0:
        return False
    place = {name: n for n, name in enumerate(problem.vehicles)}
    left = foresight.solution.power_kw[:, begin:].sum(axis=1) * problem.interval_hours
    return (
        np.array_equal(problem.rows.limit_kw[begin:], snapshot.rows.limit_kw)
        and problem.tariff[begin:].is_same(snapshot.tariff)
        and problem.chargers == snapshot.chargers
        and all(
            contract.vehicle in place
            and abs(left[place[contract.vehicle]] - contract.owed_kwh) <= ENERGY_TOLERANCE_KWH
            for contract in snapshot.contracts
        )
    )


def _part(foresight: Foresight, snapshot: Snapshot, began: float) -> Plan:
    """What the best day says of those here now."""
    problem, solution = foresight.problem, foresight.solution
    place = {name: n for n, name in enumerate(problem.vehicles)}
    admitted = tuple(
        request.vehicle
        for request in snapshot.requests
        if request.vehicle in place and solution.admitted[place[request.vehicle]]
    )
    vehicles = (*(contract.vehicle for contract in snapshot.contracts), *admitted)
    rows = [place[name] for name in vehicles]
    return Plan(
        now=snapshot.now,
        vehicles=vehicles,
        power_kw=solution.power_kw[rows, snapshot.now - foresight.first :],
        admitted=admitted,
        refused=tuple(
            Refusal(
                request.vehicle,
                request.refusal
                or alone_at_the_station(snapshot, request)
                or RefusalReason("best day"),
            )
            for request in snapshot.requests
            if request.vehicle not in admitted
        ),
        report=SolveReport("feasible", seconds=time.perf_counter() - began),
    )


def _from_here(snapshot: Snapshot, inputs: Inputs) -> Foresight:
    groups = inputs.requests[snapshot.now + 1 : -1]
    coming: tuple[Request, ...] = tuple(r for group in groups for r in group)
    day = known_day(snapshot, coming)
    problem, solution = day.problem, solved(day, Effort(WORK))
    power_kw = cleaned(problem, solution.admitted, solution.power_kw)
    return Foresight(problem, Solution(solution.admitted, power_kw, solution.bound), snapshot.now)
