"""A day in a handful of numbers."""

from dataclasses import dataclass

from evdash.domain.trace import Trace
from evdash.metrics.records import executed_station_kw, executed_tariff, vehicle_records


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
