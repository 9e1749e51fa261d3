"""`run`: the fixed forms of the command line and the files."""

import csv
import json
import shutil
import subprocess
import sys
import zipfile
from collections import Counter
from pathlib import Path

import pytest

from evdash.files.bundled import DEFAULT, bundled_scenarios
from evdash.files.exchange import output_folder
from evdash.files.run_folder import is_run

COLUMNS = {
    "intervals.csv": "interval,start,price_per_kwh,arrived,admitted,refused,charging,station_kw,"
    "headroom_kw,binding,objective,bound,solve_seconds,status",
    "vehicles.csv": "vehicle,option,arrival_interval,need_kwh,deadline_interval,status,reason,"
    "delivered_kwh,completed_interval,revenue",
    "power.csv": "interval,vehicle,power_kw",
    "voltages.csv": "interval,node,voltage_pu,voltage_ac_pu",
}


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_files_have_their_fixed_columns(bundled_run):
    for name, columns in COLUMNS.items():
        assert (bundled_run / name).read_text(encoding="utf-8").splitlines()[0] == columns


def test_the_bundled_day_tells_the_papers_story(bundled_run):
    intervals = rows(bundled_run / "intervals.csv")
    before = [row for row in intervals if int(row["interval"]) < 17]
    evening = [row for row in intervals if int(row["interval"]) >= 18]
    asked_before = sum(int(row["arrived"]) for row in before)
    assert sum(int(row["admitted"]) for row in before) >= 0.95 * asked_before > 20
    refused = sum(int(row["refused"]) for row in evening)
    assert refused >= sum(int(row["arrived"]) for row in evening) / 3 > 5
    assert {row["status"] for row in intervals} == {"optimal"}
    assert {row["binding"] for row in intervals} == {"line:633-634"}
    vehicles = rows(bundled_run / "vehicles.csv")
    assert Counter(row["status"] for row in vehicles)["broken"] == 0


def test_files_agree_with_each_other(bundled_run):
    summary = json.loads((bundled_run / "summary.json").read_text(encoding="utf-8"))
    vehicles = rows(bundled_run / "vehicles.csv")
    power = rows(bundled_run / "power.csv")
    assert summary["arrived"] == len(vehicles)
    assert summary["admitted"] == sum(row["status"] == "charged" for row in vehicles)
    delivered = Counter()
    for row in power:
        delivered[row["vehicle"]] += float(row["power_kw"])
    for row in vehicles:
        promised = float(row["need_kwh"]) if row["status"] == "charged" else 0.0
        assert delivered[row["vehicle"]] == pytest.approx(promised, abs=1e-6)
    assert summary["profit"] == pytest.approx(summary["revenue"] - summary["energy_cost"])
    assert summary["policy"] == "p1"
    assert summary["network"] == "lindistflow"
    assert summary["seed"] == 1


def test_the_resolved_scenario_runs_to_the_same_day(bundled_run, tmp_path, command):
    status, _, _ = command("run", bundled_run / "scenario", "--out", tmp_path / "again")
    assert status == 0
    for name in ("vehicles.csv", "power.csv", "voltages.csv"):
        assert (tmp_path / "again" / name).read_bytes() == (bundled_run / name).read_bytes()


def test_a_seed_decides_the_arrivals(tmp_path, command):
    for name, seed in (("a", 5), ("b", 5), ("c", 6)):
        assert command("run", "--seed", seed, "--out", tmp_path / name)[0] == 0
    first, same, other = ((tmp_path / n / "vehicles.csv").read_bytes() for n in "abc")
    assert first == same
    assert first != other


def test_settings_reach_the_scenario(tmp_path, command):
    status, out, _ = command(
        "run",
        "--set=station.chargers=3",
        "--set=station.chargers=2",
        "--set=option.C1.price_per_kwh=0.4",
        "--set=name=633",
        "--out",
        tmp_path / "run",
    )
    assert status == 0
    assert "633" in out
    settings = (tmp_path / "run" / "scenario" / "scenario.toml").read_text(encoding="utf-8")
    assert "chargers = 2\n" in settings
    assert 'name = "633"' in settings
    assert "price_per_kwh = 0.4\n" in settings
    charging = [int(row["charging"]) for row in rows(tmp_path / "run" / "intervals.csv")]
    assert max(charging) == 2


def test_a_zip_with_one_top_folder_is_a_scenario(tmp_path, command):
    archive = tmp_path / "day.zip"
    with zipfile.ZipFile(archive, "w") as zipped:
        for path in DEFAULT.iterdir():
            zipped.write(path, f"day/{path.name}")
    assert command("validate", archive)[0] == 0


@pytest.mark.parametrize("scenario", bundled_scenarios(), ids=lambda path: path.name)
def test_every_bundled_scenario_is_valid(scenario, command):
    status, out, _ = command("validate", scenario)
    assert (status, out.split()[0]) == (0, "ok")


