"""A finished day with all that is told of it, worked out once for everything handed on."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from evdash.domain.arrivals import RecordedArrivals
from evdash.domain.outlook import Outlook
from evdash.domain.scenario import Line, Scenario
from evdash.domain.trace import Trace
from evdash.errors import Fault, InputError
from evdash.files.differences import Difference, scenario_differences
from evdash.files.run_export import RunLabel, Verdict, judge, run_files, versions
from evdash.files.run_folder import SUMMARY
from evdash.grid.acflow import AcResult
from evdash.grid.radial import radial_feeder
from evdash.metrics.ageing import Ageing, Thermal, ageing
from evdash.metrics.breaches import linear_breaches
from evdash.metrics.outlook import outlook
from evdash.metrics.service import Totals, totals


@dataclass(frozen=True, slots=True)
class Aged:
    """The station's transformer, its assumed thermal data, and its ageing with and without it.

    `name` is the line's, as in `lines.csv`.
    """

    name: str
    rating_kva: float
    thermal: Thermal
    without_station: Ageing
    with_station: Ageing


@dataclass(frozen=True, slots=True)
class Account:
    """A finished day: its trace, totals, verdict in both network models, and what it was made with.

    `files` is the run's folder as `--out` writes it, path to text. `aged` is None where no
    transformer is known or AC has no solution. `worths` are sentences.
    """

    trace: Trace
    label: RunLabel
    verdict: Verdict
    totals: Totals
    outlook: Outlook
    files: dict[str, str]
    aged: Aged | None
    worths: tuple[str, ...] = ()

    @property
    def scenario(self) -> Scenario:
        return self.trace.scenario

    @property
    def scenario_sha256(self) -> str:
        """What the resolved scenario's files are told from others by."""
        return str(json.loads(self.files[SUMMARY])["scenario_sha256"])

    @property
    def versions(self) -> dict[str, str]:
        """Versions of evdash and what its numbers come from."""
        return versions()


def flows_needed(trace: Trace) -> int:
    """How many AC power flows a verdict takes: what its `on_flow` will count up to."""
    return 2 * len(trace.steps)


def verdict_on(trace: Trace, on_flow: Callable[[], None] | None = None) -> Verdict:
    """A finished day held against its limits; `on_flow` is called before each AC power flow.

    The long part of an account. Raises InputError for a day that is not over.
    """
    if not trace.is_over:
        found = f"{trace.now} of {trace.scenario.intervals} intervals decided"
        raise InputError([Fault("the run", found, "should be over: run it to its end")])
    return judge(trace, linear_breaches(trace), on_flow)


def account(
    trace: Trace,
    verdict: Verdict,
    label: RunLabel,
    *,
    thermal: Thermal | None = None,
    transformer: str = "",
    worths: tuple[str, ...] = (),
) -> Account:
    """Account for a finished day and the verdict on it.

    `transformer` names the line that is the station's transformer, by default the rated one
    nearest to it. Raises InputError for a line that is none.
    """
    line = transformer_of(trace.scenario, transformer)
    return Account(
        trace=trace,
        label=label,
        verdict=verdict,
        totals=totals(trace),
        outlook=outlook(trace),
        files=run_files(trace, verdict, label),
        aged=None if line is None else _aged(trace.scenario, line, verdict, thermal or Thermal()),
        worths=worths,
    )


def edited(trace: Trace) -> dict[str, list[Difference]]:
    """What was set otherwise before it was changed on the way, by the clock time of the change.

    Events tell what happened; settings changed by hand, of which no event can tell, do not stand
    in a run's files: they hold what was in force last.
    """
    told: dict[str, list[Difference]] = {}
    for step, following in pairwise(trace.steps):
        before, after = step.inputs, following.inputs
        if before.given is after.given and before.network == after.network:
            continue
        found = scenario_differences(_settings_of(before.given), _settings_of(after.given))
        if before.network != after.network:
            found.append(Difference("network model", before.network, after.network))
        if found:
            told[f"{following.start:%H:%M}"] = found
    return told


def _settings_of(given: Scenario) -> Scenario:
    """A scenario without what a run's files can tell even where it changes on the way."""
    return given.replacing(events=(), arrivals=RecordedArrivals())


def transformers(scenario: Scenario) -> dict[str, Line]:
    """Lines with a rating, any of which may be a transformer, the one nearest the station first.

    By the name that files give them.
    """
    nearest = radial_feeder(scenario).nearest_rated_line(scenario.station.node)
    rated = [line for line in scenario.lines if line.rating_kva]
    if nearest is not None:
        rated.sort(key=lambda line: line is not scenario.lines[nearest])
    return {scenario.file_name(line.element).removeprefix("line:"): line for line in rated}


def transformer_of(scenario: Scenario, name: str = "") -> Line | None:
    """The line that stands for the station's transformer; None if there is no rated one."""
    names = transformers(scenario)
    if name and name not in names:
        allowed = f"should be a line with a rating: {', '.join(names) or 'there is none'}"
        raise InputError([Fault("the transformer", repr(name), allowed)])
    return names[name] if name else next(iter(names.values()), None)


def _aged(scenario: Scenario, line: Line, verdict: Verdict, thermal: Thermal) -> Aged | None:
    row = scenario.lines.index(line)
    rating_kva = line.rating_kva or 0.0

    def under(flow: AcResult) -> Ageing | None:
        load_kva = flow.line_kva[:, row]
        if not np.isfinite(load_kva).all():
            return None
        return ageing(load_kva, rating_kva, scenario.interval_hours, thermal)

    without, with_it = under(verdict.base), under(verdict.flow)
    if without is None or with_it is None:
        return None
    return Aged(line.name, rating_kva, thermal, without, with_it)
