"""A race: several policies on the same scenario, arrivals and events, and what each came to."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from datetime import datetime, timedelta

import numpy as np

from evdash.domain.breach import Breach
from evdash.domain.limits import Floats
from evdash.domain.refusal import Given
from evdash.domain.trace import Inputs, Network, Trace
from evdash.errors import InputError
from evdash.grid.acflow import AcNetwork, AcResult
from evdash.horizon.day import begin, run_day
from evdash.metrics.ac_day import AcDay, ac_base, ac_day
from evdash.metrics.breaches import charger_breaches, linear_breaches
from evdash.metrics.records import executed_station_kw
from evdash.metrics.service import Service, service
from evdash.metrics.verdict import FULL_AC, LINEARISED, ModelVerdict, verdict_of
from evdash.policies.oracle import Oracle
from evdash.policies.registry import RULES, Rule, described, known

ORACLE, PAPERS = "oracle", "p1"
SLOW = ("p1-plain",)
"""Policies that decide as another does, only slower; they race only where asked for by name."""
CONTESTANTS = (ORACLE, *(name for name in RULES if name != ORACLE and name not in SLOW))
"""Who races unless told otherwise; the oracle first, as the others are measured by it."""


@dataclass(frozen=True, slots=True)
class TurnedDown:
    """Someone a policy refused in an interval, and why."""

    interval: int
    vehicle: str
    option: str
    need_kwh: float
    reason: Given


@dataclass(frozen=True, slots=True)
class Lap:
    """One policy's day: its figures, and what it did interval by interval.

    `station_kw`, `admitted` and `refused` have an entry for each interval, as has
    `lowest_ac_pu`, in pu, None where AC power flow has no solution. `limits_broken` counts what
    the station broke in the network model whose limits are kept, and of its chargers; `verdicts`
    are what the linearised model and AC power flow say.
    `capacity_price_per_kwh`, in $/kWh, is what an hour's capacity was held to be worth to others
    when it came; None where the policy prices none.
    """

    policy: str
    service: Service
    station_kw: tuple[float, ...]
    admitted: tuple[int, ...]
    refused: tuple[int, ...]
    lowest_ac_pu: tuple[float | None, ...]
    limits_broken: int
    verdicts: tuple[ModelVerdict, ModelVerdict]
    capacity_price_per_kwh: tuple[float | None, ...]
    turned_down: tuple[TurnedDown, ...]

    @property
    def title(self) -> str:
        """The policy's name in words."""
        return described(self.policy).title

    def verdict(self, network: Network) -> ModelVerdict:
        """What a network model says of the day."""
        return next(found for found in self.verdicts if found.network == network)

    @property
    def keeps_limits(self) -> bool:
        """Whether the policy is to keep limits and promises at all."""
        return described(self.policy).keeps_limits

    @property
    def is_sound(self) -> bool:
        """Whether it kept what it is to keep."""
        return not self.keeps_limits or (self.limits_broken == 0 and self.service.broken == 0)


@dataclass(frozen=True, slots=True)
class Race:
    """All that took part in, and those who could not, with the reason.

    `most_profit` in $ is what the oracle proved no policy within the limits can exceed; None
    without an oracle, or where events change the day it foresees. `headroom_kw` has an entry
    for each interval, None where nothing limits.
    """

    scenario: str
    network: Network
    seed: int | None
    start: datetime
    interval_minutes: int
    voltage_min_pu: float
    headroom_kw: tuple[float | None, ...]
    most_profit: float | None
    laps: tuple[Lap, ...]
    absent: dict[str, str]

    def lap(self, policy: str) -> Lap | None:
        """What a policy came to, if it took part."""
        return next((lap for lap in self.laps if lap.policy == policy), None)

    @property
    def times(self) -> tuple[datetime, ...]:
        """When each interval begins, and when the last ends."""
        count = len(self.headroom_kw) + 1
        return tuple(
            self.start + timedelta(minutes=self.interval_minutes * n) for n in range(count)
        )

    @property
    def value_of_foresight(self) -> float | None:
        """What knowing who will come is worth over the paper's rule, $."""
        papers = self.lap(PAPERS)
        if papers is None or self.most_profit is None:
            return None
        return self.most_profit - papers.service.profit


@dataclass(frozen=True, slots=True)
class Told:
    """How far a race is: which policy is on its day, and how many steps of all are done."""

    policy: str
    done: int
    total: int


