"""What a policy may know, and what it answers."""

import re
from dataclasses import dataclass, field
from typing import Literal, Protocol

import numpy as np

from evdash.domain.limits import Floats, LimitRows
from evdash.domain.refusal import Given, RefusalReason
from evdash.domain.tariff import Tariff
from evdash.domain.vehicles import Contract, Request

Status = Literal["optimal", "feasible", "fallback"]
OUTSIDE = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*(\.[^\W\d]\w*)*")


def is_outside(policy: str) -> bool:
    """Whether a policy's name is that of a function from outside, `module:function`."""
    return OUTSIDE.fullmatch(policy) is not None


@dataclass(frozen=True, slots=True)
class Snapshot:
    """Everything known at the start of interval `now`, and nothing of later arrivals.

    Slots count from now: slot 0 is the interval being decided. `tail_kw` is (contracts, slots);
    `tariff` and `rows` cover the same slots. `asked` counts the requests of every interval
    before this one.
    """

    now: int
    chargers: int
    tariff: Tariff
    rows: LimitRows
    contracts: tuple[Contract, ...]
    requests: tuple[Request, ...]
    tail_kw: Floats
    asked: tuple[int, ...] = ()

    @property
    def n_slots(self) -> int:
        return len(self.tariff)

    @property
    def interval_hours(self) -> float:
        """Length of a slot, h."""
        return self.tariff.interval_hours

    @property
    def price_per_kwh(self) -> Floats:
        """Energy price of each slot, $/kWh, (slots,)."""
        return self.tariff.price_per_kwh

    @property
    def headroom_kw(self) -> Floats:
        """The most the station may draw in each slot, kW, (slots,); inf where nothing limits."""
        return self.rows.headroom_kw()


@dataclass(frozen=True, slots=True)
class Refusal:
    """A request turned down, and why."""

    vehicle: str
    reason: Given


@dataclass(frozen=True, slots=True)
class SolveReport:
    """How a plan came about. `objective` and `bound` in $, as P1 minimises; None if not solved."""

    status: Status
    objective: float | None = None
    bound: float | None = None
    seconds: float = 0.0
    note: str = ""


@dataclass(frozen=True, slots=True)
class Plan:
    """Power of every vehicle under contract over the coming slots, and who is under contract.

    Row n of `power_kw` (vehicles, slots), in kW, belongs to `vehicles[n]`: first the
    snapshot's contracts in their order, then the newly admitted. `capacity_price_per_kwh`
    (slots,), in $/kWh, is what a policy that anticipates charged for each slot's capacity.
    """

    now: int
    vehicles: tuple[str, ...]
    power_kw: Floats
    admitted: tuple[str, ...] = ()
    refused: tuple[Refusal, ...] = ()
    report: SolveReport = field(default_factory=lambda: SolveReport("feasible"))
    capacity_price_per_kwh: Floats | None = None

    def __post_init__(self) -> None:
        self.power_kw.setflags(write=False)

    @property
    def station_kw(self) -> Floats:
        """Station power of each slot, kW: the paper's (8)."""
        return np.asarray(self.power_kw.sum(axis=0))

    @property
    def charging(self) -> Floats:
        """Vehicles charging in each slot, count."""
        return np.asarray((self.power_kw > 0).sum(axis=0))


class Policy(Protocol):
    """A function from what is known now to a plan."""

    def __call__(self, snapshot: Snapshot, /) -> Plan: ...


def tail_plan(snapshot: Snapshot, reason: RefusalReason, report: SolveReport) -> Plan:
    """The previous plan's tail: every contract as already certified, nobody new."""
    return Plan(
        now=snapshot.now,
        vehicles=tuple(contract.vehicle for contract in snapshot.contracts),
        power_kw=snapshot.tail_kw.copy(),
        refused=tuple(Refusal(r.vehicle, r.refusal or reason) for r in snapshot.requests),
        report=report,
    )
