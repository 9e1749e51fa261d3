"""`audit --optimum`: P1 proven anew from a run's files alone; and days nobody tuned anything to."""

import csv
from pathlib import Path

import pytest

from benchmarks.audited import audited
from evdash.audit.audit import audit_run
from tests.cli.test_audit import change


def shifted(usd: float, *columns: str):
    """Objective and bound of an interval with newcomers moved together: nothing else says so."""

    def edit(rows):
        row = max(rows, key=lambda row: int(row["admitted"]))
        for column in columns:
            row[column] = repr(float(row[column]) + usd)

    return edit


def test_every_interval_is_proven_anew(small_run, command):
    status, out, told = command("audit", small_run, "--optimum")
    assert status == 0
    assert "P1's optimum proven anew, to the cent, in 4 of 4 intervals" in out
    assert "Traceback" not in told


@pytest.mark.parametrize("usd", [-0.05, 0.05])
def test_what_neighbours_cannot_tell_the_optimum_does(run_copy, command, usd):
    change(run_copy / "intervals.csv", shifted(usd, "objective", "bound"))
    before = audit_run(run_copy).findings
    status, out, _ = command("audit", run_copy, "--optimum")
    assert status == 3
    assert f"{1 + len(before)} findings" in out or f"{2 + len(before)} findings" in out
    assert ("no plan costs under" if usd < 0 else "yet a plan costs") in out


def test_a_policy_without_p1_has_nothing_to_prove(small_scenario, command, tmp_path):
    command("run", small_scenario, "--policy", "edf", "--out", tmp_path / "run")
    status, out, _ = command("audit", tmp_path / "run", "--optimum")
    assert status == 0
    assert "the policy does not solve P1" in out


def test_the_tables_need_not_be_whole_to_be_asked(run_copy, command):
    change(run_copy / "intervals.csv", lambda rows: rows[:-1])
    assert command("audit", run_copy, "--optimum")[0] == 3


def test_what_was_not_worked_out_is_said(small_run, command):
    said = " ".join(command("audit", small_run)[1].split())
    assert (
        "held within what the other files allow, not worked out: intervals.csv: objective" in said
    )
    assert "taken on trust: intervals.csv: solve_seconds; summary.json: wall_seconds" in said


@pytest.mark.parametrize(
    ("network", "seed"), [("lindistflow", 3), ("lindistflow", 23), ("ac", 301), ("ac", 310)]
)
def test_nothing_is_found_in_files_that_are_true(network, seed):
    result = audited(network, seed)
    assert not result.findings
    assert result.proven + result.untold == result.intervals


def test_promised_energy_that_only_rounding_changed_has_no_cause(tmp_path: Path):
    """Seed 23: an ask granted nothing moved a promise by 4e-15 kWh, seven intervals before its
    driver gave a part of it up; the ledger dated that from the ask."""
    from benchmarks.audited import day_with_events, write

    write(tmp_path, day_with_events(23, "lindistflow"))
    with (tmp_path / "ledger.csv").open(newline="", encoding="utf-8") as file:
        rows = {row["vehicle"]: row for row in csv.DictReader(file)}
    assert rows["PEV-011"]["since_interval"] == "64"
    assert rows["PEV-011"]["cause"] == "PEV-011 is late"
