"""Runs with events: exit status, ledger, and an audit that reads the events for itself."""

import csv
import shutil
from pathlib import Path

import pytest

from evdash.cli.main import main
from tests.cli.test_audit import change, replaced, scaled

HEADER = "interval,event,subject,value,from_interval,until_interval\n"
HARMLESS = HEADER + "1,chargers_return,,1,,\n2,price_factor,,1.5,,\n3,rating,node:b,500,,\n"
BREAKING = HEADER + (
    "2,chargers_fail,,2,,\n1,price,,0.4,2,3\n2,rating,line:s-a,72,,\n2,load_factor,,0.95,,\n"
)
DRIVERS = HEADER + (
    "1,no_show,V0,,,\n1,leaves_early,V1,,,1\n1,asks_more,V2,1,,\n2,late,V3,,3,\n1,asks_more,V4,1,,\n"
)
EDGES = HEADER + (
    "0,load_factor,,1.1,,\n0,asks_more,V0,1,,\n1,rating,line:s-a,75,,\n1,chargers_fail,,1,,\n"
    "1,chargers_return,,1,,\n1,late,V1,,2,\n1,no_show,V1,,,\n2,rating,line:s-a,0,,\n"
    "3,rating,line:s-a,90,,\n3,chargers,,0,,\n3,leaves_early,V9,,,3\n"
)
"""In the first interval and the last, many in one, of vehicles without a contract."""

EARLY = HEADER + "0,no_show,V0,,,\n0,late,V1,,3,\n"


@pytest.fixture
def with_events(small_scenario: Path, tmp_path: Path):
    """A copy of the small scenario with the events given."""

    def make(text: str) -> Path:
        folder = Path(shutil.copytree(small_scenario, tmp_path / "scenario"))
        (folder / "events.csv").write_text(text, encoding="utf-8")
        return folder

    return make


