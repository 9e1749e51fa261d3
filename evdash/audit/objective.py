"""The audit of objective, bound and status: P1's plans are in no file, yet much follows from them.

An objective cannot be worked out again from executed power alone. It is held between what its
neighbours and the executed day leave possible; `audit --optimum` proves P1 anew.
"""

import math
from collections.abc import Iterator, Mapping

from evdash.audit.moments import Moment, least_cost
from evdash.audit.record import RunRecord
from evdash.files.run_tables import IntervalRow

CENT = 0.01
MONEY = 1e-6
HAIR_USD = 1e-4
"""What limits may be relaxed by, in floating point, is worth no more."""
SOLVES_P1: Mapping[str, bool] = {
    "p1": True,
    "p1-plain": True,
    "bid-price": False,
    "fcfs": False,
    "edf": False,
    "llf": False,
    "uncoordinated": False,
    "oracle": False,
}
"""The policies there are, and whether their objective is P1's."""


def solves_p1(run: RunRecord) -> bool:
    """Whether a run's policy, as its summary names it, solves P1."""
    return SOLVES_P1.get(str(run.summary.get("policy")), False)


def objective_findings(run: RunRecord, day: tuple[Moment, ...]) -> Iterator[str]:
    """What is wrong with objective, bound and status; every interval must be listed, in order."""
    if not solves_p1(run):
        yield from _unsolved_findings(run)
        return
    for moment, row in zip(day, run.intervals, strict=True):
        k = moment.interval
        if row.objective is None:
            yield f"interval {k}: objective is blank, yet the policy solves P1"
            continue
        low, high = _limits(run, day, k)
        told = [
            *_status_findings(row, row.objective, nothing=_is_idle(moment), asked=moment.admitted),
            *_held_findings(row, row.objective, low, high),
        ]
        yield from (f"interval {k}: {finding}" for finding in told)


def _unsolved_findings(run: RunRecord) -> Iterator[str]:
    for row in run.intervals:
        if row.bound is not None or (row.objective is not None and row.status != "fallback"):
            yield f"interval {row.interval}: objective or bound, yet the policy does not solve P1"
        if row.status == "optimal":
            yield f"interval {row.interval}: optimal, yet the policy does not solve P1"


def _is_idle(moment: Moment) -> bool:
    return not (moment.contracts or moment.newcomers or moment.untold)


def _status_findings(
    row: IntervalRow, objective: float, *, nothing: bool, asked: frozenset[str]
) -> Iterator[str]:
    if nothing and (abs(objective) > MONEY or abs(row.bound or 0.0) > MONEY):
        yield f"nothing to decide, yet objective and bound are {objective:g} and {row.bound} $"
    if row.status == "fallback":
        if row.bound is not None:
            yield "a bound, yet the last plan was kept without one"
        if asked:
            yield f"the last plan was kept, yet {', '.join(sorted(asked))} were admitted"
        return
    if row.bound is None:
        if row.status == "optimal" or nothing:
            yield f"{row.status}, and bound is blank"
        return
    if row.bound > objective + MONEY:
        yield f"bound is {row.bound - objective:.4f} $ above the objective"
    gap = objective - row.bound
    if row.status == "optimal" and gap > CENT + MONEY:
        yield f"optimal, yet {gap:.4f} $ above its bound"
    if row.status == "feasible" and gap <= CENT - MONEY:
        yield f"feasible, yet within {gap:.4f} $ of its bound: optimal"


def _held_findings(row: IntervalRow, objective: float, low: float, high: float) -> Iterator[str]:
    if objective < low - HAIR_USD:
        yield f"objective is {objective:.4f} $, no plan costs less than {low:.4f} $"
    if objective > high + HAIR_USD:
        yield f"objective is {objective:.4f} $, a plan there was costs {high:.4f} $"
    if row.bound is not None and row.bound > high + HAIR_USD:
        yield f"bound is {row.bound:.4f} $, a plan there was costs {high:.4f} $"


def _limits(run: RunRecord, day: tuple[Moment, ...], k: int) -> tuple[float, float]:
    """What the objective of interval k lies between, $, by the other intervals and files.

    The last plan's rest costs its objective, with the revenue of those it admitted, less what its
    first interval cost. It is a plan for k: none P1 takes is dearer. It was optimal to the cent
    for the contracts: newcomers admitted add at least their own least cost, less revenue. Power
    as executed from k on, of those under contract by then, is a plan, too, and optimality is
    to the cent.
    """
    moment, row = day[k], run.intervals[k]
    hours, price = run.scenario.interval_minutes / 60, moment.known.price_per_kwh
    gain = sum(
        least_cost(one, price, k, hours) - one.revenue
        for one in moment.newcomers
        if one.vehicle in moment.admitted
    )
    low, high = -math.inf, math.inf
    if not moment.untold:
        low = gain + sum(least_cost(one, price, k, hours) for one in moment.contracts)
    rest = _rest_of_last_plan(run, day, k)
    if rest is not None:
        high = rest
        if run.intervals[k - 1].status == "optimal":
            low = max(low, rest - CENT + gain)
        if row.status == "fallback":
            low = max(low, rest)
    if moment.is_last_word and not moment.untold and row.status == "optimal":
        high = min(high, _as_executed(run, moment) + CENT)
    return low, high


def _rest_of_last_plan(run: RunRecord, day: tuple[Moment, ...], k: int) -> float | None:
    """What the last plan's rest costs, $; None if unknown, or if something happened since."""
    if k == 0 or any(event.interval == k for event in run.given.events):
        return 0.0 if k == 0 else None
    last, moment = run.intervals[k - 1], day[k - 1]
    if last.objective is None:
        return None
    revenue = sum(one.revenue for one in moment.newcomers if one.vehicle in moment.admitted)
    hours = run.scenario.interval_minutes / 60
    spent = float(run.scenario.price_per_kwh[k - 1] * run.station_kw[k - 1]) * hours
    return last.objective + revenue - spent


def _as_executed(run: RunRecord, moment: Moment) -> float:
    """What those under contract at the end of a moment really cost from then on, $."""
    k, hours = moment.interval, run.scenario.interval_minutes / 60
    admitted = [one for one in moment.newcomers if one.vehicle in moment.admitted]
    cost = sum(
        float(run.power_kw[one.vehicle][k:] @ run.scenario.price_per_kwh[k:]) * hours
        for one in (*moment.contracts, *admitted)
        if one.vehicle in run.power_kw
    )
    return cost - sum(one.revenue for one in admitted)
