"""P1 as the paper writes it, in PuLP: one function per equation.

Each function adds its equation to a model. A formulation is a tuple of such functions
(`P1`, `RECOURSE`), so that a variant exchanges one for another.
Within a function the paper's letters are used: u, D, P, s, a, c.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import isfinite

import numpy as np
import pulp

from evdash.domain.limits import STATION
from evdash.domain.vehicles import ENERGY_TOLERANCE_KWH
from evdash.scheduling.problem import Problem


@dataclass(slots=True)
class Model:
    """A PuLP problem under construction, and its variables by vehicle n and slot t."""

    data: Problem
    lp: pulp.LpProblem
    u: list[pulp.LpVariable]
    D: list[list[pulp.LpVariable]]
    P: list[list[pulp.LpVariable]]
    station_kw: list[pulp.LpVariable]
    short_kwh: list[pulp.LpVariable] = field(default_factory=list)

    @property
    def vehicles(self) -> range:
        return range(self.data.n_vehicles)

    @property
    def slots(self) -> range:
        return range(self.data.n_slots)


Equation = Callable[[Model], None]


def build(data: Problem, equations: Sequence[Equation], name: str = "P1") -> Model:
    """The model made of `equations`; names are indices, as LP names allow few characters."""
    vehicles, slots = range(data.n_vehicles), range(data.n_slots)
    lp = pulp.LpProblem(name, pulp.LpMinimize)
    whole = pulp.LpBinary
    model = Model(
        data=data,
        lp=lp,
        u=[lp.add_variable(f"u_{n}", cat=whole) for n in vehicles],
        D=[[lp.add_variable(f"D_{n}_{t}", cat=whole) for t in slots] for n in vehicles],
        P=[[lp.add_variable(f"P_{n}_{t}", lowBound=0) for t in slots] for n in vehicles],
        station_kw=[lp.add_variable(f"p_ev_{t}", lowBound=0) for t in slots],
    )
    for equation in equations:
        equation(model)
    return model


def energy_cost(model: Model) -> pulp.LpAffineExpression:
    """Σ c·P·Δt: what a schedule costs by the tariff, $."""
    cost = model.data.tariff.cost_per_kw
    return pulp.lpSum(cost[t] * model.P[n][t] for n in model.vehicles for t in model.slots)


def profit(model: Model) -> None:
    """(P1) objective: energy cost less the revenue of new contracts, Δt in both terms."""
    model.lp += energy_cost(model) - pulp.lpSum(
        model.data.revenue[n] * model.u[n] for n in model.vehicles
    )


def contracts_stay(model: Model) -> None:
    """(5a) u = 1 for vehicles under contract; (5b) leaves the others binary."""
    for n in range(model.data.n_contracts):
        model.lp += model.u[n] == 1, f"contract_{n}"


def only_contracts_charge(model: Model) -> None:
    """(6a) D ≤ u."""
    for n in model.vehicles:
        for t in model.slots:
            model.lp += model.D[n][t] <= model.u[n], f"only_contracts_{n}_{t}"


def charger_power(model: Model) -> None:
    """(6b) low·D ≤ P ≤ high·D: off, or between the charger's limits."""
    for n in model.vehicles:
        low, high = model.data.low_kw[n], model.data.high_kw[n]
        for t in model.slots:
            model.lp += model.P[n][t] >= low * model.D[n][t], f"lowest_power_{n}_{t}"
            model.lp += model.P[n][t] <= high * model.D[n][t], f"highest_power_{n}_{t}"


def time_of_return(model: Model) -> None:
    """(7a) D = 0 from the promised return on, and while a vehicle is away."""
    window = model.data.window
    for n in model.vehicles:
        for t in model.slots:
            if not window[n, t]:
                model.lp += model.D[n][t] == 0, f"returned_{n}_{t}"


