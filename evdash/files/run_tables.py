"""The tables of a run folder, each column declared once for writing, reading and the docs."""

from collections.abc import Iterable, Mapping
from typing import Literal, TypeVar

from pydantic import ValidationError

from evdash.domain.arrivals import LOCAL_TIME_FORMAT, LocalTime
from evdash.domain.fields import (
    OptionalCount,
    OptionalNumber,
    Record,
    declare,
    declare_optional,
)
from evdash.domain.trace import Trace
from evdash.errors import Fault, InputError
from evdash.files.tables import read_table, write_table
from evdash.files.wording import allowed, found
from evdash.metrics.ledger import ledger
from evdash.metrics.records import executed_power, interval_records, vehicle_records


class IntervalRow(Record):
    """A row of `intervals.csv`: one interval as decided and executed."""

    interval: int = declare("Interval, counted from 0", "", 0, ge=0)
    start: LocalTime = declare("Clock time at which it begins", "", "2020-07-15T00:00")
    price_per_kwh: float = declare("Energy price", "$/kWh", 0.03)
    arrived: int = declare("Vehicles asking from this interval on", "vehicles", 0, ge=0)
    admitted: int = declare("Of these, given a contract", "vehicles", 0, ge=0)
    refused: int = declare("Of these, turned down", "vehicles", 0, ge=0)
    charging: int = declare("Vehicles charging in it", "vehicles", 0, ge=0)
    station_kw: float = declare("Station power", "kW", 0.0, ge=0)
    headroom_kw: OptionalNumber = declare_optional("Largest station power allowed", "kW")
    binding: str = declare("Tightest element, whether reached or not", "", "")
    objective: OptionalNumber = declare_optional("P1 as minimised", "$")
    bound: OptionalNumber = declare_optional("Proven lower bound on P1", "$")
    solve_seconds: float = declare("Time taken to decide", "s", 0.0, ge=0)
    status: Literal["optimal", "feasible", "fallback"] = declare(
        "How it was decided", "", "optimal"
    )


class VehicleRow(Record):
    """A row of `vehicles.csv`: one vehicle's fate."""

    vehicle: str = declare("Name of the vehicle", "", "PEV-001")
    option: str = declare("Price option", "", "C1")
    arrival_interval: int = declare("First interval in which it may charge", "", 0, ge=0)
    need_kwh: float = declare("Energy asked for, grid side", "kWh", 10.0, ge=0)
    deadline_interval: int = declare("First interval in which it may no longer charge", "", 1)
    status: Literal["charged", "refused", "broken", "charging", "released"] = declare(
        "Fate", "", "charged"
    )
    reason: str = declare("Why it was refused", "", "")
    delivered_kwh: float = declare("Energy delivered, grid side", "kWh", 10.0, ge=0)
    completed_interval: OptionalCount = declare_optional("Interval that completed it", "")
    revenue: float = declare("What it pays", "$", 3.5)


class LedgerRow(Record):
    """A row of `ledger.csv`: what became of one contract."""

    vehicle: str = declare("Name of the vehicle", "", "PEV-001")
    option: str = declare("Price option", "", "C1")
    promised_kwh: float = declare("Energy promised, grid side", "kWh", 10.0, ge=0)
    promised_by_interval: int = declare("First interval that is too late for it", "", 1)
    revised_kwh: float = declare("The promise as last agreed with its driver", "kWh", 10.0, ge=0)
    revised_by_interval: int = declare("Its time as last agreed", "", 1)
    delivered_kwh: float = declare("Energy delivered, grid side", "kWh", 10.0, ge=0)
    short_kwh: float = declare("Missing of what was last agreed", "kWh", 0.0, ge=0)
    released_kwh: float = declare("Given up by its driver", "kWh", 0.0, ge=0)
    status: Literal["open", "kept", "short", "released"] = declare("What became of it", "", "kept")
    since_interval: OptionalCount = declare_optional("Interval in which that became known", "")
    cause: str = declare("What happened that changed it", "", "")


class PowerRow(Record):
    """A row of `power.csv`: power executed, listed only where there is any."""

    interval: int = declare("Interval, counted from 0", "", 0, ge=0)
    vehicle: str = declare("Name of the vehicle", "", "PEV-001")
    power_kw: float = declare("Mean power of the interval, grid side", "kW", 7.2, gt=0)


class VoltageRow(Record):
    """A row of `voltages.csv`: a node's voltage under the executed schedule."""

    interval: int = declare("Interval, counted from 0", "", 0, ge=0)
    node: str = declare("Name of the node", "", "632")
    voltage_pu: float = declare("Voltage by linearised DistFlow", "pu", 1.0, ge=0)
    voltage_ac_pu: OptionalNumber = declare_optional("Voltage by AC power flow", "pu")


RUN_TABLES: Mapping[str, type[Record]] = {
    "intervals.csv": IntervalRow,
    "vehicles.csv": VehicleRow,
    "ledger.csv": LedgerRow,
    "power.csv": PowerRow,
    "voltages.csv": VoltageRow,
}
Row = TypeVar("Row", bound=Record)


def interval_rows(trace: Trace) -> list[IntervalRow]:
    """`intervals.csv` of a trace."""
    names = IntervalRow.model_fields
    return [
        IntervalRow.model_construct(**{name: getattr(record, name) for name in names})
        for record in interval_records(trace)
    ]


def vehicle_rows(trace: Trace) -> list[VehicleRow]:
    """`vehicles.csv` of a trace."""
    return [
        VehicleRow.model_construct(
            vehicle=record.vehicle,
            option=record.request.option,
            arrival_interval=record.request.arrival_interval,
            need_kwh=record.request.need_kwh,
            deadline_interval=record.request.deadline_interval,
            status=record.status,
            reason=record.why_not,
            delivered_kwh=record.delivered_kwh,
            completed_interval=record.completed_interval,
            revenue=record.revenue,
        )
        for record in vehicle_records(trace)
    ]


def ledger_rows(trace: Trace) -> list[LedgerRow]:
    """`ledger.csv` of a trace."""
    names = LedgerRow.model_fields
    return [
        LedgerRow.model_construct(**{name: getattr(entry, name) for name in names})
        for entry in ledger(trace)
    ]


def power_rows(trace: Trace) -> list[PowerRow]:
    """`power.csv` of a trace."""
    return [
        PowerRow.model_construct(interval=interval, vehicle=vehicle, power_kw=power_kw)
        for interval, vehicle, power_kw in executed_power(trace)
    ]


def table_text(record: type[Row], rows: Iterable[Row]) -> str:
    """Rows as a CSV table with the columns of their record."""
    columns = list(record.model_fields)
    return write_table(columns, ([_cell(getattr(row, c)) for c in columns] for row in rows))


def _cell(value: object) -> object:
    return value.strftime(LOCAL_TIME_FORMAT) if hasattr(value, "strftime") else value


def parse_rows(name: str, content: bytes, record: type[Row]) -> list[Row]:
    """Rows of a run's table; raises InputError with every fault in its form."""
    table, faults = read_table(name, content, record)
    rows: list[Row] = []
    if table is not None:
        for cells, number in zip(table.rows, table.row_numbers, strict=True):
            try:
                rows.append(record.model_validate(cells))
            except ValidationError as error:
                faults += [
                    Fault(f"{name}, row {number}, column {e['loc'][0]}", found(e), allowed(e))
                    for e in error.errors(include_url=False)
                ]
    if faults:
        raise InputError(faults)
    return rows
