"""What a study can tell of a day, each figure declared once: its unit, meaning, and where from."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from evdash.domain.breach import Breach
from evdash.domain.limits import Floats
from evdash.domain.study import Figure, Figures
from evdash.domain.trace import Trace
from evdash.grid.acbreaches import ac_breaches
from evdash.grid.acflow import AcResult
from evdash.grid.acmany import ManyDays, referee_error_pu
from evdash.metrics.ac_day import AcDay
from evdash.metrics.breaches import charger_breaches, in_force_only, linear_breaches
from evdash.metrics.declared import Figure as Declared
from evdash.metrics.declared import figures_of
from evdash.metrics.outlook import outlook
from evdash.metrics.records import executed_station_kw
from evdash.metrics.service import Service, service


class Day:
    """A day that is over, and what is worked out of it once for all figures.

    `feeder` is its feeder in AC, `referee` whether pandapower is to be asked, too.
    """

    def __init__(self, trace: Trace, feeder: ManyDays, referee: bool) -> None:
        self.trace = trace
        self.feeder = feeder
        self.referee = referee

    @cached_property
    def service(self) -> Service:
        """How well the day served, AC power flow included."""
        return service(self.trace, AcDay(self.flow, self.ac))

    @cached_property
    def station_kw(self) -> Floats:
        """Station power executed, kW, (intervals,)."""
        return executed_station_kw(self.trace)

    @cached_property
    def headroom_kw(self) -> Floats:
        """Headroom of each interval under the inputs then in force, kW, (intervals,)."""
        inputs = {id(step.inputs): step.inputs.rows.headroom_kw() for step in self.trace.steps}
        return np.array([inputs[id(step.inputs)][step.interval] for step in self.trace.steps])

    @cached_property
    def linear(self) -> tuple[Breach, ...]:
        """Limits exceeded in the linearised model, those of the chargers among them."""
        return (*linear_breaches(self.trace), *charger_breaches(self.trace))

    @cached_property
    def flow(self) -> AcResult:
        """AC power flow of what was executed."""
        return self.feeder.flow(self.station_kw)

    @cached_property
    def ac(self) -> tuple[Breach, ...]:
        """Limits exceeded in AC, each interval under the limits then in force."""
        return in_force_only(self.trace, lambda at: ac_breaches(at, self.flow, self.feeder.base))

    @property
    def broken(self) -> int:
        """Limits that charging exceeds in the network model kept, over all intervals."""
        kept = self.ac if self.trace.inputs.network == "ac" else self.linear
        return sum(breach.by_station for breach in kept)


@dataclass(frozen=True, slots=True)
class Measure:
    """A column of a study's tables; `digits` are the decimals it is told with."""

    title: str
    unit: str
    meaning: str
    digits: int
    of: Callable[[Day], Figure]

    @property
    def head(self) -> str:
        """Title and unit, as the head of a column or axis."""
        return f"{self.title}, {self.unit}" if self.unit else self.title

    def told(self, value: float | None) -> str:
        """A value as a table shows it, without its unit."""
        if value is None:
            return "–"
        shown = f"{value:,.{self.digits}f}"
        return shown.replace("-", "−") if shown.strip("-0.,") else shown.lstrip("-")


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _lowest(voltage_pu: Floats) -> float | None:
    solved = voltage_pu[np.isfinite(voltage_pu)]
    return float(solved.min()) if solved.size else None


def _tightest(day: Day) -> str:
    """What limits the station in the interval with least headroom."""
    step = day.trace.steps[int(day.headroom_kw.argmin())]
    return step.inputs.scenario.file_name(step.inputs.rows.binding()[step.interval])


def _decided(day: Day, status: str) -> int:
    return sum(step.plan.report.status == status for step in day.trace.steps)


LEFT_OUT = ("profit_of_best", "short_of_best", "solve_median_s", "solve_p95_s", "solve_worst_s")
"""Figures of a day that no study has: an oracle's, and times, which differ with every run."""


def _of_service(figure: Declared) -> Measure:
    """A figure of `Service` as a column; shares in per cent."""

    def of(day: Day) -> Figure:
        value: float | None = getattr(day.service, figure.name)
        return 100 * value if figure.is_share and value is not None else value

    return Measure(figure.label, figure.unit, figure.meaning, figure.digits, of)


MEASURES: Mapping[str, Measure] = {
    **{
        figure.name: _of_service(figure)
        for figure in figures_of(Service)
        if figure.name not in LEFT_OUT
    },
    "refused": Measure(
        "Refused",
        "vehicles",
        "Vehicles that were turned down.",
        0,
        lambda d: d.service.arrived - d.service.admitted,
    ),
    "least_headroom_kw": Measure(
        "Firm headroom",
        "kW",
        "Station power the feeder has room for at every hour, in the network model kept; blank "
        "where nothing limits.",
        1,
        lambda d: _finite(float(d.headroom_kw.min())),
    ),
    "mean_headroom_kw": Measure(
        "Mean headroom",
        "kW",
        "Station power the feeder has room for, on average over the day.",
        1,
        lambda d: _finite(float(d.headroom_kw.mean())),
    ),
    "tightest": Measure(
        "Tightest limit", "", "What limits where headroom is least, in words.", 0, _tightest
    ),
    "lowest_voltage_pu": Measure(
        "Lowest voltage",
        "pu",
        "Of any node, linearised model.",
        4,
        lambda d: _lowest(outlook(d.trace).voltage_pu),
    ),
    "lowest_ac_pu": Measure(
        "Lowest voltage in AC",
        "pu",
        "Of any node, AC power flow.",
        4,
        lambda d: _lowest(d.flow.voltage_pu),
    ),
    "limits_broken": Measure(
        "Limits broken",
        "element-intervals",
        "Limits charging exceeds in the network model kept, over all intervals.",
        0,
        lambda d: d.broken,
    ),
    "ac_limits_broken": Measure(
        "Limits broken in AC",
        "element-intervals",
        "Limits charging exceeds in AC power flow, over all intervals.",
        0,
        lambda d: sum(breach.by_station for breach in d.ac),
    ),
    "proven": Measure(
        "Proven optimal",
        "intervals",
        "Decided within a cent of the proven bound.",
        0,
        lambda d: _decided(d, "optimal"),
    ),
    "fallback": Measure(
        "Decided by the last plan",
        "intervals",
        "No new plan was found or none passed the checks.",
        0,
        lambda d: _decided(d, "fallback"),
    ),
    "referee_error_pu": Measure(
        "Difference from pandapower",
        "pu",
        "Largest difference of an AC voltage from pandapower's, on the runs it was asked for.",
        9,
        lambda d: referee_error_pu(d.trace.scenario, d.station_kw, d.flow) if d.referee else None,
    ),
}
TEXTS = ("tightest",)
"""Measures that are words, not numbers: in the table of runs, without a band."""


def figures(day: Day) -> Figures:
    """Every measure of a day."""
    return {name: measure.of(day) for name, measure in MEASURES.items()}
