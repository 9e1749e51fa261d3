"""What stands in the workbook, sheet by sheet: columns with units and notes, rows of values."""

import math
import tomllib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from pydantic import BaseModel

from evdash.domain.arrivals import FleetModel, RecordedArrivals
from evdash.domain.scenario import Scenario
from evdash.files.draft import RECORDS
from evdash.files.run_export import voltage_rows
from evdash.files.run_tables import (
    IntervalRow,
    LedgerRow,
    PowerRow,
    VehicleRow,
    VoltageRow,
    interval_rows,
    ledger_rows,
    power_rows,
    vehicle_rows,
)
from evdash.files.scenario_folder import SETTINGS, resolved, scenario_files
from evdash.imports.scenario_book import KEY, SETTINGS_SHEET, VALUE, settings_rows
from evdash.metrics.declared import figures_of
from evdash.metrics.service import Service
from evdash.reports import tables
from evdash.reports.account import Account

Value = str | float | int | datetime | None
FORMATS = {
    "$": "#,##0.00;[Red]-#,##0.00",
    "$/kWh": "0.0000",
    "kW": "#,##0.0",
    "kWh": "#,##0.00",
    "kVA": "#,##0.0",
    "pu": "0.00000",
    "s": "0.000",
    "%": "0.0%",
    "h": "0.00",
}


@dataclass(frozen=True, slots=True)
class Column:
    """A column: its head with the unit, what the head's note says, how its numbers look."""

    head: str
    note: str = ""
    number_format: str = ""


@dataclass(frozen=True, slots=True)
class Sheet:
    """A sheet: what it holds in a sentence, its columns, its rows in their order."""

    name: str
    told: str
    columns: Sequence[Column]
    rows: Sequence[Sequence[Value]]


def sheets(account: Account) -> list[Sheet]:
    """Every sheet but the first, which lists them."""
    return [
        _figures(account),
        *_results(account),
        *_findings(account),
        *_inputs(account),
    ]


def _figures(account: Account) -> Sheet:
    service = tables.service_of(account)
    rows = []
    for figure in figures_of(Service):
        value = getattr(service, figure.name)
        rows.append(
            [figure.label, _number(value), "" if figure.is_share else figure.unit, figure.meaning]
        )
    told = "The day in figures; shares of 1 are shown in per cent."
    return Sheet("Figures", told, [Column(c) for c in ("Figure", "Value", "Unit", "Meaning")], rows)


def _results(account: Account) -> list[Sheet]:
    trace, verdict = account.trace, account.verdict
    of_run = "as in the run's own files, to 16 digits"
    return [
        _declared("Intervals", f"Every interval, {of_run}.", IntervalRow, interval_rows(trace)),
        _with_times(
            _declared(
                "Vehicles", f"Everyone who asked, {of_run}.", VehicleRow, vehicle_rows(trace)
            ),
            account,
            {"Arrival": "arrival_interval", "Back by": "deadline_interval"},
            VehicleRow,
        ),
        _with_times(
            _declared("Ledger", f"Every promise, {of_run}.", LedgerRow, ledger_rows(trace)),
            account,
            {"By": "promised_by_interval", "By, as last agreed": "revised_by_interval"},
            LedgerRow,
        ),
        _with_times(
            _declared("Power", f"Power executed, {of_run}.", PowerRow, power_rows(trace)),
            account,
            {"Start": "interval"},
            PowerRow,
        ),
        _with_times(
            _declared(
                "Voltages", f"Every node's voltage, {of_run}.", VoltageRow, voltage_rows(verdict)
            ),
            account,
            {"Start": "interval"},
            VoltageRow,
        ),
    ]


def _findings(account: Account) -> list[Sheet]:
    """The tables of the report."""
    found: list[tuple[str, str, Callable[[Account], list[tables.Row]]]] = [
        ("Options", "How each price option fared.", tables.option_rows),
        ("Refusals", "Refusals by reason.", tables.reason_rows),
        ("Limits exceeded", "Every limit exceeded, by element and cause.", tables.violation_rows),
        (
            "Voltages beyond",
            "How long and how far voltages were beyond thresholds, by AC.",
            tables.voltage_rows,
        ),
        (
            "Loading beyond",
            "How long and how far loadings were beyond thresholds, by AC.",
            tables.loading_rows,
        ),
        ("Lowest voltages", "Every node's lowest voltage, by AC.", tables.node_rows),
        ("Highest loadings", "Every rated line's highest loading, by AC.", tables.line_rows),
        ("Ageing", "Ageing of the station's transformer by IEEE C57.91.", tables.ageing_rows),
        ("Ageing assumes", "What the ageing assumes.", tables.thermal_rows),
    ]
    return [_plain(name, told, rows(account)) for name, told, rows in found]


