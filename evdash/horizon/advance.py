"""From one interval to the next: equation (10), without a solver and without mutation."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from evdash.domain.plan import Plan, Snapshot
from evdash.domain.refusal import RefusalReason
from evdash.domain.trace import Inputs, State
from evdash.domain.vehicles import Contract, Request

PROMISES_SHORT = RefusalReason("promises short")


def initial_state(n_intervals: int) -> State:
    """Nobody under contract, at the start of interval 0."""
    return State(now=0, contracts=(), tail_kw=np.zeros((0, n_intervals)))


def snapshot_of(inputs: Inputs, state: State) -> Snapshot:
    """What is known at `state.now`: nothing of who comes later.

    While a promise is short nobody new can be served: requests then say so at the door.
    """
    scenario = inputs.scenario
    requests = inputs.requests[state.now]
    if state.is_short:
        requests = tuple(replace(r, refusal=r.refusal or PROMISES_SHORT) for r in requests)
    return Snapshot(
        now=state.now,
        chargers=scenario.station.chargers,
        tariff=scenario.tariff[state.now :],
        rows=inputs.rows.from_interval(state.now),
        contracts=state.contracts,
        requests=requests,
        tail_kw=state.tail_kw,
        asked=tuple(len(group) for group in inputs.requests[: state.now]),
    )


def contracts_under(
    plan: Plan, contracts: tuple[Contract, ...], requests: tuple[Request, ...]
) -> tuple[Contract, ...]:
    """The contracts a plan serves, in the order of its rows: open ones, then the new."""
    admitted = {request.vehicle: request for request in requests}
    return contracts + tuple(Contract(admitted[name]) for name in plan.vehicles[len(contracts) :])


def advance(
    state: State, plan: Plan, requests: tuple[Request, ...], interval_hours: float
) -> State:
    """(10): deliver the plan's first slot, count down, keep the rest as the tail.

    A contract leaves when it is fulfilled or its deadline has passed; one whose terms were cut
    waits for its deadline, should there be room again.
    """
    now = state.now + 1
    charged = [
        contract.charged(float(plan.power_kw[n, 0]) * interval_hours)
        for n, contract in enumerate(contracts_under(plan, state.contracts, requests))
    ]
    stays = [
        n
        for n, contract in enumerate(charged)
        if not contract.is_fulfilled and contract.request.deadline_interval > now
    ]
    tail_kw = plan.power_kw[stays, 1:]
    tail_kw.setflags(write=False)
    return State(
        now=now,
        contracts=tuple(charged[n] for n in stays),
        tail_kw=tail_kw,
        waiting=still_waiting((*state.waiting, *charged), now),
    )


def still_waiting(contracts: Iterable[Contract], now: int) -> tuple[Contract, ...]:
    """Contracts that got all that was planned, are short of their promise and not yet over."""
    return tuple(
        contract
        for contract in contracts
        if contract.is_fulfilled and contract.is_short and contract.request.deadline_interval > now
    )
