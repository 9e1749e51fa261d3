"""bid-price: admit by what today's requests and those expected later are worth together.

Knows the arrival statistics and nothing else of the future. Contracts are as safe as under P1:
what it admits it schedules by P1 itself, with each hour's capacity at its expected price.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from evdash.domain.limits import Floats
from evdash.domain.plan import Plan, Policy, Refusal, Snapshot, SolveReport
from evdash.domain.scenario import ArrivalStatistics, GeneratedArrivals, Scenario
from evdash.domain.vehicles import Request
from evdash.errors import Fault, InputError
from evdash.policies.expectation import Expectation, best_admissions, sampled_days
from evdash.policies.futures import Futures, sample_futures
from evdash.scheduling.p1 import p1_policy
from evdash.scheduling.problem import candidates

SAMPLES = 8
PRICE_DIGITS = 4
"""Prices of capacity are told, and charged, to a hundredth of a cent."""


def bid_price(scenario: Scenario, samples: int = SAMPLES) -> Policy:
    """The policy for a scenario's station, options, clock and forecast, not its arrivals.

    Raises InputError if the scenario has no arrival statistics.
    """
    statistics = forecast_of(scenario)
    seed = scenario.arrivals.seed or 0
    return anticipating(scenario, sample_futures(scenario, statistics, samples, seed))


def forecast_of(scenario: Scenario) -> ArrivalStatistics:
    """What a policy may know of who will come: the generator's keys, or the forecast given."""
    known = scenario.arrivals
    if isinstance(known, GeneratedArrivals):
        return known
    if known.forecast is None:
        raise InputError(
            [
                Fault(
                    "scenario.toml, arrivals.forecast",
                    "nothing",
                    "arrival statistics, which policy bid-price needs where arrivals are from file",
                )
            ]
        )
    return known.forecast


def anticipating(scenario: Scenario, futures: Futures) -> Policy:
    """The policy that admits by the mean over these futures."""
    p1 = p1_policy()

    def policy(snapshot: Snapshot) -> Plan:
        asking = candidates(snapshot)
        if not asking and not snapshot.contracts:
            return _unsolved(p1(snapshot))
        days = sampled_days(snapshot, futures.coming(snapshot), len(asking))
        expected = best_admissions(days, len(asking))
        if expected is None:
            return _unsolved(p1(snapshot))
        price = capacity_price(scenario, snapshot, expected)
        chosen = _chosen(snapshot, asking, expected, price)
        plan = p1(chosen)
        losses = dict(zip((r.vehicle for r in asking), expected.slope.tolist(), strict=True))
        kept = _refusals(scenario, snapshot, losses, price, plan.admitted)
        return _unsolved(replace(plan, refused=kept, capacity_price_per_kwh=price))

    return policy


def capacity_price(scenario: Scenario, snapshot: Snapshot, expected: Expectation) -> Floats:
    """What a kWh in each slot is expected to be worth to others, $/kWh, (slots,).

    A charger's worth is spread over the energy it gives at full power.
    """
    full_kwh = scenario.station.max_kw * snapshot.interval_hours
    return np.round(expected.energy_price + expected.charger_price / full_kwh, PRICE_DIGITS)


def _chosen(
    snapshot: Snapshot, asking: tuple[Request, ...], expected: Expectation, price: Floats
) -> Snapshot:
    """The snapshot with capacity at its price, asked by those to be admitted alone.

    They pay so much more that P1 leaves one out only where there is no room for it.
    """
    dearer = snapshot.price_per_kwh + price
    more = float(np.round(max(0.0, dearer.max()), PRICE_DIGITS))
    return replace(
        snapshot,
        price_per_kwh=dearer,
        requests=tuple(
            replace(request, price_per_kwh=request.price_per_kwh + more)
            for request, admitted in zip(asking, expected.admitted, strict=True)
            if admitted > 0.5
        ),
    )


def _refusals(
    scenario: Scenario,
    snapshot: Snapshot,
    losses: Mapping[str, float],
    price: Floats,
    admitted: tuple[str, ...],
) -> tuple[Refusal, ...]:
    """Who is turned down, and what the room was kept for; `losses`, in $, of admitting each."""
    return tuple(
        Refusal(
            request.vehicle,
            request.refusal
            or _kept_for(scenario, snapshot, request, price, losses[request.vehicle]),
        )
        for request in snapshot.requests
        if request.vehicle not in admitted
    )


def _kept_for(
    scenario: Scenario, snapshot: Snapshot, request: Request, price: Floats, loss: float
) -> str:
    window = price[: request.deadline_interval - snapshot.now]
    if not window.any() or loss <= 0:
        return "no room before its deadline that contracts already made leave"
    dearest = int(window.argmax())
    clock = scenario.time_of(snapshot.now + dearest)
    return (
        f"kept for others: admitting it is expected to lose {loss:.2f} $ more than it pays, "
        f"room being worth most at {clock:%H:%M} ({window[dearest]:.3f} $/kWh)"
    )


def _unsolved(plan: Plan) -> Plan:
    """The plan without P1's objective and bound, which are those of another problem."""
    report = plan.report
    return replace(plan, report=SolveReport("feasible", seconds=report.seconds, note=report.note))
