"""What must be true of any day run by a policy that keeps promises, read off its trace."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from evdash.checker.feeder import FeederCheck
from evdash.checker.plans import plan_problems
from evdash.domain.plan import Plan
from evdash.domain.trace import Step, Trace
from evdash.domain.vehicles import Request

KEPT_WITHIN_KWH = 0.01
HAIR = 1e-6
"""Floating point's due, in kW, kWh and $."""


def problems_of_day(trace: Trace, *, same_inputs: bool = True) -> list[str]:
    """Every promise or limit broken anywhere in the day, in words; nothing if all is well.

    `same_inputs`: no edit in mid-day, so that profit may not fall from plan to plan.
    """
    problems = [problem for step in trace.steps for problem in problems_of_step(step)]
    problems += contract_problems(trace)
    if same_inputs:
        profits = [profit for _, profit in realised_and_planned(trace)]
        problems += [
            f"interval {k}: profit falls from {before:.6f} to {after:.6f} $"
            for k, (before, after) in enumerate(pairwise(profits), 1)
            if after < before - HAIR
        ]
    return problems


def problems_of_step(step: Step) -> Iterator[str]:
    """What the executed interval and the tail it leaves break under the inputs in force."""
    inputs, at = step.inputs, f"interval {step.interval}"
    if step.plan.report.status == "fallback":
        yield f"{at}: fallback ({step.plan.report.note})"
    running = int((step.plan.power_kw[:, 0] > 0).sum())
    if running > inputs.scenario.station.chargers:
        yield f"{at}: {running} vehicles on {inputs.scenario.station.chargers} chargers"
    headroom_kw = inputs.rows.headroom_kw()[step.interval]
    if step.station_kw > headroom_kw + HAIR:
        yield f"{at}: station at {step.station_kw} kW, headroom {headroom_kw} kW"
    if step.after.now < inputs.scenario.intervals:
        names = tuple(contract.vehicle for contract in step.after.contracts)
        tail = Plan(now=step.after.now, vehicles=names, power_kw=step.after.tail_kw.copy())
        for problem in plan_problems(FeederCheck(inputs.scenario), step.after.contracts, tail):
            yield f"{at}: its tail is not feasible: {problem}"
    elif step.after.contracts:
        yield f"{at}: contracts are left over at the end"


def contracts_made(trace: Trace) -> dict[str, Request]:
    """Everyone admitted, with the request as it was accepted."""
    return {
        request.vehicle: request
        for step in trace.steps
        for request in step.requests
        if request.vehicle in step.plan.admitted
    }


def executed_power(trace: Trace) -> dict[str, np.ndarray]:
    """Power each contracted vehicle got, kW, (steps,)."""
    power = {vehicle: np.zeros(len(trace.steps)) for vehicle in contracts_made(trace)}
    for k, step in enumerate(trace.steps):
        for vehicle, row in zip(step.plan.vehicles, step.plan.power_kw, strict=True):
            power[vehicle][k] = row[0]
    return power


def contract_problems(trace: Trace) -> Iterator[str]:
    """Contracts not kept to 0.01 kWh, or not within their time."""
    executed = executed_power(trace)
    first = trace.steps[0].interval if trace.steps else 0
    for vehicle, request in contracts_made(trace).items():
        row, hours = executed[vehicle], trace.scenario.interval_hours
        missing = request.need_kwh - float(row.sum()) * hours
        due = request.deadline_interval <= trace.now
        if abs(missing) > KEPT_WITHIN_KWH and (due or missing < 0):
            yield f"{vehicle}: promised {request.need_kwh} kWh, off by {missing} kWh"
        when = first + np.flatnonzero(row > 0)
        if len(when) and not request.arrival_interval <= when[0] <= when[-1] < (
            request.deadline_interval
        ):
            yield f"{vehicle}: charged in {when.tolist()}, outside its time"


def realised_and_planned(trace: Trace) -> Iterator[tuple[int, float]]:
    """After each plan: revenue of all contracts so far less energy spent and planned, $."""
    revenue = spent = 0.0
    for step in trace.steps:
        scenario = step.inputs.scenario
        price = scenario.price_per_kwh[step.interval :] * scenario.interval_hours
        revenue += sum(r.revenue for r in step.requests if r.vehicle in step.plan.admitted)
        cost = price * step.plan.power_kw.sum(axis=0)
        yield step.interval, revenue - spent - float(cost.sum())
        spent += float(cost[0])


def without_times(trace: Trace) -> tuple[object, ...]:
    """All that was decided, comparable with ==; solving times left out."""
    return tuple(
        (
            step.interval,
            step.plan.vehicles,
            step.plan.power_kw.tobytes(),
            step.plan.admitted,
            step.plan.refused,
            replace(step.plan.report, seconds=0.0),
            step.after.contracts,
            step.after.tail_kw.tobytes(),
        )
        for step in trace.steps
    )