@pytest.fixture(scope="module")
def broken_run(small_scenario: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run in which promises are broken; its tampered copies are audited."""
    folder = Path(shutil.copytree(small_scenario, tmp_path_factory.mktemp("events") / "scenario"))
    (folder / "events.csv").write_text(BREAKING, encoding="utf-8")
    assert main(["run", str(folder), "--out", str(folder.parent / "run")]) == 3
    return folder.parent / "run"


@pytest.fixture
def broken_copy(broken_run: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(broken_run, tmp_path / "run"))


def ledger_of(run: Path) -> dict[str, dict[str, str]]:
    with (run / "ledger.csv").open(newline="", encoding="utf-8") as file:
        return {row["vehicle"]: row for row in csv.DictReader(file)}


def test_without_events_every_promise_is_in_the_ledger_and_kept(small_run):
    rows = ledger_of(small_run)
    assert rows
    assert {row["status"] for row in rows.values()} == {"kept"}
    assert not (small_run / "scenario" / "events.csv").exists()


def test_events_that_break_nothing_end_with_status_0(with_events, command, tmp_path):
    out = tmp_path / "run"
    status, printed, _ = command("run", with_events(HARMLESS), "--out", out)
    assert status == 0
    assert "01:00 1 more of the chargers work" in printed
    assert {row["status"] for row in ledger_of(out).values()} == {"kept"}
    assert command("audit", out)[0] == 0


def test_a_broken_promise_is_told_counted_and_ends_with_status_3(with_events, command, tmp_path):
    out = tmp_path / "run"
    status, printed, _ = command("run", with_events(BREAKING), "--out", out)
    assert status == 3
    short = [row for row in ledger_of(out).values() if row["status"] == "short"]
    assert short
    assert all(row["since_interval"] == "2" and "chargers" in row["cause"] for row in short)
    assert "known since 02:00" in printed
    audited, told, _ = command("audit", out)
    assert audited == 3
    findings = [line for line in told.splitlines() if "✗" in line]
    assert len(findings) == len(short)
    assert all("a broken promise" in finding for finding in findings)


def test_what_drivers_change_breaks_no_promise(with_events, command, tmp_path):
    out = tmp_path / "run"
    status, _, _ = command("run", with_events(DRIVERS), "--out", out)
    assert status == 0
    rows = ledger_of(out)
    assert (rows["V0"]["status"], rows["V0"]["cause"]) == ("released", "V0 does not come")
    assert {row["status"] for row in rows.values()} == {"kept", "released"}
    assert command("audit", out)[0] == 0


def test_what_is_told_before_there_is_a_contract_changes_nothing(with_events, command, tmp_path):
    out = tmp_path / "run"
    assert command("run", with_events(EARLY), "--out", out)[0] == 0
    assert {row["status"] for row in ledger_of(out).values()} == {"kept"}
    status, said, _ = command("audit", out)
    assert status == 0, said


def test_a_run_with_events_is_run_again_from_its_own_files(broken_run, command, tmp_path):
    again = tmp_path / "again"
    command("run", broken_run / "scenario", "--out", again)
    for name in ("ledger.csv", "vehicles.csv", "power.csv", "voltages.csv"):
        assert (broken_run / name).read_bytes() == (again / name).read_bytes()


@pytest.mark.parametrize("network", ["lindistflow", "ac"])
def test_events_at_both_ends_and_many_at_once_are_audited_and_run_again(
    with_events, command, tmp_path, network
):
    first, again = tmp_path / "first", tmp_path / "again"
    status, _, _ = command("run", with_events(EDGES), "--network", network, "--out", first)
    short = any(row["status"] == "short" for row in ledger_of(first).values())
    assert status == (3 if short else 0)
    assert command("run", first / "scenario", "--network", network, "--out", again)[0] == status
    for name in ("ledger.csv", "vehicles.csv", "power.csv", "voltages.csv"):
        assert (first / name).read_bytes() == (again / name).read_bytes()
    audited, told, _ = command("audit", first)
    assert audited == status
    assert all("a broken promise" in line for line in told.splitlines() if "✗" in line)


@pytest.mark.parametrize(
    ("change_of", "told"),
    [
        (("ledger.csv", scaled("promised_kwh", 1.1)), "promised_kwh is"),
        (("ledger.csv", scaled("delivered_kwh", 1.1, 1)), "delivered_kwh is"),
        (("ledger.csv", scaled("revised_kwh", 0.9)), "do not make a promise of"),
        (("ledger.csv", replaced("short_kwh", "0.0", "short")), "short_kwh is 0"),
        (("ledger.csv", replaced("status", "kept", "short")), "vehicles.csv says broken"),
        (("ledger.csv", replaced("since_interval", "3", "short")), "short without an event"),
        (("ledger.csv", lambda rows: rows[1:]), "does not hold every contract once"),
        (("vehicles.csv", replaced("status", "released", "broken")), "its driver changed nothing"),
        (
            ("scenario/events.csv", replaced("value", "3", "chargers_fail")),
            "vehicles charge, 0 can",
        ),
        (("scenario/events.csv", replaced("value", "20", "line:s-a")), "line:s-a exceeded by"),
        (("scenario/events.csv", replaced("value", "0.5", "price")), "price_per_kwh is 0.4"),
        (("scenario/events.csv", replaced("value", "1.9", "load_factor")), "voltage_pu is not"),
        (("scenario/events.csv", lambda rows: rows[1:]), "its hash differs"),
    ],
)
def test_every_untruth_is_found(broken_copy, command, change_of, told):
    change(broken_copy / change_of[0], change_of[1])
    status, printed, _ = command("audit", broken_copy)
    assert status == 3
    assert told in printed.replace("\n", " ")


def test_charging_while_away_is_found(with_events, command, tmp_path):
    out = tmp_path / "run"
    command("run", with_events(DRIVERS), "--out", out)
    change(out / "scenario" / "events.csv", replaced("interval", "2", "V4"))
    change(out / "scenario" / "events.csv", replaced("event", "no_show", "V4"))
    change(out / "scenario" / "events.csv", replaced("value", "", "V4"))
    status, printed, _ = command("audit", out)
    assert status == 3
    assert "V4: charges at" in printed
    assert "when it is away" in printed


def test_faults_in_events_end_with_status_2_and_nothing_is_written(with_events, command, tmp_path):
    out = tmp_path / "run"
    folder = with_events(HEADER + "9,chargers_fail,,99,,\n")
    status, _, err = command("run", folder, "--out", out)
    assert status == 2
    assert "events.csv, row 2, column interval" in err
    assert not out.exists()
    assert command("validate", folder)[0] == 2
