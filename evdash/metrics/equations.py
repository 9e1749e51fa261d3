"""The paper's equations with the numbers of one step in them: one interval, node and vehicle."""

import math
from dataclasses import dataclass

import numpy as np

from evdash.domain.elements import Element
from evdash.domain.limits import Floats
from evdash.domain.trace import Step
from evdash.domain.vehicles import Request
from evdash.grid.lindistflow import (
    Injections,
    base_injections,
    line_flows,
    sensitivity,
    voltage_sq_pu,
    with_station,
)
from evdash.grid.radial import KW_PER_MW, RadialFeeder, radial_feeder
from evdash.grid.reduction import active_limit_kw


@dataclass(frozen=True, slots=True)
class NodeNumbers:
    """(1), (3), (4c) at one node in one interval: kW, kvar, and squared voltages in pu.

    `active_part` and `reactive_part` are the node's entries of R p and X q.
    """

    node: str
    hosts_station: bool
    generation_kw: float
    load_kw: float
    station_kw: float
    reactive_kvar: float
    source_sq: float
    active_part: float
    reactive_part: float
    voltage_pu: float
    lowest_pu: float
    highest_pu: float

    @property
    def injection_kw(self) -> float:
        """(1a) p = p_g − p_l − p_EV."""
        return self.generation_kw - self.load_kw - self.station_kw

    @property
    def voltage_sq(self) -> float:
        """(3) v = v_0 + (R p) + (X q)."""
        return self.source_sq + self.active_part + self.reactive_part


@dataclass(frozen=True, slots=True)
class RatingNumbers:
    """(2) at the rated element nearest to the station: kW and kvar through it, and its limit."""

    element: Element
    rating_kva: float
    active_kw: float
    reactive_kvar: float

    @property
    def limit_kw(self) -> float:
        """√(s̄² − q²)."""
        return float(active_limit_kw(self.rating_kva, np.array(self.reactive_kvar)))


@dataclass(frozen=True, slots=True)
class VehicleNumbers:
    """(5)–(7), (10) for one vehicle: what it is owed, by when, and its planned power by interval.

    `intervals_left` counts the present one; `low_kw` is the lower end of (6b).
    """

    request: Request
    is_newcomer: bool
    admitted: bool
    owed_kwh: float
    intervals_left: int
    low_kw: float
    power_kw: tuple[float, ...]
    interval_hours: float

    @property
    def planned_kwh(self) -> float:
        """(7b) Σ P·Δt over the plan."""
        return sum(self.power_kw) * self.interval_hours

    @property
    def delivered_now_kwh(self) -> float:
        """What the interval just decided gives it."""
        return self.power_kw[0] * self.interval_hours if self.power_kw else 0.0


@dataclass(frozen=True, slots=True)
class StationNumbers:
    """(8), (9) and (P1) of a step: powers by vehicle in kW, chargers, and what the plan is worth.

    `headroom_kw` is inf where nothing limits; money in $, planned over the rest of the day.
    """

    power_kw: dict[str, float]
    chargers: int
    headroom_kw: float
    binding: Element | None
    energy_cost: float
    new_revenue: float
    bound: float | None

    @property
    def total_kw(self) -> float:
        """(8) p_EV = Σ P."""
        return sum(self.power_kw.values())


def vehicles_of(step: Step) -> list[Request]:
    """Everyone P1 decided on in a step: the contracts first, then the newcomers."""
    return [*(contract.request for contract in step.before.contracts), *step.requests]


def vehicle_numbers(step: Step, vehicle: str) -> VehicleNumbers:
    """One vehicle's part in a step."""
    owed = {contract.vehicle: contract.owed_kwh for contract in step.before.contracts}
    request = next(r for r in vehicles_of(step) if r.vehicle == vehicle)
    plan, hours = step.plan, step.inputs.scenario.interval_hours
    is_newcomer = vehicle not in owed
    admitted = vehicle in plan.vehicles
    owed_kwh = owed.get(vehicle, request.need_kwh)
    row = plan.power_kw[plan.vehicles.index(vehicle)] if admitted else np.zeros(0)
    return VehicleNumbers(
        request=request,
        is_newcomer=is_newcomer,
        admitted=admitted,
        owed_kwh=owed_kwh,
        intervals_left=request.deadline_interval - step.interval,
        low_kw=min(request.min_kw, owed_kwh / hours),
        power_kw=tuple(float(power) for power in row),
        interval_hours=hours,
    )


