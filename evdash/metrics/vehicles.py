"""One vehicle's day, read off a trace: power, state of charge, cost, and its plan as revised."""

from dataclasses import dataclass

import numpy as np

from evdash.domain.limits import Floats
from evdash.domain.trace import Trace
from evdash.domain.vehicles import Request
from evdash.metrics.records import VehicleRecord, vehicle_records


@dataclass(frozen=True, slots=True)
class VehicleDay:
    """Executed before `now`, planned from then on.

    Shapes: power_kw, grid side, (intervals,); soc and least_soc, shares of the battery at the
    beginning of each interval and at the end of the last, (intervals + 1,). Below `least_soc`
    the promise could not be kept any more, even at full power. `energy_cost` in $, of what
    was drawn so far.
    """

    record: VehicleRecord
    now: int
    power_kw: Floats
    soc: Floats
    least_soc: Floats
    energy_cost: float

    @property
    def request(self) -> Request:
        return self.record.request

    @property
    def is_admitted(self) -> bool:
        return self.record.status != "refused"

    @property
    def share_delivered(self) -> float:
        """How much of the energy promised it has, 0 to 1."""
        return self.record.delivered_kwh / self.request.need_kwh


@dataclass(frozen=True, slots=True)
class PlanHistory:
    """A vehicle's plan as decided at each of `decided`; power_kw (decisions, intervals).

    NaN before the interval in which a plan was made.
    """

    vehicle: str
    decided: tuple[int, ...]
    power_kw: Floats


def vehicle_day(trace: Trace, vehicle: str) -> VehicleDay:
    """The day of someone who has asked; raises KeyError for anyone else."""
    record = {record.vehicle: record for record in vehicle_records(trace)}[vehicle]
    hours = trace.scenario.interval_hours
    power_kw = np.zeros(trace.scenario.intervals)
    cost = 0.0
    for step in trace.steps:
        if vehicle in step.plan.vehicles:
            kw = float(step.plan.power_kw[step.plan.vehicles.index(vehicle), 0])
            power_kw[step.interval] = kw
            cost += kw * hours * float(step.inputs.scenario.price_per_kwh[step.interval])
    for contract, tail_kw in zip(trace.state.contracts, trace.state.tail_kw, strict=True):
        if contract.vehicle == vehicle:
            power_kw[trace.now :] = tail_kw
    request = record.request
    charged_kwh = np.concatenate([[0.0], np.cumsum(power_kw) * hours])
    return VehicleDay(
        record=record,
        now=trace.now,
        power_kw=power_kw,
        soc=request.soc_in + charged_kwh * soc_per_kwh(request),
        least_soc=least_soc(request, trace.scenario.intervals, hours),
        energy_cost=cost,
    )


def soc_per_kwh(request: Request) -> float:
    """State of charge gained from each kWh of the grid: η/battery, as when it asked."""
    return (request.soc_out - request.soc_in) / request.need_kwh


def least_soc(request: Request, intervals: int, hours: float) -> Floats:
    """SOC from which full power up to the promised time still just keeps the promise.

    Shape (intervals + 1,); never below the SOC on arrival, soc_out from the promised time on.
    """
    left_h = np.maximum(0, request.deadline_interval - np.arange(intervals + 1)) * hours
    late = request.soc_out - left_h * request.max_kw * soc_per_kwh(request)
    return np.asarray(np.maximum(request.soc_in, late))


def plan_history(trace: Trace, vehicle: str) -> PlanHistory:
    """Its plan at every interval in which it was under contract; empty if it never was."""
    decided, plans = [], []
    for step in trace.steps:
        if vehicle in step.plan.vehicles:
            power_kw = np.full(trace.scenario.intervals, np.nan)
            power_kw[step.interval :] = step.plan.power_kw[step.plan.vehicles.index(vehicle)]
            decided.append(step.interval)
            plans.append(power_kw)
    shape = (len(plans), trace.scenario.intervals)
    return PlanHistory(vehicle, tuple(decided), np.reshape(plans, shape))


def charging_kw(trace: Trace) -> dict[str, float]:
    """Who charges in the interval executed last, and with how many kW."""
    if not trace.steps:
        return {}
    plan = trace.steps[-1].plan
    return {
        vehicle: float(kw)
        for vehicle, kw in zip(plan.vehicles, plan.power_kw[:, 0], strict=True)
        if kw > 0
    }
