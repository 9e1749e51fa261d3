"""A day in figures: its totals, and how well it served drivers, station, feeder and computer.

Each figure of service is declared once; names are those of ACN-Sim and EV2Gym where they have
one. Money is of the executed schedule, and of everyone who has asked so far.
"""

import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from evdash.domain.trace import Trace
from evdash.metrics.ac_day import AcDay, AcTroubles, troubles
from evdash.metrics.declared import figure
from evdash.metrics.records import (
    VehicleRecord,
    executed_power,
    executed_station_kw,
    executed_tariff,
    refused_by_reason,
    vehicle_records,
)


@dataclass(frozen=True, slots=True)
class Totals:
    """Totals of the executed schedule; money in $, of everyone who has asked so far.

    `released`: contracts of which the driver gave up a part, and the rest was kept.
    `peak_station_kw` is the highest mean of an interval.
    """

    arrived: int
    admitted: int
    refused: int
    charged: int
    broken: int
    released: int
    energy_requested_kwh: float
    energy_delivered_kwh: float
    revenue: float
    energy_cost: float
    peak_station_kw: float

    @property
    def profit(self) -> float:
        return self.revenue - self.energy_cost


def totals(trace: Trace) -> Totals:
    """The totals of the steps taken so far."""
    vehicles = vehicle_records(trace)
    station_kw = executed_station_kw(trace)
    refused = sum(record.status == "refused" for record in vehicles)
    return Totals(
        arrived=len(vehicles),
        admitted=len(vehicles) - refused,
        refused=refused,
        charged=sum(record.status == "charged" for record in vehicles),
        broken=sum(record.status == "broken" for record in vehicles),
        released=sum(record.status == "released" for record in vehicles),
        energy_requested_kwh=sum(record.request.need_kwh for record in vehicles),
        energy_delivered_kwh=float(station_kw.sum()) * trace.scenario.interval_hours,
        revenue=sum(record.revenue for record in vehicles),
        energy_cost=executed_tariff(trace).cost(station_kw),
        peak_station_kw=float(station_kw.max(initial=0.0)),
    )