def station_numbers(step: Step) -> StationNumbers:
    """The station as a whole in a step."""
    plan, inputs = step.plan, step.inputs
    revenue = {request.vehicle: request.revenue for request in step.requests}
    running = zip(plan.vehicles, plan.power_kw[:, 0], strict=True)
    return StationNumbers(
        power_kw={vehicle: float(power) for vehicle, power in running if power > 0},
        chargers=inputs.scenario.station.chargers,
        headroom_kw=float(inputs.rows.headroom_kw()[step.interval]),
        binding=inputs.rows.binding()[step.interval],
        energy_cost=inputs.scenario.tariff[step.interval :].cost(plan.power_kw),
        new_revenue=sum(revenue[vehicle] for vehicle in plan.admitted),
        bound=plan.report.bound,
    )


def node_numbers(step: Step, node: str) -> NodeNumbers:
    """One node of the feeder in a step's interval, with the station drawing what it drew."""
    scenario = step.inputs.scenario
    feeder, base, injections = _executed(step)
    i, t = feeder.node_index(node), step.interval
    base_kva = scenario.feeder.base_mva * KW_PER_MW
    hosts = node == scenario.station.node
    generation = next(n.generation_kw or 0.0 for n in scenario.nodes if n.node == node)
    generation_kw = generation * float(scenario.generation_pu[t])
    by_active = sensitivity(feeder, feeder.r_pu, i) @ injections.active_kw[t]
    by_reactive = sensitivity(feeder, feeder.x_pu, i) @ injections.reactive_kvar[t]
    voltage_sq = float(voltage_sq_pu(scenario, feeder, injections)[t, i])
    return NodeNumbers(
        node=node,
        hosts_station=hosts,
        generation_kw=generation_kw,
        load_kw=generation_kw - float(base.active_kw[t, i]),
        station_kw=step.station_kw if hosts else 0.0,
        reactive_kvar=float(injections.reactive_kvar[t, i]),
        source_sq=scenario.feeder.source_voltage_pu**2,
        active_part=float(by_active) / base_kva,
        reactive_part=float(by_reactive) / base_kva,
        voltage_pu=math.sqrt(max(0.0, voltage_sq)),
        lowest_pu=scenario.feeder.voltage_min_pu,
        highest_pu=scenario.feeder.voltage_max_pu,
    )


def lowest_node(step: Step) -> str:
    """The node whose voltage is lowest in a step's interval."""
    feeder, _, injections = _executed(step)
    voltage = voltage_sq_pu(step.inputs.scenario, feeder, injections)[step.interval]
    return feeder.nodes[int(voltage.argmin())]


def rating_numbers(step: Step) -> RatingNumbers | None:
    """The station node's own rating, else the rated line nearest to it; None if there is none."""
    scenario = step.inputs.scenario
    feeder, _, injections = _executed(step)
    i, t = feeder.node_index(scenario.station.node), step.interval
    own = next(n.rating_kva for n in scenario.nodes if n.node == scenario.station.node)
    if own is not None:
        active, reactive = -injections.active_kw[t, i], -injections.reactive_kvar[t, i]
        return RatingNumbers(
            Element("node", scenario.station.node), own, float(active), float(reactive)
        )
    line = feeder.nearest_rated_line(scenario.station.node)
    if line is None:
        return None
    flows = line_flows(feeder, injections)
    return RatingNumbers(
        feeder.lines[line],
        float(feeder.line_rating_kva[line]),
        float(flows.active_kw[t, line]),
        float(flows.reactive_kvar[t, line]),
    )


def _executed(step: Step) -> tuple[RadialFeeder, Injections, Injections]:
    """The feeder, its injections without the station, and with it in the step's interval."""
    scenario = step.inputs.scenario
    feeder = radial_feeder(scenario)
    base = base_injections(scenario, feeder)
    station_kw: Floats = np.zeros(scenario.intervals)
    station_kw[step.interval] = step.station_kw
    return feeder, base, with_station(scenario, feeder, base, station_kw)
