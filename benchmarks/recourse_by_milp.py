"""Recourse worked again by other code: scipy's MILP on arrays, from contracts and rows alone.

Shares nothing with `evdash.scheduling` and `evdash.horizon`. HiGHS is behind scipy, too, but
asked in another form; where answers differ, with presolve and without, the better point counting.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import lil_matrix

from evdash.domain.events import Event
from evdash.domain.limits import Floats
from evdash.domain.trace import Inputs, State
from evdash.domain.vehicles import Contract

HAIR = 1e-6
SECONDS = 60.0
ONE, OTHER, BOTH = (True,), (False,), (True, False)


@dataclass(frozen=True)
class Claim:
    """What a vehicle is to get, kWh, in which slots, at which powers, and whether it is firm."""

    vehicle: str
    owed_kwh: float
    first: int
    last: int
    low_kw: float
    high_kw: float
    firm: bool


@dataclass(frozen=True)
class Least:
    """The least shortfall: kWh, vehicles, kWh given up by own change."""

    short_kwh: float
    vehicles: int
    given_up_kwh: float


def claims_of(inputs: Inputs, state: State, events: Sequence[Event]) -> list[Claim]:
    """Every promise still open before `events`, with the window its driver leaves it."""
    hours = inputs.scenario.interval_minutes / 60
    return [
        claim
        for contract in (*state.contracts, *state.waiting)
        if (claim := _claim(contract, state.now, hours, events)).first < claim.last
    ]


def _claim(contract: Contract, now: int, hours: float, events: Sequence[Event]) -> Claim:
    asked = contract.request
    first, last = max(now, asked.arrival_interval), asked.deadline_interval
    for event in events:
        if event.subject != asked.vehicle:
            continue
        if event.event == "no_show":
            last = now
        if event.event == "leaves_early":
            last = min(last, event.until_interval)
        if event.event == "late":
            first = max(first, event.from_interval)
    changed = (first, last) != (max(now, asked.arrival_interval), asked.deadline_interval)
    owed = asked.need_kwh + contract.short_kwh - contract.delivered_kwh
    return Claim(
        vehicle=asked.vehicle,
        owed_kwh=owed,
        first=first - now,
        last=last - now,
        low_kw=min(asked.min_kw, owed / hours),
        high_kw=asked.max_kw,
        firm=not changed,
    )


class Schedules:
    """All schedules of some claims: P and D of every vehicle and slot, short and z of each."""

    def __init__(
        self, inputs: Inputs, now: int, claims: Sequence[Claim], presolves: Sequence[bool]
    ) -> None:
        self.claims, self.presolves = claims, presolves
        self.hours = inputs.scenario.interval_minutes / 60
        self.slots = inputs.scenario.intervals - now
        self.n = len(claims)
        pairs = self.n * self.slots
        self.P, self.D = np.arange(pairs), pairs + np.arange(pairs)
        self.short, self.z = 2 * pairs + np.arange(self.n), 2 * pairs + self.n + np.arange(self.n)
        self.total = 2 * pairs + 2 * self.n
        self.rows: list[tuple[dict[int, float], float, float]] = []
        self.upper = np.ones(self.total)
        self._vehicles()
        room = np.maximum(0.0, inputs.rows.headroom_kw()[now:])
        for t in range(self.slots):
            mine = [n * self.slots + t for n in range(self.n)]
            chargers = inputs.scenario.station.chargers
            self.rows.append((dict.fromkeys(self.D[mine], 1.0), -np.inf, chargers))
            if np.isfinite(room[t]):
                self.rows.append((dict.fromkeys(self.P[mine], 1.0), -np.inf, room[t]))

    def _vehicles(self) -> None:
        for n, claim in enumerate(self.claims):
            energy = {self.short[n]: 1.0}
            for t in range(self.slots):
                p, d = self.P[n * self.slots + t], self.D[n * self.slots + t]
                energy[p] = self.hours
                self.upper[p] = claim.high_kw
                self.upper[d] = float(claim.first <= t < claim.last)
                self.rows.append(({p: 1.0, d: -claim.high_kw}, -np.inf, 0.0))
                self.rows.append(({p: 1.0, d: -claim.low_kw}, 0.0, np.inf))
            self.rows.append((energy, claim.owed_kwh, claim.owed_kwh))
            self.upper[self.short[n]] = claim.owed_kwh
            limit = {self.short[n]: 1.0, self.z[n]: -claim.owed_kwh}
            self.rows.append((limit, -np.inf, 0.0))

    def least(self, weight: Floats) -> float | None:
        """The least of an objective, (columns,), within all rows so far; None if there is none."""
        matrix = lil_matrix((len(self.rows), self.total))
        for i, (entries, _, _) in enumerate(self.rows):
            for column, value in entries.items():
                matrix[i, column] = value
        limits = LinearConstraint(
            matrix.tocsr(), [row[1] for row in self.rows], [row[2] for row in self.rows]
        )
        whole = np.zeros(self.total)
        whole[self.D] = whole[self.z] = 1
        values = []
        for presolve in self.presolves:
            options = {"presolve": presolve, "time_limit": SECONDS, "mip_rel_gap": 0.0}
            found = milp(
                weight,
                constraints=limits,
                bounds=Bounds(0, self.upper),
                integrality=whole,
                options=options,
            )
            if found.status == 0:
                values.append(float(found.fun))
        return min(values) if values else None

    def hold(self, weight: Floats, value: float, hair: float = HAIR) -> None:
        """Let an objective be no more than `value` from now on."""
        entries = {int(column): float(weight[column]) for column in np.flatnonzero(weight)}
        self.rows.append((entries, -np.inf, value + hair))

    def column_weight(self, columns: Sequence[int], values: object = 1.0) -> Floats:
        """An objective over some columns."""
        weight = np.zeros(self.total)
        weight[list(columns)] = values
        return weight


def least_of(
    inputs: Inputs, now: int, claims: Sequence[Claim], presolves: Sequence[bool] = ONE
) -> Least | None:
    """The least shortfall of firm claims, then the rest in its order; None if not found in time.

    `presolves`: HiGHS is asked with or without presolve, or both, as either errs at times.
    """
    if not claims:
        return Least(0.0, 0, 0.0)
    all_of_them = Schedules(inputs, now, claims, presolves)
    firm = [n for n, claim in enumerate(claims) if claim.firm]
    own = [n for n, claim in enumerate(claims) if not claim.firm]
    found: list[float] = []
    for weight, hair in (
        (all_of_them.column_weight(all_of_them.short[firm]), HAIR),
        (all_of_them.column_weight(all_of_them.z[firm]), 0.5),
        (all_of_them.column_weight(all_of_them.short[own]), HAIR),
    ):
        kept = bool(found) and found[0] <= HAIR and weight[all_of_them.z].any()
        value = all_of_them.least(weight) if weight.any() and not kept else 0.0
        if value is None:
            return None
        found.append(value)
        all_of_them.hold(weight, value, hair)
    return Least(found[0], round(found[1]), found[2])


def most_more(inputs: Inputs, now: int, claims: Sequence[Claim], asker: str, extra: float) -> float:
    """The most of `extra` kWh that `asker` can get if everybody gets all that is owed."""
    larger = [
        Claim(
            **(
                vars(claim)
                | {
                    "owed_kwh": claim.owed_kwh + extra,
                    "low_kw": min(
                        claim.low_kw
                        if claim.low_kw < claim.owed_kwh / _hours(inputs)
                        else _min_kw(inputs),
                        (claim.owed_kwh + extra) / _hours(inputs),
                    ),
                }
            )
        )
        if claim.vehicle == asker
        else claim
        for claim in claims
    ]
    schedules = Schedules(inputs, now, larger, BOTH)
    for n, claim in enumerate(larger):
        schedules.upper[schedules.short[n]] = extra if claim.vehicle == asker else 0.0
    missing = schedules.least(schedules.column_weight(schedules.short))
    return 0.0 if missing is None else extra - missing


def _hours(inputs: Inputs) -> float:
    return inputs.scenario.interval_minutes / 60


def _min_kw(inputs: Inputs) -> float:
    return inputs.scenario.station.min_kw
