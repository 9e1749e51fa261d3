"""`audit`: a true record passes, and every kind of untruth is found."""

import csv
import json
from pathlib import Path

import pytest


def change(path: Path, edit) -> None:
    """Rewrite a CSV table through `edit`, which gets and changes its rows."""
    with path.open(newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file)
        rows, header = list(reader), list(reader.fieldnames or ())
    rows = edit(rows) or rows
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, header)
        writer.writeheader()
        writer.writerows(rows)


def scaled(column: str, factor: float, row: int = 0):
    def edit(rows):
        rows[row][column] = repr(float(rows[row][column]) * factor)

    return edit


def replaced(column: str, value: str, where: str):
    def edit(rows):
        next(row for row in rows if where in row.values())[column] = value

    return edit


@pytest.mark.parametrize("run", ["bundled_run", "small_run"])
def test_a_true_record_passes(run, command, request):
    status, out, _ = command("audit", request.getfixturevalue(run))
    assert status == 0
    assert "ok" in out


@pytest.mark.parametrize(
    ("file", "edit", "told"),
    [
        ("power.csv", scaled("power_kw", 1.01), "asked for"),
        ("power.csv", scaled("power_kw", 0.9), "broken promise"),
        ("power.csv", lambda rows: rows[1:], "broken promise"),
        ("power.csv", scaled("power_kw", 40.0, 3), "above its"),
        ("vehicles.csv", scaled("need_kwh", 1.001), "need_kwh"),
        ("vehicles.csv", scaled("delivered_kwh", 0.5), "delivered_kwh"),
        ("vehicles.csv", scaled("revenue", 2.0), "revenue"),
        ("vehicles.csv", replaced("status", "charged", "refused"), "broken promise"),
        ("vehicles.csv", replaced("status", "broken", "charged"), "told to be broken"),
        ("vehicles.csv", replaced("deadline_interval", "4", "V3"), "deadline_interval"),
        ("vehicles.csv", lambda rows: rows[1:], "only one of"),
        ("intervals.csv", scaled("station_kw", 1.1, 1), "station_kw"),
        ("intervals.csv", scaled("headroom_kw", 1.1, 1), "before the headroom"),
        ("intervals.csv", scaled("headroom_kw", 0.9, 1), "does not bind"),
        ("intervals.csv", replaced("binding", "line:a-b", "line:s-a"), "does not bind"),
        ("intervals.csv", replaced("bound", "-1000", "optimal"), "above its bound"),
        ("intervals.csv", lambda rows: rows[:-1], "every interval once"),
        ("voltages.csv", scaled("voltage_pu", 1.001, 3), "voltage_pu"),
        ("voltages.csv", scaled("voltage_ac_pu", 1.001, 3), "voltage_ac_pu"),
        ("voltages.csv", lambda rows: rows[:-1], "every node"),
    ],
)
def test_untruths_are_found(run_copy, command, file, edit, told):
    change(run_copy / file, edit)
    status, out, _ = command("audit", run_copy)
    assert status == 3
    assert told in out


@pytest.mark.parametrize("total", ["arrived", "admitted", "revenue", "energy_cost", "profit"])
def test_false_totals_are_found(run_copy, command, total):
    summary = json.loads((run_copy / "summary.json").read_text(encoding="utf-8"))
    summary[total] += 1
    (run_copy / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
    status, out, _ = command("audit", run_copy)
    assert status == 3
    assert total in out


def test_another_scenario_is_found(run_copy, command):
    settings = run_copy / "scenario" / "scenario.toml"
    text = settings.read_text(encoding="utf-8").replace("chargers = 3", "chargers = 2")
    settings.write_text(text, encoding="utf-8")
    status, out, _ = command("audit", run_copy)
    assert status == 3
    assert "hash" in out
    assert "vehicles charge" in out


@pytest.mark.parametrize(
    ("file", "content"),
    [
        ("power.csv", "interval,vehicle\n0,PEV-001\n"),
        ("power.csv", "interval,vehicle,power_kw\n0,PEV-001,plenty\n"),
        ("power.csv", "interval,vehicle,power_kw\n99,PEV-001,5\n"),
        ("summary.json", "{"),
        ("summary.json", "[]"),
        ("scenario/scenario.toml", "format = 2\n"),
    ],
)
def test_unreadable_files_end_with_status_two(run_copy, command, file, content):
    (run_copy / file).write_text(content, encoding="utf-8")
    status, _, told = command("audit", run_copy)
    assert status == 2
    assert "Traceback" not in told
    assert file.split("/")[-1] in told or "PEV-001" in told


def test_a_missing_table_ends_with_status_two(run_copy, command):
    (run_copy / "voltages.csv").unlink()
    status, _, told = command("audit", run_copy)
    assert status == 2
    assert "voltages.csv" in told
