"""What happened, read off a trace: a record for each interval and each vehicle."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import datetime
from typing import Literal

import numpy as np

from evdash.domain.plan import Status
from evdash.domain.refusal import RefusalReason
from evdash.domain.tariff import Tariff
from evdash.domain.trace import Step, Trace
from evdash.domain.vehicles import ENERGY_TOLERANCE_KWH, Contract, Request

VehicleStatus = Literal["charged", "refused", "broken", "charging", "released"]
Fate = VehicleStatus | Literal["short"]
"""`short`: under contract, and it is known already that the promise cannot be kept."""
KEPT_WITHIN_KWH = 0.01
"""A contract counts as kept if what it got is within this of what it was promised."""


@dataclass(frozen=True, slots=True)
class IntervalRecord:
    """One interval as decided and executed. `headroom_kw` is None where nothing limits."""

    interval: int
    start: datetime
    price_per_kwh: float
    arrived: int
    admitted: int
    refused: int
    charging: int
    station_kw: float
    headroom_kw: float | None
    binding: str
    objective: float | None
    bound: float | None
    solve_seconds: float
    status: Status


@dataclass(frozen=True, slots=True)
class VehicleRecord:
    """One vehicle's fate so far. `completed_interval` is the one in which it got its last kWh.

    `promised_kwh` is what its contract is for: the need, or what was agreed with its driver
    on the way, `short_kwh` what of it is missing, or known not to come as things stand.
    `released`: its driver gave up a part of it, and the rest was kept.
    """

    request: Request
    status: VehicleStatus
    reason: RefusalReason | None
    delivered_kwh: float
    completed_interval: int | None
    promised_kwh: float
    short_kwh: float = 0.0

    @property
    def fate(self) -> Fate:
        """What has become of it, and is known to become of it."""
        return "short" if self.status == "charging" and self.short_kwh else self.status

    @property
    def vehicle(self) -> str:
        return self.request.vehicle

    @property
    def why_not(self) -> str:
        """Why it was refused, in words; blank if it was not."""
        return "" if self.reason is None else str(self.reason)

    @property
    def revenue(self) -> float:
        """What it pays, $: for all it was promised, or for what it gets where that is less."""
        if self.status == "refused":
            return 0.0
        if self.status in ("broken", "released"):
            return self.request.pays(self.delivered_kwh)
        return self.request.pays(self.promised_kwh - self.short_kwh)


def interval_record(step: Step) -> IntervalRecord:
    """The record of one step."""
    inputs, plan, interval = step.inputs, step.plan, step.interval
    limited = bool(inputs.rows.elements)
    return IntervalRecord(
        interval=interval,
        start=step.start,
        price_per_kwh=float(inputs.scenario.price_per_kwh[interval]),
        arrived=len(step.requests),
        admitted=len(plan.admitted),
        refused=len(plan.refused),
        charging=int(plan.charging[0]),
        station_kw=step.station_kw,
        headroom_kw=float(inputs.rows.headroom_kw()[interval]) if limited else None,
        binding=inputs.scenario.file_name(inputs.rows.binding()[interval]),
        objective=plan.report.objective,
        bound=plan.report.bound,
        solve_seconds=plan.report.seconds,
        status=plan.report.status,
    )


def interval_records(trace: Trace) -> tuple[IntervalRecord, ...]:
    """A record for every step taken."""
    return tuple(interval_record(step) for step in trace.steps)


def executed_power(trace: Trace) -> Iterator[tuple[int, str, float]]:
    """(interval, vehicle, power_kw) wherever power flowed."""
    for step in trace.steps:
        for vehicle, power_kw in zip(step.plan.vehicles, step.plan.power_kw[:, 0], strict=True):
            if power_kw > 0:
                yield step.interval, vehicle, float(power_kw)


def executed_station_kw(trace: Trace) -> np.ndarray:
    """Station power of the intervals executed so far, kW, shape (steps,)."""
    return np.array([step.station_kw for step in trace.steps])


def executed_tariff(trace: Trace) -> Tariff:
    """The tariff in force in each of the intervals executed so far, (steps,)."""
    slots = [step.inputs.scenario.tariff[step.interval :][:1] for step in trace.steps]
    return trace.scenario.tariff[:0].followed_by(slots)


def vehicle_records(trace: Trace) -> tuple[VehicleRecord, ...]:
    """A record for everyone who has asked so far, in order of arrival.

    Once the day is over that includes those who came after its last interval had begun.
    """
    hours = trace.scenario.interval_hours
    delivered: dict[str, float] = {}
    last: dict[str, int] = {}
    for interval, vehicle, power_kw in executed_power(trace):
        delivered[vehicle] = delivered.get(vehicle, 0.0) + power_kw * hours
        last[vehicle] = interval
    revised = contracts_revised(trace)
    records = []
    for step in trace.steps:
        reasons = {refusal.vehicle: refusal.reason for refusal in step.plan.refused}
        for request in step.requests:
            got = delivered.get(request.vehicle, 0.0)
            contract = revised.get(request.vehicle, Contract(request))
            status: VehicleStatus = "refused"
            if request.vehicle not in reasons:
                status = _status(request, contract, got, trace.now)
            reason = reasons.get(request.vehicle)
            completed = last.get(request.vehicle) if status == "charged" else None
            promised, short = contract.promised_kwh, _short_kwh(contract, status, got)
            records.append(VehicleRecord(request, status, reason, got, completed, promised, short))
    if trace.is_over:
        for request in trace.inputs.requests[trace.scenario.intervals]:
            refusal, need = request.refusal, request.need_kwh
            records.append(VehicleRecord(request, "refused", refusal, 0.0, None, need))
    return tuple(records)


def refused_by_reason(vehicles: Iterable[VehicleRecord]) -> dict[str, list[VehicleRecord]]:
    """Who was refused, by the clause of each kind of reason, most vehicles first."""
    groups: dict[str, list[VehicleRecord]] = {}
    for record in vehicles:
        if record.reason is not None:
            groups.setdefault(record.reason.clause, []).append(record)
    return dict(sorted(groups.items(), key=lambda item: -len(item[1])))


def contracts_revised(trace: Trace) -> dict[str, Contract]:
    """Contracts that something happened to, as the last happening left them, by vehicle."""
    return {
        revision.vehicle: revision.after
        for happening in trace.happenings
        for revision in happening.revisions
    }


def _short_kwh(contract: Contract, status: VehicleStatus, delivered_kwh: float) -> float:
    """What is missing of a broken contract, or will be of one under way; too little is nothing."""
    missing = {"broken": contract.promised_kwh - delivered_kwh, "charging": contract.short_kwh}
    short = missing.get(status, 0.0)
    return short if short > KEPT_WITHIN_KWH else 0.0


def _status(request: Request, contract: Contract, delivered_kwh: float, now: int) -> VehicleStatus:
    """`contract` holds the terms last agreed; what of them was given up, it was asked for."""
    missing = contract.promised_kwh - delivered_kwh
    given_up = request.need_kwh - delivered_kwh > KEPT_WITHIN_KWH
    if missing <= ENERGY_TOLERANCE_KWH:
        return "released" if given_up else "charged"
    if contract.request.deadline_interval > now:
        return "charging"
    if missing > KEPT_WITHIN_KWH:
        return "broken"
    return "released" if given_up else "charged"