@dataclass(frozen=True, slots=True)
class Service:
    """A day in figures; None where there is nothing to measure.

    The `ac_` figures are None without an AC power flow, those of perfect information without
    an oracle. `acceptance_by_option` and `refused_kwh_by_reason` are tables of their own.
    """

    acceptance_by_option: Mapping[str, float | None]
    refused_kwh_by_reason: Mapping[str, float]
    arrived: int = figure("Asked", "vehicles", "Vehicles that asked for a charge.")
    admitted: int = figure("Admitted", "vehicles", "Vehicles that were given a contract.")
    acceptance: float | None = figure("Acceptance", "%", "Admitted of those who asked.", 1)
    demands_met: float | None = figure(
        "Demands met", "%", "Vehicles that got all they asked for, of all who asked.", 1
    )
    contracts_kept: float | None = figure(
        "Contracts kept", "%", "Contracts served in full and in time, of those whose time is up.", 1
    )
    broken: int = figure("Contracts broken", "vehicles", "Vehicles short of what was promised.")
    on_time_margin_h: float | None = figure(
        "On-time margin", "h", "Mean time between full and the promised return.", 2
    )
    energy_requested_kwh: float = figure("Energy asked for", "kWh", "Of all who asked.", 1)
    energy_delivered_kwh: float = figure("Energy delivered", "kWh", "Drawn from the grid.", 1)
    energy_met: float | None = figure(
        "Energy met", "%", "Energy delivered of the energy asked for.", 1
    )
    revenue: float = figure("Revenue", "$", "What drivers pay.", 2)
    energy_cost: float = figure("Energy cost", "$", "What the energy drawn costs.", 2)
    profit: float = figure("Profit", "$", "Revenue less energy cost.", 2)
    profit_of_best: float | None = figure(
        "Profit against perfect information",
        "%",
        "Profit of the most any policy could have earned within the limits of the network model "
        "kept, proven by an oracle that knows who will come.",
        1,
    )
    short_of_best: float | None = figure(
        "Short of perfect information", "$", "What that proven most leaves out of reach.", 2
    )
    peak_station_kw: float = figure(
        "Peak station load", "kW", "Highest mean power of an interval.", 1
    )
    load_factor: float | None = figure("Load factor", "%", "Mean station load of its peak.", 1)
    headroom_use: float | None = figure(
        "Headroom use",
        "%",
        "Energy drawn of what feeder and chargers had room for; above 100 only where limits are "
        "not kept.",
        1,
    )
    ac_voltage_node_intervals: int | None = figure(
        "Voltages beyond limits in AC",
        "node-intervals",
        "How many nodes were outside their voltage limits in how many intervals, through charging.",
    )
    ac_voltage_depth_pu: float | None = figure(
        "Deepest voltage beyond limits in AC", "pu", "By how much the worst of them was.", 4
    )
    ac_voltage_longest_h: float | None = figure(
        "Longest voltage beyond limits in AC", "h", "Without a break, at any one node.", 2
    )
    ac_overload_intervals: int | None = figure(
        "Overloads in AC",
        "element-intervals",
        "How many lines, transformers and nodes were over their rating in how many intervals, "
        "through charging.",
    )
    ac_overload_kva: float | None = figure(
        "Worst overload in AC", "kVA", "By how much the worst of them was over its rating.", 1
    )
    ac_overload_longest_h: float | None = figure(
        "Longest overload in AC", "h", "Without a break, of any one element.", 2
    )
    ac_unsolved: int | None = figure(
        "Without AC solution", "intervals", "The power flow found none; voltage may collapse."
    )
    ac_losses_kwh: float | None = figure("Losses in AC", "kWh", "Of the whole feeder.", 1)
    ac_voltage_error_pu: float | None = figure(
        "Worst voltage error",
        "pu",
        "Largest difference between the linearised model's voltage and AC.",
        4,
    )
    starts_per_session: float | None = figure(
        "Starts per session", "", "How often charging began, per vehicle served.", 2
    )
    churn_kwh: float = figure(
        "Schedule churn",
        "kWh",
        "Energy under contract that new plans moved to other intervals, over the day.",
        1,
    )
    solve_median_s: float | None = figure("Solving, median", "s", "Of all intervals.", 3)
    solve_p95_s: float | None = figure("Solving, 95th percentile", "s", "Of all intervals.", 3)
    solve_worst_s: float | None = figure("Solving, worst", "s", "The slowest interval.", 3)
    proven_gap: float | None = figure(
        "Proven gap", "$", "Largest distance of a plan of P1 from its proven bound.", 4
    )


def service(trace: Trace, ac: AcDay | None = None, most_profit: float | None = None) -> Service:
    """The figures of the steps taken.

    `ac` is the AC power flow of what was executed; `most_profit` in $ what a policy that knows
    who will come could earn at most, for a day that is over.
    """
    day, vehicles = totals(trace), vehicle_records(trace)
    power_kw, seconds = executed_station_kw(trace), [s.plan.report.seconds for s in trace.steps]
    found = AcTroubles() if ac is None else troubles(trace, ac)
    over = day.charged + day.released + day.broken
    return Service(
        arrived=day.arrived,
        admitted=day.admitted,
        acceptance=_share(day.admitted, day.arrived),
        acceptance_by_option=acceptance_by_option(vehicles),
        demands_met=_share(day.charged, day.arrived),
        contracts_kept=_share(over - day.broken, over),
        broken=day.broken,
        on_time_margin_h=_on_time_margin_h(vehicles, trace.scenario.interval_hours),
        energy_requested_kwh=day.energy_requested_kwh,
        energy_delivered_kwh=day.energy_delivered_kwh,
        energy_met=_share(day.energy_delivered_kwh, day.energy_requested_kwh),
        refused_kwh_by_reason=refused_kwh_by_reason(vehicles),
        revenue=day.revenue,
        energy_cost=day.energy_cost,
        profit=day.profit,
        **_against_best(day, most_profit),
        peak_station_kw=day.peak_station_kw,
        load_factor=_share(float(power_kw.mean()) if len(power_kw) else 0.0, day.peak_station_kw),
        headroom_use=_share(float(power_kw.sum()), _room_kw(trace)),
        ac_voltage_node_intervals=found.voltage_node_intervals,
        ac_voltage_depth_pu=found.voltage_depth_pu,
        ac_voltage_longest_h=found.voltage_longest_h,
        ac_overload_intervals=found.overload_intervals,
        ac_overload_kva=found.overload_kva,
        ac_overload_longest_h=found.overload_longest_h,
        ac_unsolved=found.unsolved,
        ac_losses_kwh=found.losses_kwh,
        ac_voltage_error_pu=found.voltage_error_pu,
        starts_per_session=_share(*_starts(trace)),
        churn_kwh=churn_kwh(trace),
        solve_median_s=statistics.median(seconds) if seconds else None,
        solve_p95_s=float(np.percentile(seconds, 95)) if seconds else None,
        solve_worst_s=max(seconds, default=None),
        proven_gap=_proven_gap(trace),
    )


