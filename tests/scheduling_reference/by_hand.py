"""P1 worked independently: from a snapshot alone, by enumeration and scipy's LP.

Shares nothing with `evdash.scheduling`; slow, and for a handful of vehicles only.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np
from scipy.optimize import linprog

from evdash.domain.plan import Plan, Snapshot

HAIR = 1e-6

Pattern = tuple[bool, ...]


@dataclass(frozen=True)
class Car:
    """One vehicle: energy as kW·intervals, the slots open to it, the charger's limits."""

    need: float
    slots: int
    low_kw: float
    high_kw: float
    revenue: float


def cars_of(snapshot: Snapshot) -> tuple[list[Car], list[Car]]:
    """Contracts and newcomers; newcomers include those refused at the door."""
    contracts = [
        _car(snapshot, c.request, c.request.need_kwh - c.delivered_kwh, 0.0)
        for c in snapshot.contracts
    ]
    newcomers = [
        _car(snapshot, r, r.need_kwh, r.price_per_kwh * r.need_kwh) for r in snapshot.requests
    ]
    return contracts, newcomers


def _car(snapshot: Snapshot, request, kwh: float, revenue: float) -> Car:
    need = kwh / snapshot.interval_hours
    slots = min(request.deadline_interval, snapshot.now + snapshot.n_slots) - snapshot.now
    return Car(need, slots, min(request.min_kw, need), request.max_kw, revenue)


def patterns(car: Car, n_slots: int) -> list[Pattern]:
    """Every way to switch its charger on and off that can give what the car needs."""
    return [
        on
        for on in product((False, True), repeat=n_slots)
        if not any(on[car.slots :])
        and sum(on) * car.low_kw - HAIR <= car.need <= sum(on) * car.high_kw + HAIR
    ]


def fleets_charging(cars: Sequence[Car], n_slots: int, chargers: int) -> Iterator[np.ndarray]:
    """Every D (cars, slots) within the chargers."""
    for chosen in product(*(patterns(car, n_slots) for car in cars)):
        charging = np.array(chosen, dtype=bool).reshape(len(cars), n_slots)
        if (charging.sum(axis=0) <= chargers).all():
            yield charging


def least(
    cars: Sequence[Car],
    charging: np.ndarray,
    weight: np.ndarray,
    headroom_kw: np.ndarray,
    cost_limit: tuple[np.ndarray, float] | None = None,
) -> float:
    """min Σ weight[t]·P[n,t] under the energy, power and headroom limits with D fixed; inf if none.

    `cost_limit`: (weight of each slot, limit), one more row.
    """
    n, t = np.nonzero(charging)
    if not len(n):
        return 0.0
    energy = (np.arange(len(cars))[:, None] == n).astype(float)
    limits = (np.arange(charging.shape[1])[:, None] == t).astype(float)
    bound = np.where(np.isfinite(headroom_kw), np.maximum(0.0, headroom_kw), 1e9) + 1e-9
    if cost_limit is not None:
        limits = np.vstack([limits, cost_limit[0][t]])
        bound = np.append(bound, cost_limit[1])
    found = linprog(
        weight[t],
        A_ub=limits,
        b_ub=bound,
        A_eq=energy,
        b_eq=[car.need for car in cars],
        bounds=[(cars[i].low_kw - 1e-9, cars[i].high_kw + 1e-9) for i in n],
    )
    return float(found.fun) if found.status == 0 else np.inf


def best_objective(snapshot: Snapshot) -> float:
    """The optimum of P1, $, by trying every set of newcomers and every D."""
    contracts, newcomers = cars_of(snapshot)
    price = snapshot.price_per_kwh * snapshot.interval_hours
    headroom_kw = snapshot.rows.headroom_kw()
    best = np.inf
    for size in range(len(newcomers) + 1):
        for admitted in combinations(newcomers, size):
            cars = [*contracts, *admitted]
            revenue = sum(car.revenue for car in admitted)
            for charging in fleets_charging(cars, snapshot.n_slots, snapshot.chargers):
                best = min(best, least(cars, charging, price, headroom_kw) - revenue)
    return best


def least_shortfall(snapshot: Snapshot) -> float:
    """Least energy, kWh, that the contracts together must miss, by trying every D."""
    contracts, _ = cars_of(snapshot)
    headroom_kw = np.maximum(0.0, snapshot.rows.headroom_kw())
    owed = sum(car.need for car in contracts)
    most = 0.0
    anything = [
        [
            on
            for on in product((False, True), repeat=snapshot.n_slots)
            if not any(on[car.slots :]) and sum(on) * car.low_kw <= car.need + HAIR
        ]
        for car in contracts
    ]
    for chosen in product(*anything):
        charging = np.array(chosen, dtype=bool).reshape(len(contracts), snapshot.n_slots)
        at_best = sum(
            min(car.need, sum(on) * car.high_kw) for car, on in zip(contracts, chosen, strict=True)
        )
        if (charging.sum(axis=0) <= snapshot.chargers).all() and at_best > most:
            most = max(most, _most_delivered(contracts, charging, headroom_kw))
    return (owed - most) * snapshot.interval_hours


def _most_delivered(cars: Sequence[Car], charging: np.ndarray, headroom_kw: np.ndarray) -> float:
    n, t = np.nonzero(charging)
    energy = (np.arange(len(cars))[:, None] == n).astype(float)
    limits = (np.arange(charging.shape[1])[:, None] == t).astype(float)
    room = np.where(np.isfinite(headroom_kw), headroom_kw, 1e9)
    found = linprog(
        -np.ones(len(n)),
        A_ub=np.vstack([energy, limits]),
        b_ub=np.concatenate([[car.need for car in cars], room]),
        bounds=[(cars[i].low_kw, cars[i].high_kw) for i in n],
    )
    return -float(found.fun) if found.status == 0 else 0.0


def earliness(snapshot: Snapshot, power_kw: np.ndarray) -> float:
    """Σ (t − now)·P·Δt: small is early."""
    return float(np.arange(snapshot.n_slots) @ power_kw.sum(axis=0)) * snapshot.interval_hours


def earliest_possible(snapshot: Snapshot, plan: Plan, energy_cost_limit: float) -> float:
    """The least earliness any plan with the same u and D reaches within a cost, $."""
    contracts, newcomers = cars_of(snapshot)
    admitted = [
        car
        for car, r in zip(newcomers, snapshot.requests, strict=True)
        if r.vehicle in plan.admitted
    ]
    hours = snapshot.interval_hours
    weight = np.arange(snapshot.n_slots) * hours
    limit = (snapshot.price_per_kwh * hours, energy_cost_limit)
    headroom_kw = snapshot.rows.headroom_kw()
    return least([*contracts, *admitted], plan.power_kw > 0, weight, headroom_kw, limit)
