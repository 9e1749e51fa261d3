"""`export`: what it writes, from a run or a scenario, and what it refuses."""

import csv
import io
import json
import zipfile
from pathlib import Path

import openpyxl
import pandapower
import pytest

from evdash.cli.main import main
from tests.cli.test_audit import change, scaled


@pytest.fixture
def in_tmp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_run_is_handed_on_as_a_report_and_its_own_files(bundled_run, command, tmp_path):
    report, files = tmp_path / "r.html", tmp_path / "r.zip"
    status, out, err = command("export", bundled_run, "--report", report, "--run-zip", files)
    assert (status, err.strip()) == (0, "")
    assert "r.html" in out
    summary = json.loads((bundled_run / "summary.json").read_text(encoding="utf-8"))
    text = report.read_text(encoding="utf-8")
    assert summary["scenario_sha256"] in text
    assert f"${summary['profit']:,.2f}" in text
    with zipfile.ZipFile(files) as archive:
        archive.extractall(tmp_path / "out")
    assert command("audit", tmp_path / "out" / "run")[0] == 0
    for name in ("power.csv", "vehicles.csv", "scenario/arrivals.csv"):
        mine = (tmp_path / "out" / "run" / name).read_bytes()
        assert mine == (bundled_run / name).read_bytes()


def test_workbook_profiles_and_network_go_out_beside_each_other(small_run, command, tmp_path):
    book, profiles, network = tmp_path / "b.xlsx", tmp_path / "o.zip", tmp_path / "n.json"
    files = [
        "--excel",
        book,
        "--ocpp",
        profiles,
        "--amperes",
        "1x240",
        "--pandapower",
        network,
        "--at",
        "01:30",
    ]
    assert command("export", small_run, *files)[0] == 0
    assert openpyxl.load_workbook(book)["Vehicles"].max_row == 13
    served = {row["vehicle"] for row in table(small_run / "power.csv")}
    with zipfile.ZipFile(profiles) as archive:
        index = json.loads(archive.read("profiles/index.json"))
        assert f"profiles/ocpp-2.0.1-A/{index[0]['file']}" in archive.namelist()
    assert {row["vehicle"] for row in index} == served
    net = pandapower.from_json(str(network))
    pandapower.runpp(net, numba=False)
    found = dict(zip(net.bus.name, net.res_bus.vm_pu, strict=True))
    told = [row for row in table(small_run / "voltages.csv") if row["interval"] == "1"]
    assert len(told) == 2
    for row in told:
        assert found[row["node"]] == pytest.approx(float(row["voltage_ac_pu"]), abs=1e-7)


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_a_scenario_is_run_first_as_told(small_scenario, command, tmp_path):
    report = tmp_path / "r.html"
    options = ["--policy", "fcfs", "--network", "ac", "--set", "station.chargers=2"]
    assert command("export", small_scenario, "--report", report, *options)[0] == 0
    text = report.read_text(encoding="utf-8")
    assert "First come, first served" in text
    assert "full AC power flow" in text
    assert "2 vehicles can charge at the same time" in text


def test_a_day_with_broken_promises_is_handed_on_with_status_3(small_scenario, command, tmp_path):
    folder = tmp_path / "scenario"
    folder.mkdir()
    for path in small_scenario.iterdir():
        (folder / path.name).write_bytes(path.read_bytes())
    events = "interval,event,subject,value,from_interval,until_interval\n2,chargers_fail,,2,,\n"
    (folder / "events.csv").write_text(events, encoding="utf-8")
    assert main(["run", str(folder), "--out", str(tmp_path / "run")]) == 3
    status, _, _ = command("export", tmp_path / "run", "--report", tmp_path / "r.html")
    assert status == 3
    assert "promises broken" in (tmp_path / "r.html").read_text(encoding="utf-8").lower()


def test_worths_ambient_and_transformer_reach_the_report(small_scenario, command, tmp_path):
    report = tmp_path / "r.html"
    options = ["--worths", "--ambient", "41.5", "--transformer", "s-a"]
    assert command("export", small_scenario, "--report", report, *options)[0] == 0
    text = report.read_text(encoding="utf-8")
    assert "Worth: One more charger would have" in text
    assert "41.5" in text


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ([], "nothing to write"),
        (["--report", "no/such/folder/r.html"], "no folder"),
        (["--report", "."], "a folder"),
        (["--report", "r.html", "--run-zip", "r.html"], "different files"),
        (["--report", "r.html", "--transformer", "a-b"], "with a rating"),
        (["--report", "r.html", "--ambient", "nan"], "from -50 to 70"),
        (["--ocpp", "o.zip", "--time-zone", "Mars/Olympus"], "the time zone"),
        (["--ocpp", "o.zip", "--amperes", "230"], "3x230, 1x240"),
        (["--pandapower", "n.json", "--at", "25:00"], "should be HH:MM"),
        (["--pandapower", "n.json", "--at", "2024-05-07T00:00"], "to before 2024-05-06T04:00"),
        (["--report", "r.html", "--seed", "0", "--policy", "edf"], "--policy, --seed"),
    ],
)
def test_wrong_wishes_are_refused_and_nothing_is_written(small_run, command, in_tmp, options, told):
    status, _, err = command("export", small_run, *options)
    assert status == 2
    assert told in err
    assert list(in_tmp.iterdir()) == []


def test_what_is_there_is_replaced_only_when_told(small_run, command, tmp_path):
    report = tmp_path / "r.html"
    report.write_text("mine", encoding="utf-8")
    status, _, err = command("export", small_run, "--report", report)
    assert status == 2
    assert "--force" in err
    assert report.read_text(encoding="utf-8") == "mine"
    assert command("export", small_run, "--report", report, "--force")[0] == 0
    assert report.read_text(encoding="utf-8") != "mine"


@pytest.mark.parametrize("table", ["power.csv", "vehicles.csv"])
def test_a_run_that_does_not_come_out_again_is_not_handed_on(run_copy, command, tmp_path, table):
    if table == "power.csv":
        change(run_copy / table, scaled("power_kw", 1.01))
    else:
        change(run_copy / table, lambda rows: rows[0].update(status="refused"))
    status, _, err = command("export", run_copy, "--report", tmp_path / "r.html")
    assert status == 2
    assert table in err
    assert "when decided again" in err
    assert not (tmp_path / "r.html").exists()


def test_help_names_every_option(command):
    status, out, _ = command("export", "--help")
    assert status == 0
    for option in (
        "--report",
        "--excel",
        "--ocpp",
        "--amperes",
        "--pandapower",
        "--at",
        "--run-zip",
        "--transformer",
        "--ambient",
        "--worths",
        "--force",
    ):
        assert option in out
    assert "exit status" in out


def test_the_zip_of_a_run_is_the_same_each_time(small_run, tmp_path):
    contents = []
    for name in ("a.zip", "b.zip"):
        assert main(["export", str(small_run), "--run-zip", str(tmp_path / name)]) == 0
        with zipfile.ZipFile(io.BytesIO(Path(tmp_path / name).read_bytes())) as archive:
            contents.append({n: archive.read(n) for n in archive.namelist() if "power" in n})
    assert contents[0] == contents[1]