def acceptance_by_option(vehicles: Sequence[VehicleRecord]) -> dict[str, float | None]:
    """Admitted of those who asked, by price option."""
    asked: dict[str, list[bool]] = {}
    for record in vehicles:
        asked.setdefault(record.request.option, []).append(record.status != "refused")
    return {option: _share(sum(yes), len(yes)) for option, yes in sorted(asked.items())}


def refused_kwh_by_reason(vehicles: Sequence[VehicleRecord]) -> dict[str, float]:
    """Energy refused, kWh, by reason, most first."""
    refused = {
        reason: sum(record.request.need_kwh for record in records)
        for reason, records in refused_by_reason(vehicles).items()
    }
    return dict(sorted(refused.items(), key=lambda item: -item[1]))


def churn_kwh(trace: Trace) -> float:
    """Energy that new plans moved: half of what they differ by from the plans before, kWh."""
    return sum(
        0.5 * float(np.abs(step.plan.power_kw[: len(tail)] - tail).sum())
        for step in trace.steps
        for tail in [step.before.tail_kw]
    ) * (trace.scenario.interval_hours)


def _share(part: float, whole: float) -> float | None:
    return part / whole if whole > 0 else None


def _against_best(day: Totals, most_profit: float | None) -> dict[str, float | None]:
    if most_profit is None:
        return {"profit_of_best": None, "short_of_best": None}
    return {
        "profit_of_best": _share(day.profit, most_profit),
        "short_of_best": most_profit - day.profit,
    }


def _on_time_margin_h(vehicles: Sequence[VehicleRecord], hours: float) -> float | None:
    margins = [
        (record.request.deadline_interval - record.completed_interval - 1) * hours
        for record in vehicles
        if record.completed_interval is not None
    ]
    return statistics.mean(margins) if margins else None


def _room_kw(trace: Trace) -> float:
    """What feeder and chargers had room for in the executed intervals, summed, kW."""
    room_kw = 0.0
    for step in trace.steps:
        station = step.inputs.scenario.station
        headroom_kw = float(step.inputs.rows.headroom_kw()[step.interval])
        room_kw += min(headroom_kw, station.chargers * station.max_kw)
    return room_kw


def _starts(trace: Trace) -> tuple[int, int]:
    """How often charging began, and how many vehicles it was."""
    on: dict[str, set[int]] = {}
    for interval, vehicle, _ in executed_power(trace):
        on.setdefault(vehicle, set()).add(interval)
    return sum(t - 1 not in slots for slots in on.values() for t in slots), len(on)


def _proven_gap(trace: Trace) -> float | None:
    """Largest distance of objective and bound, $; None where no bound was proven, or none asked."""
    reports = [step.plan.report for step in trace.steps]
    gaps = [
        report.objective - report.bound
        for report in reports
        if report.objective is not None and report.bound is not None
    ]
    return max(gaps, default=None)