def race(
    inputs: Inputs,
    policies: Iterable[str],
    told: Callable[[Told], None] | None = None,
    find: Callable[[str], Rule] = known,
) -> Race:
    """Every policy on the day of these inputs from its beginning.

    `told` is called after every step, so that a caller can tell how far it is, or stop. `find`
    gives a policy by its name; those it cannot make are absent.
    """
    start, track = begin(inputs), _Track(inputs, told)
    names = sorted(dict.fromkeys(policies), key=lambda name: name != ORACLE)
    laps, absent, most = [], {}, None
    for place, name in enumerate(names):
        track.at(name, place, len(names))
        try:
            rule = find(name)
            policy = rule.make(inputs)
        except InputError as error:
            absent[name] = "; ".join(str(fault) for fault in error.faults)
            continue
        if isinstance(policy, Oracle) and not inputs.given.events:
            most = policy.foresight.most_profit
        trace = run_day(replace(start, policy=name), policy, track.stepped, rule.decide)
        laps.append(_lap(name, trace, track.judged(trace), most))
    scenario = inputs.scenario
    return Race(
        scenario=scenario.name,
        network=inputs.network,
        seed=scenario.arrivals.seed,
        start=scenario.start,
        interval_minutes=scenario.interval_minutes,
        voltage_min_pu=scenario.feeder.voltage_min_pu,
        headroom_kw=_finite(inputs.rows.headroom_kw()),
        most_profit=most,
        laps=tuple(laps),
        absent=absent,
    )


class _Track:
    """What all laps of a race share: how far it is, and the feeder in AC without the station."""

    def __init__(self, inputs: Inputs, told: Callable[[Told], None] | None) -> None:
        self._told = told
        self._intervals = inputs.scenario.intervals
        self._network = AcNetwork(inputs.scenario)
        self._base: AcResult | None = None
        self._name, self._place, self._count = "", 0, 1

    def at(self, name: str, place: int, count: int) -> None:
        """One more policy begins its day."""
        self._name, self._place, self._count = name, place, count
        self._tell(0)

    def stepped(self, trace: Trace) -> None:
        """One more interval of it is decided."""
        self._tell(trace.now)

    def _tell(self, step: int) -> None:
        if self._told is not None:
            done = self._place * self._intervals + step
            self._told(Told(self._name, done, self._count * self._intervals))

    def judged(self, trace: Trace) -> AcDay:
        """The finished day in AC."""
        if trace.inputs.given.events or self._base is None:  # loads may differ from day to day
            self._base = ac_base(trace, self._network)
        return ac_day(trace, self._network, self._base)


def _lap(name: str, trace: Trace, ac: AcDay, most_profit: float | None) -> Lap:
    models: dict[Network, tuple[Breach, ...]] = {
        LINEARISED: linear_breaches(trace),
        FULL_AC: ac.breaches,
    }
    return Lap(
        policy=name,
        service=service(trace, ac, most_profit),
        station_kw=tuple(executed_station_kw(trace).tolist()),
        admitted=tuple(len(step.plan.admitted) for step in trace.steps),
        refused=tuple(len(step.plan.refused) for step in trace.steps),
        lowest_ac_pu=_finite(ac.flow.voltage_pu.min(axis=1)),
        limits_broken=_limits_broken(trace, models[trace.inputs.network]),
        verdicts=(
            verdict_of(LINEARISED, models[LINEARISED], trace.now),
            verdict_of(FULL_AC, models[FULL_AC], trace.now),
        ),
        capacity_price_per_kwh=tuple(
            None if price is None else float(price[0])
            for price in (step.plan.capacity_price_per_kwh for step in trace.steps)
        ),
        turned_down=_turned_down(trace),
    )


def _turned_down(trace: Trace) -> tuple[TurnedDown, ...]:
    return tuple(
        TurnedDown(step.interval, asked.vehicle, asked.option, asked.need_kwh, refusal.reason)
        for step in trace.steps
        for refusal in step.plan.refused
        for asked in step.requests
        if asked.vehicle == refusal.vehicle
    )


def _limits_broken(trace: Trace, breaches: Iterable[Breach]) -> int:
    return sum(breach.by_station for breach in breaches) + len(charger_breaches(trace))


def _finite(values: Floats) -> tuple[float | None, ...]:
    return tuple(float(value) if np.isfinite(value) else None for value in values)
