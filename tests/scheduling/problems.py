"""Random intervals of P1, small enough for the plain formulation, and the judge of a solution."""

import numpy as np

from evdash.domain.elements import Element
from evdash.domain.limits import Floats, LimitRows
from evdash.domain.tariff import Tariff
from evdash.scheduling.problem import Problem, Solution

HAIR = 1e-6


def random_problem(
    rng: np.random.Generator,
    max_vehicles: int = 7,
    max_slots: int = 6,
    slack: float | None = None,
) -> Problem:
    """An interval with contracts, whose tail may leave no room at all, and requests.

    Among them: quarter-hours, small and unattainable needs, negative and equal prices, own
    limits, zero chargers, zero headroom, no limit at all. `slack` is the room beyond the tail.
    """
    n_slots, hours = int(rng.integers(1, max_slots + 1)), float(rng.choice([0.25, 0.5, 1.0]))
    n_contracts = int(rng.integers(0, max_vehicles // 2 + 1))
    n_new = int(rng.integers(0 if n_contracts else 1, max_vehicles - n_contracts + 1))
    n, min_kw = n_contracts + n_new, float(rng.choice([0.0, 1.4, 3.3, 3.3, 6.0]))
    high = rng.choice([6.0, 7.2, 11.0, 19.2], size=n)
    left = rng.integers(1, n_slots + 1, size=n)
    owed_kw = rng.uniform(0.02, 1.1, size=n) * high * rng.integers(1, n_slots + 1, size=n)
    owed_kw = np.where(rng.random(n) < 0.15, rng.uniform(0.01, 4.0, size=n), owed_kw)
    owed_kw = np.where(rng.random(n) < 0.2, high * rng.integers(1, 4, size=n), owed_kw)
    tail = np.zeros((n, n_slots))
    for v in range(n_contracts):
        tail[v] = _random_row(rng, n_slots, int(left[v]), min_kw, float(high[v]))
    owed_kw[:n_contracts] = tail[:n_contracts].sum(axis=1)
    used, running = tail.sum(axis=0), (tail > 0).sum(axis=0)
    beyond = rng.choice([0.0, 0.3, 1.0, 2.0]) if slack is None else slack
    room = used + beyond * rng.uniform(0, 20, size=n_slots) * rng.integers(0, 2, size=n_slots)
    chargers = int(max(running.max(initial=0), rng.integers(0, n + 1)))
    price = rng.choice([rng.uniform(-0.1, 0.5, n_slots), np.round(rng.uniform(0, 0.4, n_slots), 1)])
    revenue = rng.choice([0.25, 0.35, 0.5], size=n) * owed_kw * hours
    revenue[:n_contracts] = 0.0
    limited = rng.random() < 0.9
    return Problem(
        vehicles=tuple(f"v{v}" for v in range(n)),
        n_contracts=n_contracts,
        owed_kwh=owed_kw * hours,
        intervals_left=left.astype(np.int64),
        low_kw=np.minimum(min_kw, owed_kw),
        high_kw=high,
        revenue=revenue,
        tariff=Tariff(price, hours),
        chargers=chargers,
        rows=LimitRows(
            elements=(Element("line", "a", "b"), Element("voltage_min", "b")) if limited else (),
            coefficient=np.ones((2 if limited else 0, 1)),
            limit_kw=np.stack([room, room + 1], axis=1) if limited else np.empty((n_slots, 0)),
        ),
        tail_kw=tail,
    )


def _random_row(
    rng: np.random.Generator, n_slots: int, left: int, min_kw: float, max_kw: float
) -> Floats:
    """A contract's tail: power in some slots of its window."""
    row = np.zeros(n_slots)
    on = rng.choice(left, size=int(rng.integers(1, left + 1)), replace=False)
    row[on] = rng.choice(
        [rng.uniform(min_kw, max_kw, len(on)), np.full(len(on), max_kw), np.full(len(on), min_kw)]
    )
    if row.sum() == 0:
        row[on[0]] = max_kw
    return row


def violations(problem: Problem, solution: Solution) -> list[str]:
    """Which of P1's constraints a solution breaks by more than a hair, from the arrays alone."""
    power, u = solution.power_kw, solution.admitted
    running = power > HAIR
    open_slots = np.arange(problem.n_slots) < problem.intervals_left[:, None]
    energy = power.sum(axis=1) * problem.interval_hours
    broken = {
        "(5a) contracts": not u[: problem.n_contracts].all(),
        "(6a) only contracts": running[~u].any(),
        "(6b) lowest": (running & (power < problem.low_kw[:, None] - HAIR)).any(),
        "(6b) highest": (power > problem.high_kw[:, None] + HAIR).any(),
        "(7a) window": (running & ~open_slots).any(),
        "(7b) energy": (np.abs(energy - problem.owed_kwh * u) > HAIR).any(),
        "(8) feeder": (power.sum(axis=0)[:, None] > problem.rows.limit_kw + HAIR).any(),
        "(9) chargers": (running.sum(axis=0) > problem.chargers).any(),
    }
    return [name for name, is_broken in broken.items() if is_broken]
