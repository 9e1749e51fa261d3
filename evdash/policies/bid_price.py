"""bid-price: admit by what today's requests and those expected later are worth together.

Knows the arrival statistics and nothing else of the future. Contracts are as safe as under P1:
what it admits it schedules by P1 itself, with each hour's capacity at its expected price.
"""

import time
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from evdash.domain.arrivals import ArrivalStatistics, GeneratedArrivals
from evdash.domain.limits import Floats
from evdash.domain.plan import Plan, Policy, Refusal, Snapshot, SolveReport
from evdash.domain.refusal import RefusalReason
from evdash.domain.scenario import Scenario
from evdash.domain.tariff import Tariff
from evdash.domain.vehicles import Request
from evdash.errors import Fault, InputError
from evdash.policies.expectation import (
    Expectation,
    SampledDay,
    best_admissions,
    costs_of,
    expectation_of,
    sampled_days,
)
from evdash.policies.futures import Futures, sample_futures
from evdash.scheduling.clean import cleaned
from evdash.scheduling.effort import Effort
from evdash.scheduling.nearest import nearest_schedule
from evdash.scheduling.p1 import REASON_WORK, p1_answers, p1_plans
from evdash.scheduling.problem import candidates, problem_of
from evdash.scheduling.refused import LEFT_OUT, alone_at_the_station, reasoned

SAMPLES = 8
WORK = 1e7
"""Of finding the nearest schedule, as `Effort` counts; only a safety: nodes decide."""
CAUTION = 1.0
"""Standard errors by which departing from P1 has to be worth more."""
PRICE_DIGITS = 4
"""Prices of capacity are told, and charged, to a hundredth of a cent."""


def bid_price(scenario: Scenario, samples: int = SAMPLES) -> Policy:
    """The policy for a scenario's station, options, clock and forecast, not its arrivals.

    Raises InputError if the scenario has no arrival statistics.
    """
    return informed(scenario, forecast_of(scenario), samples)


def informed(scenario: Scenario, statistics: ArrivalStatistics, samples: int = SAMPLES) -> Policy:
    """The policy that was told these statistics, right or wrong."""
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
    """The policy that decides by the mean over these futures.

    It departs from P1 only where that is worth more by as much as the futures' own spread
    leaves sure.
    """
    p1, answers = p1_plans(), p1_answers(work=REASON_WORK)

    def policy(snapshot: Snapshot) -> Plan:
        began = time.perf_counter()
        asking, own = candidates(snapshot), p1(snapshot)
        if not asking and not snapshot.contracts:
            return _timed(own, began)
        days = sampled_days(snapshot, futures.coming(snapshot), len(asking))
        expected = best_admissions(days, len(asking))
        if expected is None:
            return _timed(own, began)
        price = capacity_price(scenario, snapshot, expected)
        ours = _anticipated(snapshot, asking, expected, price)
        if ours is None or not _is_better(days, snapshot, asking, ours, own):
            return _timed(replace(own, capacity_price_per_kwh=price), began)
        losses = expected_losses(days, asking, expected, ours.admitted)
        kept = _refusals(scenario, snapshot, losses, price, ours.admitted)
        return _timed(replace(ours, refused=kept, capacity_price_per_kwh=price), began)

    return reasoned(policy, answers)


def _anticipated(
    snapshot: Snapshot, asking: tuple[Request, ...], expected: Expectation, price: Floats
) -> Plan | None:
    """The plan for those to be admitted that begins as the futures would have it in the mean.

    Where not all of them can be served after all, P1 at the price of capacity says who can.
    """
    dearer = snapshot.tariff.dearer_by(price)
    chosen = tuple(r for r, yes in zip(asking, expected.admitted, strict=True) if yes > 0.5)
    first_kw = dict(zip(_present(snapshot, asking), expected.first_kw.tolist(), strict=True))
    plan = _nearest_plan(snapshot, chosen, first_kw, dearer)
    return plan or _nearest_plan(snapshot, _served(snapshot, chosen, dearer), first_kw, dearer)


def _nearest_plan(
    snapshot: Snapshot, served: tuple[Request, ...], first_kw: Mapping[str, float], tariff: Tariff
) -> Plan | None:
    """The plan for the contracts and all of these whose first slot is nearest to the one wished."""
    problem = problem_of(replace(snapshot, requests=served))
    wished = np.array([first_kw[vehicle] for vehicle in problem.vehicles])
    power_kw = nearest_schedule(problem, wished, tariff, Effort(WORK))
    if power_kw is None:
        return None
    return Plan(
        now=snapshot.now,
        vehicles=problem.vehicles,
        power_kw=cleaned(problem, np.ones(problem.n_vehicles, dtype=bool), power_kw),
        admitted=problem.vehicles[problem.n_contracts :],
    )