def energy_owed(model: Model) -> None:
    """(7b) Σ_t P·Δt = s·u: exactly the energy owed."""
    s, h = model.data.owed_kwh, model.data.interval_hours
    for n in model.vehicles:
        delivered = pulp.lpSum(h * model.P[n][t] for t in model.slots)
        model.lp += delivered == s[n] * model.u[n], f"energy_owed_{n}"


def energy_owed_or_short(model: Model) -> None:
    """(7b) relaxed: Σ_t P·Δt + short = s, for what a broken contract would miss."""
    s, h = model.data.owed_kwh, model.data.interval_hours
    model.short_kwh = [model.lp.add_variable(f"short_{n}", lowBound=0) for n in model.vehicles]
    for n in model.vehicles:
        delivered = pulp.lpSum(h * model.P[n][t] for t in model.slots)
        model.lp += delivered + model.short_kwh[n] == s[n], f"energy_or_short_{n}"


def station_power(model: Model) -> None:
    """(8) p_EV = Σ_n P."""
    for t in model.slots:
        total = pulp.lpSum(model.P[n][t] for n in model.vehicles)
        model.lp += model.station_kw[t] == total, f"station_power_{t}"


def feeder_limits(model: Model) -> None:
    """(1)–(4) and line ratings, reduced to rows over station power."""
    rows = model.data.rows
    for row in range(len(rows.elements)):
        coefficient = rows.coefficient[row, STATION]
        for t in model.slots:
            limit = rows.limit_kw[t, row]
            if not isfinite(limit):
                continue
            model.lp += coefficient * model.station_kw[t] <= limit, f"limit_{row}_{t}"


def charger_count(model: Model) -> None:
    """(9) Σ_n D ≤ N̄: no more vehicles charging at once than chargers."""
    for t in model.slots:
        running = pulp.lpSum(model.D[n][t] for n in model.vehicles)
        model.lp += running <= model.data.chargers, f"chargers_{t}"


def least_missing_energy(model: Model) -> None:
    """Objective of recourse, first: as little energy missing as possible, kWh."""
    model.lp.setObjective(pulp.lpSum(model.short_kwh[n] for n in _firm(model)))


def fewest_vehicles_short(model: Model) -> None:
    """Objective of recourse, second: as few vehicles short as possible, short ≤ s·z."""
    s = model.data.owed_kwh
    z = {n: model.lp.add_variable(f"z_{n}", cat=pulp.LpBinary) for n in _firm(model)}
    for n, one in z.items():
        model.lp += model.short_kwh[n] <= s[n] * one, f"is_short_{n}"
    model.lp.setObjective(pulp.lpSum(z.values()))


def least_given_up(model: Model) -> None:
    """Objective of recourse, third: least given up by who changed its own terms, kWh."""
    firm = set(_firm(model))
    model.lp.setObjective(pulp.lpSum(model.short_kwh[n] for n in model.vehicles if n not in firm))


def least_money(model: Model) -> None:
    """Objective of recourse, last: energy cost, and revenue lost with what is missing, $."""
    paid = model.data.revenue / np.maximum(model.data.owed_kwh, ENERGY_TOLERANCE_KWH)
    lost = pulp.lpSum(paid[n] * model.short_kwh[n] for n in model.vehicles)
    model.lp.setObjective(energy_cost(model) + lost)


def _firm(model: Model) -> list[int]:
    """The contracts; after them stand those who changed their own terms."""
    return [n for n in model.vehicles if n < model.data.n_contracts]


CHARGING: tuple[Equation, ...] = (
    contracts_stay,
    only_contracts_charge,
    charger_power,
    time_of_return,
    station_power,
    charger_count,
)
P1: tuple[Equation, ...] = (profit, *CHARGING, energy_owed, feeder_limits)
RECOURSE: tuple[Equation, ...] = (*CHARGING, energy_owed_or_short, feeder_limits)
RECOURSE_OBJECTIVES: tuple[Equation, ...] = (
    least_missing_energy,
    fewest_vehicles_short,
    least_given_up,
    least_money,
)