def test_faults_are_told_together_and_nothing_is_written(tmp_path, command):
    spoilt = Path(shutil.copytree(DEFAULT, tmp_path / "spoilt"))
    nodes = (spoilt / "nodes.csv").read_text(encoding="utf-8")
    (spoilt / "nodes.csv").write_text(nodes.replace("1155", "much"), encoding="utf-8")
    lines = (spoilt / "lines.csv").read_text(encoding="utf-8")
    (spoilt / "lines.csv").write_text(lines.replace("684,652", "684,999"), encoding="utf-8")
    out = tmp_path / "run"
    status, printed, told = command("run", spoilt, "--set", "station.chargers=-2", "--out", out)
    assert status == 2
    assert printed == ""
    assert not out.exists()
    assert "nodes.csv, row" in told
    assert "'much'" in told
    assert "station.chargers" in told
    assert "-2" in told
    assert "Traceback" not in told
    status, _, told = command("validate", spoilt)
    assert status == 2
    assert "nodes.csv" in told


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "no-such-folder"],
        ["run", "--set", "station.charger=8"],
        ["run", "--set", "nonsense"],
        ["run", "--set", "option.C9.price_per_kwh=1"],
        ["run", "--seed", "-1"],
        ["run", "--seed", "one"],
        ["run", "--policy", "wishful"],
        ["run", "--network", "dc"],
        ["validate"],
        ["audit", "no-such-folder"],
        ["fly"],
        [],
    ],
    ids=" ".join,
)
def test_wrong_input_ends_with_status_two(arguments, command):
    status, out, told = command(*arguments)
    assert status == 2
    assert out == ""
    assert told
    assert "Traceback" not in told


def test_an_earlier_run_is_replaced_only_when_forced(run_copy, command):
    before = (run_copy / "vehicles.csv").read_bytes()
    status, _, told = command("run", "--seed", 9, "--out", run_copy)
    assert status == 2
    assert "--force" in told
    assert (run_copy / "vehicles.csv").read_bytes() == before
    (run_copy / "notes.txt").write_text("mine", encoding="utf-8")
    assert command("run", "--seed", 9, "--out", run_copy, "--force")[0] == 0
    assert (run_copy / "vehicles.csv").read_bytes() != before
    assert (run_copy / "notes.txt").read_text(encoding="utf-8") == "mine"
    assert command("audit", run_copy)[0] == 0


def test_a_folder_that_is_no_run_is_never_replaced(tmp_path, command):
    (tmp_path / "letter.txt").write_text("dear", encoding="utf-8")
    status, _, told = command("run", "--out", tmp_path, "--force")
    assert status == 2
    assert "earlier run" in told
    assert [path.name for path in tmp_path.iterdir()] == ["letter.txt"]


def test_extremes_run(tmp_path, command):
    for name, settings in {
        "no chargers": ["station.chargers=0"],
        "nobody": ["arrivals.vehicles_per_day=0"],
        "no headroom": ["feeder.load_scale=3"],
    }.items():
        arguments = [part for setting in settings for part in ("--set", setting)]
        assert command("run", *arguments, "--out", tmp_path / name)[0] == 0, name
        assert rows(tmp_path / name / "power.csv") == []
        assert command("audit", tmp_path / name)[0] == 0, name


@pytest.mark.parametrize("arguments", [["--help"], ["run", "--help"], ["audit", "--help"]])
def test_help_is_there(arguments, command):
    status, out, _ = command(*arguments)
    assert status == 0
    assert "exit status" in out


def test_the_module_runs_from_a_shell(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "evdash", "run", "--set", "intervals=x"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert "scenario.toml, intervals" in done.stderr
    assert done.stdout == ""


def test_nothing_but_the_summary_goes_to_stdout():
    """HiGHS 1.16 writes a banner there whatever it is told."""
    done = subprocess.run(
        [sys.executable, "-m", "evdash", "run", "--set", "arrivals.vehicles_per_day=5"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip().startswith("Summer weekday")


def test_a_link_to_an_earlier_run_leads_to_the_new_one(run_copy, tmp_path, command):
    """What is the user's own stays, in the folder of the scenario, too."""
    before = (run_copy / "vehicles.csv").read_bytes()
    own = (run_copy / "notes.csv", run_copy / "scenario" / "README.md")
    for path in own:
        path.write_text("mine", encoding="utf-8")
    link = tmp_path / "link"
    link.symlink_to(run_copy)
    assert command("run", "--seed", 9, "--out", link, "--force")[0] == 0
    assert link.is_symlink()
    assert (run_copy / "vehicles.csv").read_bytes() != before
    assert [path.read_text(encoding="utf-8") for path in own] == ["mine", "mine"]
    assert command("audit", link)[0] == 0


@pytest.mark.parametrize("name", ["run", "race"])
def test_the_place_is_told_before_a_day_is_run(name, small_scenario, tmp_path, command):
    """One inside the scenario, which could not be read afterwards; one that cannot be made."""
    (tmp_path / "file").write_text("", encoding="utf-8")
    for place in (small_scenario / "out", small_scenario, tmp_path / "file" / "out"):
        status, out, told = command(name, small_scenario, "--out", place)
        assert (status, out) == (2, "")
        assert str(place) in told
        assert "Traceback" not in told
    assert command("validate", small_scenario)[0] == 0


def test_two_runs_do_not_replace_each_other(small_scenario, tmp_path, command):
    with output_folder(tmp_path / "out", "run", is_run, force=False):
        status, _, told = command("run", small_scenario, "--out", tmp_path / "out")
        assert status == 2
        assert "another process" in told