def _served(snapshot: Snapshot, chosen: tuple[Request, ...], tariff: Tariff) -> tuple[Request, ...]:
    """Those of the chosen for whom there is room: they pay so much that only that counts."""
    more = max(0.0, float(tariff.price_per_kwh.max()))
    paying = tuple(r.paying_more(more) for r in chosen)
    asked = replace(snapshot, tariff=tariff, requests=paying)
    admitted = p1_plans()(asked).admitted
    return tuple(r for r in chosen if r.vehicle in admitted)


def _is_better(
    days: list[SampledDay], snapshot: Snapshot, asking: tuple[Request, ...], ours: Plan, own: Plan
) -> bool:
    """Whether our plan is worth more than P1's own on the same futures, beyond their spread."""
    costs = [costs_of(days, *_decision(snapshot, asking, plan)) for plan in (own, ours)]
    gain = costs[0] - costs[1]
    if np.isnan(gain).any():
        return False
    spread = float(gain.std(ddof=1)) if len(gain) > 1 and np.isfinite(gain).all() else 0.0
    return bool(gain.mean() > CAUTION * spread / len(gain) ** 0.5)


def _decision(snapshot: Snapshot, asking: tuple[Request, ...], plan: Plan) -> tuple[Floats, Floats]:
    """Who of those asking is admitted, (requests,), and what all present draw now, kW."""
    first_kw = dict(zip(plan.vehicles, plan.power_kw[:, 0].tolist(), strict=True))
    admitted = np.array([float(r.vehicle in plan.admitted) for r in asking])
    return admitted, np.array([first_kw.get(one, 0.0) for one in _present(snapshot, asking)])


def _present(snapshot: Snapshot, asking: tuple[Request, ...]) -> tuple[str, ...]:
    """Everyone the futures were asked about: the contracts, then those asking."""
    return (*(c.vehicle for c in snapshot.contracts), *(r.vehicle for r in asking))


def capacity_price(scenario: Scenario, snapshot: Snapshot, expected: Expectation) -> Floats:
    """What a kWh in each slot is expected to be worth to others, $/kWh, (slots,).

    A charger's worth is spread over the energy it gives at full power.
    """
    full_kwh = scenario.station.max_kw * snapshot.interval_hours
    return np.round(expected.energy_price + expected.charger_price / full_kwh, PRICE_DIGITS)


def expected_losses(
    days: list[SampledDay],
    asking: tuple[Request, ...],
    expected: Expectation,
    admitted: tuple[str, ...],
) -> dict[str, float]:
    """By how much admitting each of those refused as well would cost more in the mean, $.

    Nan where some future has no room for it: then that, and not its worth to others, refuses it.
    """
    losses = {}
    for n, request in enumerate(asking):
        if request.vehicle in admitted:
            continue
        with_it = np.where(np.arange(len(asking)) == n, 1.0, expected.admitted)
        found = expectation_of(days, with_it)
        losses[request.vehicle] = np.nan if found is None else found.cost - expected.cost
    return losses


def _refusals(
    scenario: Scenario,
    snapshot: Snapshot,
    losses: Mapping[str, float],
    price: Floats,
    admitted: tuple[str, ...],
) -> tuple[Refusal, ...]:
    """Who is turned down, and why; `losses`, in $, are those expected of admitting each."""
    return tuple(
        Refusal(
            request.vehicle,
            request.refusal
            or _reason(scenario, snapshot, request, price, losses.get(request.vehicle, np.nan)),
        )
        for request in snapshot.requests
        if request.vehicle not in admitted
    )


def _reason(
    scenario: Scenario, snapshot: Snapshot, request: Request, price: Floats, loss: float
) -> RefusalReason:
    """What refuses it at an empty station; or that room is kept; or else whatever P1 would say."""
    alone = alone_at_the_station(snapshot, request)
    if alone is not None or not loss > 0:
        return alone or LEFT_OUT
    window = price[: request.deadline_interval - snapshot.now]
    if not window.any():
        return LEFT_OUT
    clock = scenario.time_of(snapshot.now + int(window.argmax()))
    where = f"{clock:%H:%M} (${window.max():.3f}/kWh)"
    return RefusalReason("kept for others", loss=loss, where=where)


def _timed(plan: Plan, began: float) -> Plan:
    """The plan without P1's objective and bound, as it was not P1 that was asked."""
    seconds = time.perf_counter() - began
    return replace(plan, report=SolveReport("feasible", seconds=seconds, note=plan.report.note))
