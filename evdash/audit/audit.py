"""The whole audit of a run folder."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from evdash.audit.contracts import contract_findings
from evdash.audit.events import chargers_at, rated_spans
from evdash.audit.explained import explained_findings
from evdash.audit.ledger import ledger_findings
from evdash.audit.moments import moments
from evdash.audit.objective import objective_findings
from evdash.audit.reasons import reason_findings
from evdash.audit.record import RunRecord, read_record
from evdash.audit.station import limit_findings, station_findings, voltage_findings
from evdash.audit.summary import summary_findings, voltage_error_pu
from evdash.checker.feeder import FeederCheck
from evdash.domain.breach import Breach
from evdash.domain.elements import CHARGERS
from evdash.domain.limits import Floats
from evdash.domain.scenario import Scenario
from evdash.grid.acbreaches import TOLERANCE_KVA, TOLERANCE_PU, ac_breaches
from evdash.grid.acflow import AcResult, ac_flow

FORGIVEN = 1.01
"""A hair more than what counts as equal: two power flows differ in their last digits."""


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
    linear = _linear_breaches(run, run.station_kw)
    ac = _rated(run, lambda scenario: ac_breaches(scenario, flow, base))
    day = moments(run)
    findings = [
        *contract_findings(run),
        *reason_findings(run, day),
        *ledger_findings(run),
        *station_findings(run),
    ]
    if [row.interval for row in run.intervals] == list(range(run.scenario.intervals)):
        findings += objective_findings(run, day)
        if run.network == "ac":
            judged, strictly = partial(_ac_breaches, run, base), partial(_ac_reached, run, base)
            findings += limit_findings(run, judged, strictly)
        else:
            judged = partial(_linear_breaches, run)
            findings += limit_findings(run, judged, judged)
    findings += voltage_findings(run, check, flow)
    chargers = _charger_breaches(run)
    findings += summary_findings(
        run, (*linear, *chargers), (*ac, *chargers), flow, voltage_error_pu(run)
    )
    findings += explained_findings(run)
    return Audit(
        run=run,
        findings=tuple(findings),
        ac=ac,
        feeder_own=tuple(breach for breach in linear if not breach.by_station),
        flow=flow,
    )


def _charger_breaches(run: RunRecord) -> tuple[Breach, ...]:
    """Intervals with more vehicles charging than chargers that work."""
    powers = np.array(list(run.power_kw.values())).reshape(-1, run.scenario.intervals)
    over = [
        (t, int(count) - chargers_at(run.scenario, t))
        for t, count in enumerate((powers > 0).sum(axis=0))
    ]
    return tuple(
        Breach(t, CHARGERS, float(more), 0.0, "vehicles", 0.0) for t, more in over if more > 0
    )


def _ac_breaches(run: RunRecord, base: AcResult, station_kw: Floats) -> tuple[Breach, ...]:
    flow = ac_flow(run.scenario, station_kw)
    return _rated(run, lambda scenario: ac_breaches(scenario, flow, base))


def _ac_reached(run: RunRecord, base: AcResult, station_kw: Floats) -> tuple[Breach, ...]:
    """As `_ac_breaches`, of limits that are tighter by what these forgive."""
    flow = ac_flow(run.scenario, station_kw)
    return _rated(run, lambda scenario: ac_breaches(_tightened(scenario), flow, base))


def _tightened(scenario: Scenario) -> Scenario:
    limits = scenario.feeder.model_copy(
        update={"voltage_min_pu": scenario.feeder.voltage_min_pu + FORGIVEN * TOLERANCE_PU}
    )
    nodes, lines = (
        tuple(
            one
            if one.rating_kva is None
            else one.model_copy(update={"rating_kva": one.rating_kva - FORGIVEN * TOLERANCE_KVA})
            for one in rated
        )
        for rated in (scenario.nodes, scenario.lines)
    )
    return scenario.replacing(feeder=limits, nodes=nodes, lines=lines)


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
