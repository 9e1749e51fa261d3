"""A run as its files tell it."""

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast, get_args

import numpy as np

from evdash.audit.asked import Asked, everyone_asked
from evdash.audit.events import as_it_turned_out
from evdash.domain.arrivals import RecordedArrivals
from evdash.domain.fields import Record
from evdash.domain.limits import Floats
from evdash.domain.refusal import CLAUSES, RefusalKind
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Network
from evdash.errors import Fault, InputError
from evdash.files.explanation_rows import EXPLANATION_TABLES
from evdash.files.folder import read_files
from evdash.files.run_folder import SCENARIO, SUMMARY, read_run, scenario_hash
from evdash.files.run_tables import (
    RUN_TABLES,
    IntervalRow,
    LedgerRow,
    PowerRow,
    Row,
    VehicleRow,
    VoltageRow,
    parse_rows,
)
from evdash.files.scenario_folder import parse_scenario


@dataclass(frozen=True, slots=True)
class RunRecord:
    """A run folder's content. `power_kw` has a row of (intervals,) for each vehicle named.

    `given` is the scenario as it lies in the folder, `scenario` has the loads and prices each
    interval really had, by its events; its chargers and ratings are those of the beginning.
    `asked` holds what everyone asked for, in order of arrival; `explained` the tables of
    `run --explain`, where there are any.
    """

    given: Scenario
    scenario: Scenario
    asked: Mapping[str, Asked]
    scenario_hash: str
    network: Network
    summary: dict[str, object]
    intervals: list[IntervalRow]
    vehicles: list[VehicleRow]
    ledger: list[LedgerRow]
    voltages: list[VoltageRow]
    power_kw: dict[str, Floats]
    explained: Mapping[str, Sequence[Record]]

    @property
    def files(self) -> frozenset[str]:
        """The files there are in its folder."""
        return frozenset((SUMMARY, *RUN_TABLES, *self.explained, f"{SCENARIO}/"))

    @property
    def station_kw(self) -> Floats:
        """Station power by `power.csv`, kW, shape (intervals,)."""
        total = np.zeros(self.scenario.intervals)
        for power_kw in self.power_kw.values():
            total = total + power_kw
        return total


def read_record(directory: Path) -> RunRecord:
    """Read a run folder; raises InputError with every fault in the form of its files."""
    files, summary = read_run(directory)
    scenario_bytes = read_files(directory / SCENARIO)
    scenario = parse_scenario(scenario_bytes)
    faults: list[Fault] = []
    network = summary.get("network")
    if network not in get_args(Network):
        allowed = f"should be one of {', '.join(get_args(Network))}"
        faults.append(Fault(f"{SUMMARY}, network", repr(network), allowed))
    if not isinstance(scenario.arrivals, RecordedArrivals):
        faults.append(Fault(f"{SCENARIO}/scenario.toml", "generated arrivals", "need be on file"))

    def rows(name: str, record: type[Row]) -> list[Row]:
        if name not in files:
            faults.append(Fault(name, "no such file", f"belongs beside {SUMMARY}"))
            return []
        try:
            parsed = parse_rows(name, files[name], record)
            faults.extend(_columns_missing(name, files[name], record))
            return parsed
        except InputError as error:
            faults.extend(error.faults)
            return []

    intervals = rows("intervals.csv", IntervalRow)
    vehicles = rows("vehicles.csv", VehicleRow)
    voltages = rows("voltages.csv", VoltageRow)
    ledger = rows("ledger.csv", LedgerRow)
    power = rows("power.csv", PowerRow)
    tables = {n: rows(n, record) for n, record in EXPLANATION_TABLES.items() if n in files}
    if faults:
        raise InputError(faults)
    return RunRecord(
        given=scenario,
        scenario=as_it_turned_out(scenario),
        asked=everyone_asked(scenario),
        scenario_hash=scenario_hash(scenario_bytes),
        network=cast(Network, network),
        summary=summary,
        intervals=intervals,
        vehicles=vehicles,
        ledger=ledger,
        voltages=voltages,
        power_kw=_power(power, scenario.intervals),
        explained=tables,
    )


def _columns_missing(name: str, content: bytes, record: type[Record]) -> Iterator[Fault]:
    """Columns that may be blank, and so left out of a scenario, but not of a run's own files."""
    header = next(csv.reader(io.StringIO(content.decode("utf-8-sig"), newline="")), [])
    for column in record.model_fields:
        if column not in {cell.strip() for cell in header}:
            yield Fault(name, f"no column {column}", "should have every column, blank or not")


def kind_of(reason: str) -> RefusalKind | None:
    """The kind of a refusal that a reason words, before its figures; None if it is none of them."""
    for kind, clause in CLAUSES.items():
        if reason == clause or reason.startswith(f"{clause}: "):
            return kind
    return None


def _power(rows: list[PowerRow], n_intervals: int) -> dict[str, Floats]:
    power: dict[str, Floats] = {}
    faults = []
    for row in rows:
        if row.interval >= n_intervals:
            place = f"power.csv, {row.vehicle}"
            faults.append(Fault(place, f"interval {row.interval}", f"below {n_intervals}"))
            continue
        mine = power.setdefault(row.vehicle, np.zeros(n_intervals))
        if mine[row.interval] > 0:
            place = f"power.csv, {row.vehicle}"
            faults.append(Fault(place, f"interval {row.interval} again", "each once only"))
        mine[row.interval] = row.power_kw
    if faults:
        raise InputError(faults)
    return power
