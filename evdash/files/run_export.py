"""A finished trace as the files of a run folder."""

import json
import platform
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version

import numpy as np

from evdash import __version__
from evdash.domain.breach import Breach
from evdash.domain.trace import Network, Trace
from evdash.files.run_folder import RUN_FORMAT, SCENARIO, SUMMARY, scenario_hash
from evdash.files.run_tables import (
    IntervalRow,
    LedgerRow,
    PowerRow,
    VehicleRow,
    VoltageRow,
    interval_rows,
    ledger_rows,
    power_rows,
    table_text,
    vehicle_rows,
)
from evdash.files.scenario_folder import resolved, scenario_files
from evdash.grid.acbreaches import ac_breaches
from evdash.grid.acflow import AcResult, ac_flow
from evdash.grid.lindistflow import voltage_pu
from evdash.grid.radial import radial_feeder
from evdash.metrics.breaches import charger_breaches, in_force_only
from evdash.metrics.records import executed_station_kw
from evdash.metrics.service import Totals, totals
from evdash.metrics.verdict import FULL_AC, LINEARISED, ModelVerdict, verdict_of

PACKAGES = ("highspy", "pulp", "numpy", "scipy", "pandapower", "pydantic")


@dataclass(frozen=True, slots=True)
class RunLabel:
    """What a run was made with. `seed` is None where the scenario has none."""

    policy: str
    network: Network
    seed: int | None
    wall_seconds: float


@dataclass(frozen=True, slots=True)
class Verdict:
    """A whole day held against its limits, in the linearised model and in AC.

    `linear` and `ac` list every limit exceeded, by the station or by the feeder itself, and in
    both intervals with more vehicles charging than chargers; `base` is `flow` without the
    station; `voltage_pu` (intervals, nodes) is the linearised voltage under the executed
    schedule.
    """

    linear: tuple[Breach, ...]
    ac: tuple[Breach, ...]
    flow: AcResult
    base: AcResult
    voltage_pu: np.ndarray

    def broken_by_station(self, network: Network) -> tuple[Breach, ...]:
        """Limits the station worsened in the network model whose limits were to be kept."""
        breaches = self.ac if network == "ac" else self.linear
        return tuple(breach for breach in breaches if breach.by_station)

    @property
    def models(self) -> tuple[ModelVerdict, ModelVerdict]:
        """What either network model says of the day, to be told."""
        intervals = len(self.flow.voltage_pu)
        return (
            verdict_of(LINEARISED, self.linear, intervals),
            verdict_of(FULL_AC, self.ac, intervals),
        )

    @property
    def worst_voltage_error_pu(self) -> float | None:
        """Largest difference between linearised and AC voltage; None without an AC solution."""
        error = np.abs(self.voltage_pu - self.flow.voltage_pu)
        return None if np.isnan(error).all() else float(np.nanmax(error))


def judge(
    trace: Trace, linear: Sequence[Breach], on_flow: Callable[[], None] | None = None
) -> Verdict:
    """Hold the executed schedule of a finished day against AC power flow.

    `linear` is what the independent checker found in the linearised model; `on_flow` is called
    before each power flow, two for every interval.
    """
    scenario = trace.scenario
    station_kw = executed_station_kw(trace)
    executed = ac_flow(scenario, station_kw, on_flow)
    base = ac_flow(scenario, np.zeros(len(station_kw)), on_flow)
    ac = in_force_only(trace, lambda scenario: ac_breaches(scenario, executed, base))
    chargers = charger_breaches(trace)
    return Verdict(
        linear=(*linear, *chargers),
        ac=(*ac, *chargers),
        flow=executed,
        base=base,
        voltage_pu=voltage_pu(scenario, radial_feeder(scenario), station_kw),
    )


def run_files(trace: Trace, verdict: Verdict, label: RunLabel) -> dict[str, str]:
    """Every file of a run folder, path to text."""
    scenario = scenario_files(resolved(trace.inputs.given, trace.inputs.arrivals))
    digest = scenario_hash({name: text.encode() for name, text in scenario.items()})
    summary = summary_of(totals(trace), verdict, label) | {
        "scenario": trace.scenario.name,
        "scenario_sha256": digest,
        "intervals": trace.scenario.intervals,
        "optimal_intervals": sum(s.plan.report.status == "optimal" for s in trace.steps),
        "fallback_intervals": sum(s.plan.report.status == "fallback" for s in trace.steps),
    }
    return {
        "intervals.csv": table_text(IntervalRow, interval_rows(trace)),
        "vehicles.csv": table_text(VehicleRow, vehicle_rows(trace)),
        "ledger.csv": table_text(LedgerRow, ledger_rows(trace)),
        "power.csv": table_text(PowerRow, power_rows(trace)),
        "voltages.csv": table_text(VoltageRow, voltage_rows(verdict)),
        SUMMARY: json.dumps(summary, indent=2, ensure_ascii=False) + "\n",
    } | {f"{SCENARIO}/{name}": text for name, text in scenario.items()}


def voltage_rows(verdict: Verdict) -> list[VoltageRow]:
    """`voltages.csv`: every node but the source, linearised and AC."""
    ac = verdict.flow.voltage_pu
    return [
        VoltageRow.model_construct(
            interval=t,
            node=node,
            voltage_pu=float(verdict.voltage_pu[t, i]),
            voltage_ac_pu=None if np.isnan(ac[t, i]) else float(ac[t, i]),
        )
        for t in range(len(ac))
        for i, node in enumerate(verdict.flow.nodes)
    ]


def summary_of(day: Totals, verdict: Verdict, label: RunLabel) -> dict[str, object]:
    """The totals, verdicts and circumstances of a run."""
    return {
        "format": RUN_FORMAT,
        **asdict(day),
        "profit": day.profit,
        "limits_broken_by_station": _told(b for b in verdict.linear if b.by_station),
        "limits_broken_by_feeder": _told(b for b in verdict.linear if not b.by_station),
        "ac_limits_broken_by_station": _told(b for b in verdict.ac if b.by_station),
        "ac_limits_broken_by_feeder": _told(b for b in verdict.ac if not b.by_station),
        "ac_without_solution": list(verdict.flow.diverged),
        "worst_voltage_error_pu": verdict.worst_voltage_error_pu,
        "policy": label.policy,
        "network": label.network,
        "seed": label.seed,
        "wall_seconds": label.wall_seconds,
        "versions": versions(),
    }


def versions() -> dict[str, str]:
    """Versions of evdash, Python and what the numbers come from."""
    found = {"evdash": __version__, "python": platform.python_version()}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found


def _told(breaches: Iterable[Breach]) -> list[Mapping[str, object]]:
    return [
        {"interval": b.interval, "element": str(b.element), "depth": b.depth, "unit": b.unit}
        for b in breaches
    ]
