"""A run as its files tell it."""

from dataclasses import dataclass
from pathlib import Path
from typing import cast, get_args

import numpy as np

from evdash.audit.events import as_it_turned_out
from evdash.domain.limits import Floats
from evdash.domain.scenario import RecordedArrivals, Scenario
from evdash.domain.trace import Network
from evdash.errors import Fault, InputError
from evdash.files.folder import read_files
from evdash.files.run_folder import SCENARIO, SUMMARY, read_run, scenario_hash
from evdash.files.run_tables import (
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

    `scenario` has the loads and prices each interval really had, by its events; its chargers
    and ratings are those of the beginning.
    """

    scenario: Scenario
    scenario_hash: str
    network: Network
    summary: dict[str, object]
    intervals: list[IntervalRow]
    vehicles: list[VehicleRow]
    ledger: list[LedgerRow]
    voltages: list[VoltageRow]
    power_kw: dict[str, Floats]

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
            return parse_rows(name, files[name], record)
        except InputError as error:
            faults.extend(error.faults)
            return []

    intervals = rows("intervals.csv", IntervalRow)
    vehicles = rows("vehicles.csv", VehicleRow)
    voltages = rows("voltages.csv", VoltageRow)
    # runs of versions without events have none
    told = "ledger.csv" in files or bool(scenario.events)
    ledger = rows("ledger.csv", LedgerRow) if told else []
    power = rows("power.csv", PowerRow)
    if faults:
        raise InputError(faults)
    return RunRecord(
        scenario=as_it_turned_out(scenario),
        scenario_hash=scenario_hash(scenario_bytes),
        network=cast(Network, network),
        summary=summary,
        intervals=intervals,
        vehicles=vehicles,
        ledger=ledger,
        voltages=voltages,
        power_kw=_power(power, scenario.intervals),
    )


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
