"""One vehicle's day, read off a trace: power, state of charge, cost, and its plan as revised."""

from dataclasses import dataclass, replace

import numpy as np

from evdash.domain.limits import Floats
from evdash.domain.trace import Trace
from evdash.domain.vehicles import Request
from evdash.metrics.ledger import LedgerEntry, ledger
from evdash.metrics.records import VehicleRecord, executed_tariff, vehicle_records


@dataclass(frozen=True, slots=True)
class VehicleDay:
    """Executed before `now`, planned from then on.

    `terms` is what the station last agreed with its driver; None if it was refused.

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
    terms: LedgerEntry | None

    @property
    def request(self) -> Request:
        return self.record.request

    @property
    def is_admitted(self) -> bool:
        return self.record.status != "refused"

    @property
    def due_interval(self) -> int:
        """The first interval too late for it: as last agreed, or as asked for in vain."""
        return self.terms.revised_by_interval if self.terms else self.request.deadline_interval

    @property
    def due_soc(self) -> float:
        """State of charge it is to leave with: as last agreed, or as asked for in vain."""
        if self.terms is None or self.terms.revised_kwh == self.request.need_kwh:
            return self.request.soc_out
        return self.request.soc_in + self.terms.revised_kwh * soc_per_kwh(self.request)

    @property
    def share_delivered(self) -> float:
        """How much of the energy promised it has, 0 to 1."""
        promised = self.record.promised_kwh
        return self.record.delivered_kwh / promised if promised > 0 else 1.0


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
    for step in trace.steps:
        if vehicle in step.plan.vehicles:
            row = step.plan.vehicles.index(vehicle)
            power_kw[step.interval] = step.plan.power_kw[row, 0]
    for contract, tail_kw in zip(trace.state.contracts, trace.state.tail_kw, strict=True):
        if contract.vehicle == vehicle:
            power_kw[trace.now :] = tail_kw
    request = record.request
    terms = {entry.vehicle: entry for entry in ledger(trace)}.get(vehicle)
    charged_kwh = np.concatenate([[0.0], np.cumsum(power_kw) * hours])
    day = VehicleDay(
        record=record,
        now=trace.now,
        power_kw=power_kw,
        soc=request.soc_in + charged_kwh * soc_per_kwh(request),
        least_soc=np.full(trace.scenario.intervals + 1, request.soc_in),
        energy_cost=executed_tariff(trace).cost(power_kw[: trace.now]),
        terms=terms,
    )
    return replace(day, least_soc=least_soc(day, hours))


def soc_per_kwh(request: Request) -> float:
    """State of charge gained from each kWh of the grid: η/battery, as when it asked."""
    return (request.soc_out - request.soc_in) / request.need_kwh


def least_soc(day: VehicleDay, hours: float) -> Floats:
    """SOC from which full power up to the promised time still just keeps the promise.

    Shape (intervals + 1,); never below the SOC on arrival, what is due from the due time on.
    """
    request = day.request
    left_h = np.maximum(0, day.due_interval - np.arange(len(day.soc))) * hours
    late = day.due_soc - left_h * request.max_kw * soc_per_kwh(request)
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