def _inputs(account: Account) -> list[Sheet]:
    """The scenario's tables under the names of their files, and its settings."""
    trace = account.trace
    scenario: Scenario = resolved(trace.inputs.given, trace.inputs.arrivals)
    rows: dict[str, Iterable[BaseModel]] = {
        "nodes.csv": scenario.nodes,
        "lines.csv": scenario.lines,
        "profile.csv": scenario.profile,
        "fleet.csv": _fleet(scenario),
        "arrivals.csv": trace.inputs.arrivals,
        "events.csv": scenario.events,
    }
    settings = tomllib.loads(scenario_files(scenario)[SETTINGS])
    listed = [[str(key), _value(value)] for key, value in settings_rows(settings)]
    columns = [Column(KEY), Column(VALUE)]
    return [
        Sheet(SETTINGS_SHEET, f"The settings, {SETTINGS}.", columns, listed),
        *(
            _scenario_table(file.removesuffix(".csv"), RECORDS[file], list(found))
            for file, found in rows.items()
            if found
        ),
    ]


def _fleet(scenario: Scenario) -> tuple[FleetModel, ...]:
    """The models a policy may know that vehicles are drawn from."""
    known = scenario.arrivals
    statistics = known.forecast if isinstance(known, RecordedArrivals) else known
    return () if statistics is None else statistics.fleet


def _scenario_table(name: str, record: type[BaseModel], rows: Sequence[BaseModel]) -> Sheet:
    """A table of the scenario under its own column names, so that it can be taken in again."""
    columns = [
        Column(field, _meaning(record, field), FORMATS.get(_unit(record, field), ""))
        for field in record.model_fields
    ]
    values = [[_value(getattr(row, field)) for field in record.model_fields] for row in rows]
    return Sheet(name, f"Of the scenario: {name}.csv.", columns, values)


def _declared(name: str, told: str, record: type[BaseModel], rows: Sequence[BaseModel]) -> Sheet:
    """Rows of a run's table; heads and notes from the declaration of each field."""
    columns = []
    for field, info in record.model_fields.items():
        unit = _unit(record, field)
        head = f"{field.replace('_', ' ')}" + (f" [{unit}]" if unit else "")
        columns.append(Column(head, f"{info.description} ({field})", FORMATS.get(unit, "")))
    values = [[_value(getattr(row, field)) for field in record.model_fields] for row in rows]
    return Sheet(name, told, columns, values)


def _with_times(
    sheet: Sheet, account: Account, times: dict[str, str], record: type[BaseModel]
) -> Sheet:
    """The sheet with clock times of some of its intervals added on the right."""
    places = {head: list(record.model_fields).index(field) for head, field in times.items()}
    time_of = account.scenario.time_of
    columns = [
        *sheet.columns,
        *(
            Column(head, f"Clock time at which interval {field} begins")
            for head, field in times.items()
        ),
    ]
    rows = [
        [*row, *(time_of(int(str(row[place]))) for place in places.values())] for row in sheet.rows
    ]
    return Sheet(sheet.name, sheet.told, columns, rows)


def _plain(name: str, told: str, rows: Sequence[tables.Row]) -> Sheet:
    heads = list(rows[0]) if rows else ["Nothing to tell"]
    values = [[_value(row[head]) for head in heads] for row in rows]
    return Sheet(name, told, [Column(head) for head in heads], values)


def _unit(record: type[BaseModel], field: str) -> str:
    extra = record.model_fields[field].json_schema_extra
    return str(extra.get("unit") or "") if isinstance(extra, dict) else ""


def _meaning(record: type[BaseModel], field: str) -> str:
    unit = _unit(record, field)
    meaning = record.model_fields[field].description or field
    return f"{meaning}, {unit}" if unit else meaning


def _value(value: Any) -> Value:
    if isinstance(value, datetime) or value is None:
        return value
    if isinstance(value, int | float) and not isinstance(value, bool):
        return _number(value)
    return str(value)


def _number(value: float | None) -> float | int | None:
    return value if value is not None and math.isfinite(value) else None
