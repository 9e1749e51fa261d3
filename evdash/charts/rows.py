"""What a chart of many vehicles shows: a row for each, with its power by interval."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from evdash.domain.trace import Trace
from evdash.domain.vehicles import Request
from evdash.metrics.records import VehicleRecord, vehicle_records


@dataclass(slots=True)
class Row:
    """One vehicle: what it asked for, and its power by interval in kW; none if refused.

    `promised_kwh` is what its contract is for as last agreed, `short_kwh` what of it is missing,
    or known not to come.
    """

    request: Request
    power_kw: dict[int, float] = field(default_factory=dict)
    delivered_kwh: float = 0.0
    is_refused: bool = False
    promised_kwh: float = 0.0
    short_kwh: float = 0.0

    @property
    def percent(self) -> int:
        """How much of what it was promised it has, rounded down: 100 means all."""
        if self.promised_kwh <= 0:
            return 100
        return int(100 * self.delivered_kwh / self.promised_kwh + 1e-6)


def rows_of(trace: Trace) -> list[Row]:
    """A row for everyone admitted so far, in order of admission."""
    rows: dict[str, Row] = {}
    hours = trace.scenario.interval_hours
    for step in trace.steps:
        asked = {request.vehicle: request for request in step.requests}
        for vehicle in step.plan.admitted:
            rows[vehicle] = Row(asked[vehicle])
        for vehicle, power in zip(step.plan.vehicles, step.plan.power_kw[:, 0], strict=True):
            if power > 0:
                rows[vehicle].power_kw[step.interval] = float(power)
                rows[vehicle].delivered_kwh += float(power) * hours
    for record in vehicle_records(trace):
        if row := rows.get(record.vehicle):
            row.promised_kwh, row.short_kwh = record.promised_kwh, record.short_kwh
    for contract, tail_kw in zip(trace.state.contracts, trace.state.tail_kw, strict=True):
        for slot, power in enumerate(tail_kw):
            if power > 0:
                rows[contract.vehicle].power_kw[trace.now + slot] = float(power)
    return list(rows.values())


def rows_for(trace: Trace, records: Sequence[VehicleRecord]) -> list[Row]:
    """Rows of the vehicles recorded, refused ones too, in the order given."""
    admitted = {row.request.vehicle: row for row in rows_of(trace)}
    return [
        admitted.get(record.vehicle) or Row(record.request, is_refused=True) for record in records
    ]
