"""A day as it unfolds: inputs in force, state, steps taken. Data only; nothing here decides."""

from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Any, Literal, Protocol

from pydantic import BeforeValidator, ValidationInfo

from evdash.domain.arrivals import Arrival
from evdash.domain.breach import Breach
from evdash.domain.events import Event
from evdash.domain.limits import Floats, LimitRows
from evdash.domain.plan import Plan
from evdash.domain.scenario import Scenario
from evdash.domain.vehicles import ENERGY_TOLERANCE_KWH, Contract, Request

PAPERS = "p1"
"""The paper's policy, which decides unless another is named."""
Network = Literal["lindistflow", "ac"]
"""The model of the feeder whose limits are kept."""


class LimitCheck(Protocol):
    """A scenario's feeder, ready to be held against its limits in one network model."""

    @property
    def scenario(self) -> Scenario: ...

    def breaches(self, station_kw: Floats, /) -> list[Breach]:
        """Every limit exceeded with the station drawing `station_kw` (intervals,)."""
        ...


def _with_elements(rows: Any, told: ValidationInfo) -> Any:
    """Earlier versions kept the names of elements; the lines of the scenario tell them apart."""
    if not isinstance(rows, dict) or "scenario" not in told.data:
        return rows
    lines = {str(line.element): line.element for line in told.data["scenario"].lines}
    return rows | {
        "elements": [
            lines.get(one, one) if isinstance(one, str) else one for one in rows["elements"]
        ]
    }


@dataclass(frozen=True, slots=True)
class Inputs:
    """A scenario made ready: who arrives, what they ask, what the feeder allows.

    `requests[k]` take part from interval k; the last group comes after the last interval
    has begun. `rows` are those of `network`. `given` is the scenario as its files tell it, with
    every event so far and to come; `scenario` the one in force, with those so far carried into
    it. Policies never see this: they get a Snapshot.
    """

    given: Scenario
    scenario: Scenario
    arrivals: tuple[Arrival, ...]
    requests: tuple[tuple[Request, ...], ...]
    rows: Annotated[LimitRows, BeforeValidator(_with_elements)]
    network: Network = "lindistflow"


@dataclass(frozen=True, slots=True)
class State:
    """What is carried from one interval to the next.

    `tail_kw` (contracts, intervals from now on), in kW, is a certified plan for every open
    contract: the fallback that cannot fail. `waiting` are contracts that got all that can be
    planned for them, yet not all of their promise: another event may still make room.
    """

    now: int
    contracts: tuple[Contract, ...]
    tail_kw: Floats
    waiting: tuple[Contract, ...] = ()

    @property
    def is_short(self) -> bool:
        """Whether a promise that is not over yet cannot be kept as things stand."""
        return bool(self.waiting) or any(contract.is_short for contract in self.contracts)


@dataclass(frozen=True, slots=True)
class Revision:
    """How a happening changed the terms of one contract."""

    before: Contract
    after: Contract

    @property
    def vehicle(self) -> str:
        return self.before.vehicle

    @property
    def short_kwh(self) -> float:
        """What more of the promise cannot be kept, kWh; negative where something is made good."""
        return _noticeable(self.after.short_kwh - self.before.short_kwh)

    @property
    def promised_kwh(self) -> float:
        """By how much the promise itself changed at its driver's wish, kWh: more, or given up."""
        return _noticeable(self.after.promised_kwh - self.before.promised_kwh)


def _noticeable(energy_kwh: float) -> float:
    """Energy, with what floating point leaves over taken for nothing: it has no cause."""
    return energy_kwh if abs(energy_kwh) > ENERGY_TOLERANCE_KWH else 0.0


@dataclass(frozen=True, slots=True)
class Happening:
    """Events known at the start of `interval`, the contracts they changed, and the state left.

    `note` says what could not be done or found, `proven` whether it is sure that no schedule
    misses less.
    """

    interval: int
    events: tuple[Event, ...]
    revisions: tuple[Revision, ...]
    after: State
    note: str = ""
    proven: bool = True

    @property
    def short_kwh(self) -> float:
        """Energy promised that can no longer be delivered, over all contracts, kWh."""
        return sum(max(0.0, revision.short_kwh) for revision in self.revisions)


@dataclass(frozen=True, slots=True)
class Step:
    """One interval decided: state before, inputs in force, who asked, the plan, state after."""

    before: State
    inputs: Inputs
    requests: tuple[Request, ...]
    plan: Plan
    after: State

    @property
    def interval(self) -> int:
        return self.before.now

    @property
    def start(self) -> datetime:
        """Clock time at which the interval begins."""
        return self.inputs.scenario.time_of(self.interval)

    @property
    def station_kw(self) -> float:
        """Station power executed in this interval, kW."""
        return float(self.plan.power_kw[:, 0].sum())


@dataclass(frozen=True, slots=True)
class Trace:
    """All steps so far, the state reached, the inputs in force from here on, what happened.

    `policy` names who decides all of it.
    """

    inputs: Inputs
    state: State
    steps: tuple[Step, ...] = ()
    happenings: tuple[Happening, ...] = ()
    policy: str = PAPERS

    @property
    def scenario(self) -> Scenario:
        return self.inputs.scenario

    @property
    def now(self) -> int:
        """The interval to be decided next; the number of intervals once the day is over."""
        return self.state.now

    @property
    def is_over(self) -> bool:
        return self.now >= self.scenario.intervals

    def inputs_at(self, interval: int) -> Inputs:
        """The inputs in force in an interval: then, or from now on as things stand."""
        return self.steps[interval].inputs if interval < self.now else self.inputs
