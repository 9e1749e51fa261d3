"""`--network ac`: limits kept in full AC power flow, and told where only the linear ones were."""

import csv
import json
from pathlib import Path

import pytest

from evdash.files.bundled import PRESETS
from tests.cli.test_audit import change, scaled


def headroom_kw(run: Path) -> list[float]:
    with (run / "intervals.csv").open(newline="", encoding="utf-8") as file:
        return [float(row["headroom_kw"]) for row in csv.DictReader(file)]


def summary(run: Path) -> dict[str, object]:
    return json.loads((run / "summary.json").read_text(encoding="utf-8"))


@pytest.fixture
def ac_run(small_scenario, tmp_path, command):
    directory = tmp_path / "ac"
    assert command("run", small_scenario, "--network", "ac", "--out", directory)[0] == 0
    return directory


def test_an_ac_run_is_labelled_and_passes_its_audit(ac_run, small_run, command):
    assert summary(ac_run)["network"] == "ac"
    assert summary(small_run)["network"] == "lindistflow"
    # losses in the line leave less for the station
    assert max(headroom_kw(ac_run)) < min(headroom_kw(small_run))
    assert command("audit", ac_run)[0] == 0


@pytest.mark.parametrize(("factor", "told"), [(1.3, "before the headroom"), (0.5, "does not bind")])
def test_a_false_ac_headroom_is_found(ac_run, command, factor, told):
    change(ac_run / "intervals.csv", scaled("headroom_kw", factor))
    status, out, _ = command("audit", ac_run)
    assert status == 3
    assert told in out


def test_ac_violations_of_a_linear_run_are_loud_but_no_failure(tmp_path, command):
    preset = PRESETS / "voltage-limited"
    status, out, _ = command("run", preset, "--out", tmp_path / "linear")
    assert status == 0
    assert (
        "By AC power flow, charging exceeds 8 limits: the lowest voltage allowed at node 652" in out
    )
    assert summary(tmp_path / "linear")["ac_limits_broken_by_station"]
    status, out, _ = command("run", preset, "--network", "ac", "--out", tmp_path / "ac")
    assert status == 0
    assert "charging exceeds" not in out
    assert "By AC power flow, the feeder by itself exceeds 8 limits" in out
    assert summary(tmp_path / "ac")["ac_limits_broken_by_station"] == []


def test_a_linear_run_passed_off_as_ac_is_found(tmp_path, command):
    run = tmp_path / "run"
    assert command("run", PRESETS / "voltage-limited", "--out", run)[0] == 0
    told = summary(run) | {"network": "ac"}
    (run / "summary.json").write_text(json.dumps(told), encoding="utf-8")
    status, out, _ = command("audit", run)
    assert status == 3
    assert "voltage_min:652 exceeded" in out


def test_an_unknown_network_ends_with_status_two(ac_run, command):
    told = summary(ac_run) | {"network": "dc"}
    (ac_run / "summary.json").write_text(json.dumps(told), encoding="utf-8")
    status, _, printed = command("audit", ac_run)
    assert status == 2
    assert "network" in printed
