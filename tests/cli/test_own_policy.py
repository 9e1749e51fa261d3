"""A policy of one's own on the command line: run, audited without it, raced, studied."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import pytest

from evdash.policies.registry import RULES
from tests.studies.small import STUDY, write_study

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "docs" / "cheapest_hours.py"
MINE = "cheapest_hours:policy"
FAILING = '''
def policy(snapshot):
    """Right until 2 o'clock, and never again."""
    if snapshot.now >= 2:
        raise ValueError("lost")
    return {}
'''


@pytest.fixture
def own(tmp_path, monkeypatch):
    """A folder of one's own, in which one is, with the documented example and one that fails."""
    (tmp_path / EXAMPLE.name).write_bytes(EXAMPLE.read_bytes())
    (tmp_path / "evdash_failing.py").write_text(FAILING, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [place for place in sys.path if place])
    yield tmp_path
    for name in ("cheapest_hours", "evdash_failing"):
        sys.modules.pop(name, None)


def test_the_documented_example_is_the_file_the_suite_runs():
    page = (ROOT / "docs" / "policies.md").read_text(encoding="utf-8")
    code = EXAMPLE.read_text(encoding="utf-8")
    assert f"```python\n{code}```\n" in page
    assert len(code.splitlines()) <= 36


def test_it_runs_and_its_run_is_audited_where_it_is_not(own, command):
    status, out, _ = command("run", "--policy", MINE, "--out", "run")
    assert status == 0
    assert f"policy {MINE}" in out
    summary = json.loads((own / "run" / "summary.json").read_text(encoding="utf-8"))
    assert (summary["policy"], summary["broken"]) == (MINE, 0)
    assert summary["admitted"] > 0
    alone = [sys.executable, "-m", "evdash", "audit", str(own / "run")]
    told = subprocess.run(alone, cwd=ROOT, capture_output=True, encoding="utf-8", check=False)
    assert told.returncode == 0, told.stdout
    assert "ok Summer weekday" in told.stdout
    status, _, err = command("export", "run", "--report", "report.html")
    assert status == 2
    assert "one of your own counts where it is installed, or named on the command line" in err
    assert command("export", "run/scenario", "--policy", MINE, "--report", "report.html")[0] == 0
    report = (own / "report.html").read_text(encoding="utf-8")
    assert f"Decided by {MINE}. A policy from outside" in report


def test_where_it_fails_the_last_plan_is_kept_and_the_fault_told(own, command):
    quiet = ("--set", "arrivals.vehicles_per_day=20")
    status, out, _ = command("run", *quiet, "--policy", "evdash_failing:policy", "--out", "run")
    assert status == 0
    fault = "evdash_failing:policy: it raised ValueError: lost"
    assert f"02:00 the last plan was kept: {fault}" in out
    assert "01:00 the last plan was kept" not in out
    assert "and in 17 more intervals" in out
    with (own / "run" / "vehicles.csv").open(encoding="utf-8") as file:
        reasons = {row["reason"] for row in csv.DictReader(file)}
    assert any(reason.endswith(f"the last one was kept: {fault}") for reason in reasons)
    assert command("audit", "run")[0] == 0


def test_a_run_cannot_claim_another_policy_than_its_own_unseen(own, command):
    command("run", "--set", "arrivals.vehicles_per_day=20", "--policy", MINE, "--out", "run")
    file = own / "run" / "summary.json"
    summary = json.loads(file.read_text(encoding="utf-8"))
    for name in ("p1", "edf", "", "mine", "a:b:c"):
        file.write_text(json.dumps({**summary, "policy": name}), encoding="utf-8")
        assert command("audit", "run")[0] == 3, name


def test_it_races_ours(own, command):
    names = ["p1", MINE, "evdash_failing:policy"]
    quiet = ("--set", "arrivals.vehicles_per_day=40")
    status, out, _ = command("race", *quiet, "--policies", *names, "--out", "race")
    assert status == 0
    assert f"{MINE}, a policy from outside, earned $" in out
    assert "in place of that of evdash_failing:policy; first at " in out
    with (own / "race" / "policies.csv").open(encoding="utf-8") as file:
        rows = {row["policy"]: row for row in csv.DictReader(file)}
    assert list(rows) == names
    assert float(rows[MINE]["profit"]) > 0
    assert float(rows["evdash_failing:policy"]["profit"]) == 0


def test_it_decides_a_study_where_it_is_given_by_hand_alone(own, command, monkeypatch):
    study = write_study(own, STUDY.format(count=1))
    monkeypatch.chdir(ROOT)  # workers that live on know no folder but this
    earlier = ["study", study, "--out", own / "earlier", "--workers", "2"]
    assert command(*earlier)[0] == 0
    monkeypatch.chdir(own)
    plan = ["study", study, "--out", "out", "--workers", "2"]
    status, _, err = command(*plan, "--policies", "edf", MINE)
    assert status == 0, err
    with (own / "out" / "runs.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert {(row["policy"], row["status"]) for row in rows} == {("edf", "done"), (MINE, "done")}
    # its folder names it now, and that is not enough
    resume = ["study", "out/study.toml", "--out", "out", "--workers", "1"]
    status, _, err = command(*resume)
    assert status == 2
    assert "policies: found 'cheapest_hours:policy'" in err
    assert "or named on the command line" in err
    status, out, _ = command(*resume, "--policies", "edf", MINE)
    assert status == 0
    assert "still to come" not in out


@pytest.mark.parametrize("form", [["run", "--policy"], ["race", "--policies"]])
def test_a_name_there_is_none_of_is_told_with_those_there_are(form, command):
    status, _, err = command(*form, "wishful")
    assert status == 2
    assert "found 'wishful'; should be one of" in err
    assert all(name in err for name in RULES)
    assert "module:function, one of your own" in err
