"""One reason for one refusal, by whatever way it is told, on every bundled day for every policy."""

import csv
import io

import pytest

from evdash.domain.trace import Trace
from evdash.explain.refusals import explain_vehicle
from evdash.files.bundled import DEFAULT, bundled_scenarios
from evdash.files.race_folder import refusals_table
from evdash.files.run_export import RunLabel
from evdash.files.run_tables import VehicleRow, table_text, vehicle_rows
from evdash.files.scenario_folder import read_scenario
from evdash.files.tables import write_table
from evdash.horizon.day import begin, run_day
from evdash.horizon.inputs import prepare
from evdash.metrics.outlook import outlook
from evdash.metrics.records import refused_by_reason, vehicle_records
from evdash.metrics.service import totals
from evdash.policies.race import race
from evdash.policies.registry import RULES
from evdash.reports.account import account, verdict_on
from evdash.reports.tables import decision_rows, reason_rows
from evdash.ui.story import story
from evdash.ui.words import MOST_REASONS, decision_lines, plain

EXPLAINED = 6
PRESETS = {folder.name: folder for folder in bundled_scenarios()}
SLOW = "p1-plain"


def decided(trace: Trace) -> dict[str, str]:
    """What each step answered whom it refused; those who came too late have it at the door."""
    told = {one.vehicle: str(one.reason) for s in trace.steps for one in s.plan.refused}
    late = trace.inputs.requests[trace.scenario.intervals]
    return told | {request.vehicle: str(request.refusal) for request in late}


def agree(name: str, policy: str, most: int | None) -> Trace:
    inputs = prepare(read_scenario(PRESETS[name]), "lindistflow")
    rule = RULES[policy]
    trace = run_day(begin(inputs), rule.make(inputs), decide=rule.decide)
    told = decided(trace)
    records = vehicle_records(trace)
    assert {r.vehicle: r.why_not for r in records if r.status == "refused"} == told
    # the file, read back
    rows = csv.DictReader(io.StringIO(table_text(VehicleRow, vehicle_rows(trace))))
    assert {row["vehicle"]: row["reason"] for row in rows if row["status"] == "refused"} == told
    # the report
    whole = account(
        trace,
        verdict_on(trace),
        RunLabel(policy, "lindistflow", inputs.scenario.arrivals.seed, 1.0),
    )
    why = {row["Vehicle"]: row["Why refused"] for row in decision_rows(whole)}
    assert {vehicle: reason for vehicle, reason in why.items() if reason} == told
    groups = {clause: len(who) for clause, who in refused_by_reason(records).items()}
    assert {row["Reason"]: row["Vehicles"] for row in reason_rows(whole)} == groups
    # the screen
    ahead = outlook(trace)
    for step in trace.steps:
        said = "\n".join(decision_lines(step, ahead))
        clauses = {one.reason.clause for one in step.plan.refused}
        assert sum(plain(clause) in said for clause in clauses) >= min(len(clauses), MOST_REASONS)
    head = story(trace, ahead, totals(trace))
    assert all(f"{plain(clause)}\u00a0({count})" in head for clause, count in groups.items())
    # the race
    raced = race(inputs, [policy])
    by_race = csv.DictReader(io.StringIO(write_table(*refusals_table(raced))))
    late = {request.vehicle for request in inputs.requests[inputs.scenario.intervals]}
    early = {vehicle: reason for vehicle, reason in told.items() if vehicle not in late}
    assert {row["vehicle"]: row["reason"] for row in by_race} == early
    # the explanation
    reasons = {record.vehicle: record.reason for record in records if record.reason}
    for vehicle in list(reasons)[:: max(1, len(reasons) // most) if most else 1]:
        explained, reason = explain_vehicle(trace, vehicle), reasons[vehicle]
        assert explained.cause.reason == reason
        assert explained.detail.startswith(f"Refused because {reason.clause}")
    return trace


@pytest.mark.parametrize("name", PRESETS)
def test_every_way_tells_the_paper_s_reasons_alike(name):
    trace = agree(name, "p1", EXPLAINED)
    kinds = {record.reason.kind for record in vehicle_records(trace) if record.reason}
    assert "left out" not in kinds
    assert len(kinds) > 2


@pytest.mark.parametrize("policy", [name for name in RULES if name not in ("p1", SLOW)])
def test_every_way_tells_every_policy_s_reasons_alike(policy):
    agree(DEFAULT.name, policy, EXPLAINED)


@pytest.mark.long
@pytest.mark.parametrize("policy", RULES)
@pytest.mark.parametrize("name", PRESETS)
def test_every_way_tells_every_reason_alike(name, policy):
    agree(name, policy, None)
