"""An export that charging relieves allows no import: from run and audit to race and report."""

import csv
import json
from pathlib import Path

import pytest

from evdash.audit.audit import audit_run
from evdash.cli.main import main
from evdash.domain.scenario import Scenario
from evdash.files.run_export import RunLabel
from evdash.files.run_folder import SUMMARY
from evdash.files.scenario_folder import scenario_files
from evdash.grid.aclimits import AcFeeder, ac_limit_rows
from evdash.grid.acmany import ManyDays
from evdash.horizon.day import run_day, start_day
from evdash.horizon.inputs import prepare
from evdash.metrics.records import executed_station_kw
from evdash.policies.race import race
from evdash.policies.registry import RULES
from evdash.reports.account import account, verdict_on
from evdash.reports.tables import violation_rows
from evdash.reports.words import CAUSES
from evdash.studies.measures import Day
from tests.builders import line, make_scenario, names, node, vehicle
from tests.grid.sides_referee import SHORT, WIDE, exporting


def write(scenario: Scenario, place: Path) -> None:
    place.mkdir()
    for name, text in scenario_files(scenario).items():
        (place / name).write_text(text, encoding="utf-8", newline="")


@pytest.mark.parametrize("rated", ["node", "line"])
@pytest.mark.parametrize("policy", ["p1", "uncoordinated"])
def test_the_command_line_says_so_from_run_to_audit(
    rated: str, policy: str, tmp_path, capsys
) -> None:
    place = tmp_path / "scenario"
    write(exporting(rated), place)
    out = tmp_path / "run"
    told = ["run", str(place), "--network", "ac", "--policy", policy, "--out", str(out)]
    assert main(told) == (0 if policy == "p1" else 3)
    capsys.readouterr()
    with (out / "intervals.csv").open(encoding="utf-8") as file:
        most_kw = max(float(row["station_kw"]) for row in csv.DictReader(file))
    assert most_kw == pytest.approx(1050 if policy == "p1" else 1800, rel=1e-4)
    found = audit_run(out)
    if policy == "p1":
        assert found.findings == ()
        assert main(["audit", str(out)]) == 0
    else:
        assert any(f"{rated}:" in finding for finding in found.findings)
        assert main(["audit", str(out)]) == 3


@pytest.mark.parametrize("rated", ["node", "line"])
@pytest.mark.parametrize("policy", ["p1", "uncoordinated"])
def test_race_study_report_and_file_agree_on_who_exceeds_which_side(
    rated: str, policy: str
) -> None:
    scenario = exporting(rated)
    inputs, rule = prepare(scenario, "ac"), RULES[policy]
    trace = run_day(start_day(scenario, "ac"), rule.make(inputs), decide=rule.decide)
    (lap,) = race(inputs, [policy]).laps
    study = Day(trace, ManyDays(scenario), referee=False)
    verdict = verdict_on(trace)
    told = account(trace, verdict, RunLabel(policy, "ac", None, 1.0))
    summary = json.loads(told.files[SUMMARY])
    rows = [row for row in violation_rows(told) if row["Model"] == "AC"]

    element = "node:a" if rated == "node" else "line:s-a"
    over = [t for t, kw in enumerate(executed_station_kw(trace)) if kw > 1051]
    assert bool(over) == (policy == "uncoordinated")
    by_feeder = [one["element"] for one in summary["ac_limits_broken_by_feeder"]]
    assert [b.interval for b in verdict.broken_by_station("ac")] == over
    assert {str(b.element) for b in verdict.broken_by_station("ac")} <= {element}
    assert {one["element"] for one in summary["ac_limits_broken_by_station"]} <= {element}
    assert set(by_feeder) <= {f"{element}:export"}
    assert lap.limits_broken == study.broken == len(over)
    for service in (lap.service, study.service):
        assert service.ac_overload_intervals == len(over)
    assert sum(row["Cause"] == CAUSES["station"] for row in rows) == bool(over)
    assert sum(row["Cause"] == CAUSES["both"] for row in rows) == 0
    binding = {row["binding"] for row in csv.DictReader(told.files["intervals.csv"].splitlines())}
    assert binding == {element}


def test_an_export_that_charging_worsens_binds_by_the_name_of_its_element(tmp_path) -> None:
    """A lower voltage makes the reactive losses of what flows back larger, and so its kVA."""
    scenario = make_scenario(
        nodes=[node("s"), node("a"), node("b", load_kw=50, load_kvar=200, generation_kw=500)],
        lines=[line("s", "a", r=0.5, x=0.5), line("a", "b", r=0.01, x=1.0, rating=400)],
        station={"node": "a", "chargers": 100, "max_kw": 20.0},
        vehicles=[vehicle(f"v{n}", 0.0, need_kwh=60.0, max_kw=20.0) for n in range(3)],
        price=[0.1] * 4,
        feeder=WIDE,
    )
    rows = ac_limit_rows(scenario)
    assert names(rows.binding()) == ("line:a-b",) * 4
    (first, *_) = found = AcFeeder(scenario).breaches(rows.headroom_kw() + 20.0)
    assert {(str(b.element), b.by_station) for b in found} == {("line:a-b:export", True)}
    assert first.base_depth > 80
    place, out = tmp_path / "scenario", tmp_path / "run"
    write(scenario, place)
    assert main(["run", str(place), "--network", "ac", "--out", str(out)]) == 0
    assert audit_run(out).findings == ()


def test_a_node_may_be_called_as_an_export_is(tmp_path) -> None:
    """The side of a breach is not read from its name."""
    name = "b:export"
    scenario = make_scenario(
        nodes=[node("s"), node(name, load_kw=50, load_kvar=0, rating_kva=100)],
        lines=[line("s", name, **SHORT)],
        station={"node": name, "chargers": 100, "max_kw": 20.0},
        vehicles=[vehicle(f"v{n}", 0.0, need_kwh=60.0, max_kw=20.0) for n in range(9)],
        price=[0.1] * 4,
        feeder=WIDE,
    )
    assert names(ac_limit_rows(scenario).binding()) == (f"node:{name}",) * 4
    place = tmp_path / "scenario"
    write(scenario, place)
    for network in ("ac", "lindistflow"):
        out = tmp_path / network
        assert main(["run", str(place), "--network", network, "--out", str(out)]) == 0
        assert audit_run(out).findings == ()
