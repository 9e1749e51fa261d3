"""The whole audit of a run folder."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from evdash.audit.contracts import contract_findings
from evdash.audit.events import rated_spans
from evdash.audit.ledger import ledger_findings
from evdash.audit.record import RunRecord, read_record
from evdash.audit.station import (
    limit_findings,
    station_findings,
    summary_findings,
    voltage_findings,
)
from evdash.checker.feeder import FeederCheck
from evdash.domain.breach import Breach
from evdash.domain.limits import Floats
from evdash.domain.scenario import Scenario
from evdash.grid.acbreaches import ac_breaches
from evdash.grid.acflow import AcResult, ac_flow

LINEAR_STEP_KW = 0.01
AC_STEP_KW = 5.0
"""How far beyond a headroom its limit must show as exceeded, above each model's tolerance."""


@dataclass(frozen=True, slots=True)
class Audit:
    """What came of an audit: `findings` are what is wrong; the rest is for information."""

    run: RunRecord
    findings: tuple[str, ...]
    ac: tuple[Breach, ...]
    feeder_own: tuple[Breach, ...]
    flow: AcResult


def audit_run(directory: Path) -> Audit:
    """Check a run folder by other means; raises InputError if its files cannot be read."""
    run = read_record(directory)
    check = FeederCheck(run.scenario)
    flow = ac_flow(run.scenario, run.station_kw)
    base = ac_flow(run.scenario, np.zeros(run.scenario.intervals))
    findings = [
        *contract_findings(run),
        *ledger_findings(run),
        *station_findings(run),
        *summary_findings(run),
    ]
    if len(run.intervals) == run.scenario.intervals:
        if run.network == "ac":
            findings += limit_findings(run, partial(_ac_breaches, run, base), AC_STEP_KW)
        else:
            findings += limit_findings(run, partial(_linear_breaches, run), LINEAR_STEP_KW)
    findings += voltage_findings(run, check, flow)
    return Audit(
        run=run,
        findings=tuple(findings),
        ac=_rated(run, lambda scenario: ac_breaches(scenario, flow, base)),
        feeder_own=tuple(b for b in _linear_breaches(run, run.station_kw) if not b.by_station),
        flow=flow,
    )


def _ac_breaches(run: RunRecord, base: AcResult, station_kw: Floats) -> tuple[Breach, ...]:
    flow = ac_flow(run.scenario, station_kw)
    return _rated(run, lambda scenario: ac_breaches(scenario, flow, base))


def _linear_breaches(run: RunRecord, station_kw: Floats) -> tuple[Breach, ...]:
    return _rated(run, lambda scenario: FeederCheck(scenario).breaches(station_kw))


def _rated(run: RunRecord, breaches: Callable[[Scenario], Sequence[Breach]]) -> tuple[Breach, ...]:
    """Breaches of every interval, under the ratings in force in it."""
    return tuple(
        breach
        for scenario, span in rated_spans(run.scenario)
        for breach in breaches(scenario)
        if breach.interval in span
    )
