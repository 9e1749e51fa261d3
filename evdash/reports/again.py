"""An earlier run's folder turned back into its day: decided again and held against its files."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evdash.audit.record import RunRecord, read_record
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Network, Trace
from evdash.errors import Fault, InputError
from evdash.files.run_export import RunLabel
from evdash.files.run_folder import SCENARIO, SUMMARY
from evdash.files.scenario_folder import read_scenario
from evdash.metrics.records import executed_power, vehicle_records
from evdash.policies.registry import Rule, known

SAME_KW = 1e-4
"""So close two powers are the same: a contract differs by less than the audit tells apart."""
Decided = Callable[[Scenario, Network, Rule], Trace]
"""Runs a whole day of a scenario under a network model and a policy."""


@dataclass(frozen=True, slots=True)
class Earlier:
    """A run folder: its scenario and what it was made with, its record to be held against."""

    directory: Path
    record: RunRecord
    scenario: Scenario
    label: RunLabel


def is_run_folder(path: Path) -> bool:
    """Whether a path looks like an earlier run's folder rather than a scenario's."""
    return (path / SUMMARY).exists()


def earlier_run(directory: Path) -> Earlier:
    """Read a run folder; raises InputError with every fault in the form of its files."""
    record = read_record(directory)
    summary = record.summary
    policy, wall = summary.get("policy"), summary.get("wall_seconds")
    known(str(policy), f"{directory}/{SUMMARY}, policy")
    scenario = read_scenario(directory / SCENARIO)
    label = RunLabel(
        policy=str(policy),
        network=record.network,
        seed=scenario.arrivals.seed,
        wall_seconds=float(wall) if isinstance(wall, int | float) else 0.0,
    )
    return Earlier(directory, record, scenario, label)


def decided_again(earlier: Earlier, decide: Decided) -> Trace:
    """The day of a run folder, decided again by the policy it was made with.

    Raises InputError where that does not give what its files tell: they are another version's,
    or were changed, and what is handed on must be of the run itself.
    """
    trace = decide(earlier.scenario, earlier.label.network, known(earlier.label.policy))
    differing = _first_difference(trace, earlier.record)
    if differing:
        made = earlier.record.summary.get("versions")
        allowed = (
            f"deciding it again should give the same; the run was made with {made}. Run its "
            f"scenario anew with --out, and export that"
        )
        raise InputError([Fault(str(earlier.directory), differing, allowed)])
    return trace


def _first_difference(trace: Trace, record: RunRecord) -> str:
    """What of a day is not as its record tells it, in words; empty where all is."""
    told = {row.vehicle: row.status for row in record.vehicles}
    found = {one.vehicle: one.status for one in vehicle_records(trace)}
    for vehicle in sorted(set(told) | set(found)):
        if told.get(vehicle) != found.get(vehicle):
            was, now = told.get(vehicle, "absent"), found.get(vehicle, "absent")
            return f"{vehicle} {was} in vehicles.csv, {now} when decided again"
    n_intervals = trace.scenario.intervals
    power_kw = {vehicle: np.zeros(n_intervals) for vehicle in found}
    for interval, vehicle, power in executed_power(trace):
        power_kw[vehicle][interval] = power
    for vehicle, decided in power_kw.items():
        recorded = record.power_kw.get(vehicle, np.zeros(n_intervals))
        apart = np.abs(recorded - decided)
        if apart.max(initial=0.0) > SAME_KW:
            t = int(apart.argmax())
            return (
                f"{vehicle} with {recorded[t]:.4g} kW in interval {t} in power.csv, "
                f"{decided[t]:.4g} kW when decided again"
            )
    return ""
