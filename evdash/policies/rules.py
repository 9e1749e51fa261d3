"""Rules of precedence: first come, earliest deadline, least laxity; and no rule at all.

The first three keep the feeder's limits and every contract: a newcomer is admitted only if the
rule then still serves everybody in time. They ask neither for prices nor for who pays more.
"""

import time

import numpy as np

from evdash.domain.limits import Floats
from evdash.domain.plan import Plan, Policy, Refusal, Snapshot, SolveReport
from evdash.domain.refusal import RefusalReason
from evdash.domain.vehicles import Request
from evdash.policies.dispatch import Charge, Precedence, dispatch
from evdash.scheduling.clean import cleaned
from evdash.scheduling.problem import Problem, problem_of
from evdash.scheduling.refused import short_of_headroom

DIGITS = 6
"""Laxities equal to so many digits are equal: ties must not hang on the last bit."""


def first_come(charge: Charge, _owed_kw: float, _slots_left: int) -> tuple[float, ...]:
    """First come, first served."""
    return (charge.arrival_order,)


def earliest_deadline(charge: Charge, _owed_kw: float, slots_left: int) -> tuple[float, ...]:
    """Who has to be back first goes first."""
    return (slots_left, charge.arrival_order)


def least_laxity(charge: Charge, owed_kw: float, slots_left: int) -> tuple[float, ...]:
    """Who could wait least goes first: slots left less the slots its charge takes."""
    return (round(slots_left - owed_kw / charge.high_kw, DIGITS), charge.arrival_order)


def by(precedence: Precedence) -> Policy:
    """The policy that charges, and admits, by a rule of precedence."""
    rule = (precedence.__doc__ or "").rstrip(".").lower()

    def policy(snapshot: Snapshot) -> Plan:
        began = time.perf_counter()
        problem = problem_of(snapshot)
        power_kw, admitted = _admitted_in_turn(problem, precedence)
        return _plan(snapshot, problem, admitted, power_kw, began=began, rule=rule)

    return policy


def uncoordinated(snapshot: Snapshot) -> Plan:
    """Everyone admitted and charged at full power at once; no limit of grid or station is kept."""
    began = time.perf_counter()
    problem = problem_of(snapshot)
    everyone = list(range(problem.n_vehicles))
    unlimited = np.full(problem.n_slots, np.inf)
    power_kw = dispatch(
        _charges(problem, everyone), unlimited, [len(everyone)] * problem.n_slots, first_come
    )
    if power_kw is None:  # whoever full power cannot serve was refused at the door
        power_kw = problem.tail_kw
        everyone = everyone[: problem.n_contracts]
    return _plan(snapshot, problem, everyone, power_kw, began=began, rule="full power at once")


def _admitted_in_turn(problem: Problem, precedence: Precedence) -> tuple[Floats, list[int]]:
    """Power of those admitted, (admitted, slots), and who they are: newcomers asked in turn.

    Where the rule cannot serve the contracts (limits were changed in mid-day, say), they keep
    the last plan's tail, and the rule divides what that leaves.
    """
    room_kw = problem.rows.headroom_kw()
    chargers = np.full(problem.n_slots, problem.chargers)
    contracts = list(range(problem.n_contracts))
    ruled, kept = contracts, problem.tail_kw[:0]
    power_kw = dispatch(_charges(problem, ruled), room_kw, list(chargers), precedence)
    if power_kw is None:
        kept = problem.tail_kw[: problem.n_contracts]
        room_kw, chargers = room_kw - kept.sum(axis=0), chargers - (kept > 0).sum(axis=0)
        ruled, power_kw = [], kept[:0]
    for newcomer in range(problem.n_contracts, problem.n_vehicles):
        attempt = [*ruled, newcomer]
        with_it = dispatch(_charges(problem, attempt), room_kw, list(chargers), precedence)
        if with_it is not None:
            ruled, power_kw = attempt, with_it
    admitted = ruled if not len(kept) else contracts + ruled
    return np.vstack([kept, power_kw]), admitted


def _charges(problem: Problem, vehicles: list[int]) -> list[Charge]:
    return [
        Charge(
            owed_kw=float(problem.owed_kwh[n]) / problem.interval_hours,
            low_kw=float(problem.low_kw[n]),
            high_kw=float(problem.high_kw[n]),
            slots=int(problem.intervals_left[n]),
            arrival_order=n,
        )
        for n in vehicles
    ]


def _plan(
    snapshot: Snapshot,
    problem: Problem,
    admitted: list[int],
    power_kw: Floats,
    *,
    began: float,
    rule: str,
) -> Plan:
    """The plan of those admitted, exact to the last bit; P1 was not solved, so no objective."""
    whole = np.zeros((problem.n_vehicles, problem.n_slots))
    whole[admitted] = power_kw
    chosen = np.isin(np.arange(problem.n_vehicles), admitted)
    vehicles = tuple(problem.vehicles[n] for n in admitted)
    return Plan(
        now=snapshot.now,
        vehicles=vehicles,
        power_kw=cleaned(problem, chosen, whole)[admitted],
        admitted=vehicles[problem.n_contracts :],
        refused=tuple(
            Refusal(request.vehicle, request.refusal or _reason(snapshot, request, rule))
            for request in snapshot.requests
            if request.vehicle not in vehicles
        ),
        report=SolveReport("feasible", seconds=time.perf_counter() - began),
    )


def _reason(snapshot: Snapshot, request: Request, rule: str) -> RefusalReason:
    """Rules ask for no price: what refuses is the feeder by itself, or else the rule."""
    return short_of_headroom(snapshot, request) or RefusalReason("rule", where=rule)
