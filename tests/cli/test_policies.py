"""`run --policy`: every policy's run stands up to the audit, and only one breaks limits."""

import csv
import json

import pytest

from evdash.policies.registry import RULES

CALM = ("--set", "arrivals.vehicles_per_day=40")
BROKEN = 3


@pytest.mark.parametrize("name", [name for name in RULES if name != "uncoordinated"])
def test_a_policy_within_the_limits_passes_the_audit(name, tmp_path, command):
    status, _, _ = command("run", "--policy", name, *CALM, "--out", str(tmp_path / "run"))
    assert status == 0
    assert command("audit", str(tmp_path / "run"))[0] == 0
    summary = json.loads((tmp_path / "run" / "summary.json").read_text(encoding="utf-8"))
    assert (summary["policy"], summary["admitted"] > 0) == (name, True)
    with (tmp_path / "run" / "intervals.csv").open(encoding="utf-8") as file:
        objectives = {row["objective"] != "" for row in csv.DictReader(file)}
    assert objectives == {name in {"p1", "p1-plain"}}


def test_without_coordination_limits_are_broken_and_told(tmp_path, command):
    status, out, _ = command("run", "--policy", "uncoordinated", "--out", str(tmp_path / "run"))
    assert status == BROKEN
    assert "chargers: " in out
    assert "line:633-634" in out
    status, out, _ = command("audit", str(tmp_path / "run"))
    assert status == BROKEN
    assert "22 vehicles charge, 12 can" in out


def test_only_the_papers_policy_is_explained(command):
    status, _, err = command("run", "--policy", "edf", "--explain")
    assert status == 2
    assert "--explain: found --policy edf" in err


def test_anticipating_needs_statistics_of_arrivals(tmp_path, command):
    command("run", *CALM, "--out", str(tmp_path / "run"))
    folder = tmp_path / "run" / "scenario"
    toml = (folder / "scenario.toml").read_text(encoding="utf-8")
    start = toml.index("[arrivals.forecast]")
    after = toml.find("\n[", start + 1)
    without = toml[:start] + (toml[after:] if after > 0 else "")
    (folder / "scenario.toml").write_text(without, encoding="utf-8")
    (folder / "fleet.csv").unlink(missing_ok=True)
    status, _, err = command("run", str(folder), "--policy", "bid-price")
    assert status == 2
    assert "arrivals.forecast" in err


def test_a_run_that_samples_futures_can_be_run_again(tmp_path, command):
    """Its resolved scenario keeps the seed, and the statistics as the forecast."""
    first, again = tmp_path / "first", tmp_path / "again"
    command("run", "--policy", "bid-price", *CALM, "--out", str(first))
    command("run", str(first / "scenario"), "--policy", "bid-price", "--out", str(again))
    assert (first / "power.csv").read_bytes() == (again / "power.csv").read_bytes()
