"""Exit status 3 where a promise or a limit is broken, and never otherwise: worked out from files.

What is broken is read from `power.csv`, the scenario and the events alone, by neither the run's
nor the audit's code.
"""

import csv
import json
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from evdash.cli.main import main
from evdash.files.scenario_folder import scenario_files
from tests.builders import line, make_scenario, node, vehicle

HEADER = "interval,event,subject,value,from_interval,until_interval\n"
LOAD_KW, RATED_KVA, TOLERANCE = 60.0, 90.0, 1e-3
"""The small scenario's line s-a carries all load, lossless and at a power factor of 1."""


@dataclass(frozen=True)
class Told:
    """What is done to the small day, and whether anything is broken by it."""

    broken: bool
    events: str = ""
    arguments: tuple[str, ...] = ()


DAYS = {
    "nothing happens": Told(False),
    "a driver stays away, one is late, one leaves": Told(
        False, "1,no_show,V0,,,\n1,leaves_early,V1,,,2\n1,late,V3,,2,\n"
    ),
    "more is asked for, in vain": Told(False, "1,asks_more,V0,900,,\n1,asks_more,V1,900,,\n"),
    "chargers fail that nobody needs": Told(False, "1,chargers_fail,,1,,\n"),
    "all chargers fail and are back at once": Told(False, "1,chargers,,0,,\n1,chargers,,3,,\n"),
    "all chargers fail": Told(True, "1,chargers,,0,,\n"),
    "the line is lost": Told(True, "1,rating,line:s-a,0,,\n"),
    "the line is lost where nobody is under contract": Told(False, "0,rating,line:s-a,0,,\n"),
    "loads leave no room": Told(True, "1,load_factor,,2,,\n"),
    "energy is dear": Told(False, "1,price_factor,,9,,\n"),
    "a limit is broken, no promise": Told(True, "", ("--policy", "uncoordinated")),
    "by rule within the limits": Told(False, "", ("--policy", "edf")),
}


@pytest.fixture(scope="module")
def small_day(tmp_path_factory: pytest.TempPathFactory) -> Path:
    scenario = make_scenario(
        name="small",
        nodes=[node("s"), node("a", load_kw=40, load_kvar=0), node("b", load_kw=20, load_kvar=0)],
        lines=[line("s", "a", 0.001, 0.001, RATED_KVA), line("a", "b", 0.001, 0.001)],
        price=(0.1, 0.3, 0.2, 0.05),
        vehicles=[vehicle(f"V{n}", n / 4, need_kwh=12 + n) for n in range(12)],
        station={"chargers": 4},
    )
    folder = tmp_path_factory.mktemp("status") / "scenario"
    folder.mkdir()
    for name, text in scenario_files(scenario).items():
        (folder / name).write_text(text, encoding="utf-8", newline="")
    return folder


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def station_kw(run: Path) -> list[float]:
    drawn = [0.0] * 4
    for row in rows(run / "power.csv"):
        drawn[int(row["interval"])] += float(row["power_kw"])
    return drawn


def limits_broken(run: Path, events: list[dict[str, str]]) -> Iterator[int]:
    """Intervals in which the line carries more than its rating while the station draws."""
    for interval, drawn in enumerate(station_kw(run)):
        rated, load = RATED_KVA, LOAD_KW
        for event in events:
            if int(event["interval"]) <= interval:
                rated = float(event["value"]) if event["event"] == "rating" else rated
                load *= float(event["value"]) if event["event"] == "load_factor" else 1.0
        if drawn > TOLERANCE and load + drawn > rated + TOLERANCE:
            yield interval


def promises_broken(run: Path, events: list[dict[str, str]]) -> Iterator[str]:
    """Contracts that drew less than promised, but for those whose own drivers cut them."""
    drawn: dict[str, float] = {}
    for row in rows(run / "power.csv"):
        drawn[row["vehicle"]] = drawn.get(row["vehicle"], 0.0) + float(row["power_kw"])
    cut = {e["subject"] for e in events if e["event"] in ("no_show", "late", "leaves_early")}
    for row in rows(run / "vehicles.csv"):
        missing = float(row["need_kwh"]) - drawn.get(row["vehicle"], 0.0)
        if row["status"] != "refused" and row["vehicle"] not in cut and missing > 0.01:
            yield row["vehicle"]


@pytest.mark.parametrize("name", DAYS)
def test_status_3_where_a_promise_or_limit_is_broken_and_never_otherwise(
    name: str, small_day: Path, tmp_path: Path
) -> None:
    told = DAYS[name]
    folder, run = Path(shutil.copytree(small_day, tmp_path / "scenario")), tmp_path / "run"
    if told.events:
        (folder / "events.csv").write_text(HEADER + told.events, encoding="utf-8")
    status = main(["run", str(folder), *told.arguments, "--out", str(run)])
    events = rows(folder / "events.csv") if told.events else []
    broken = [*limits_broken(run, events), *promises_broken(run, events)]
    assert bool(broken) == told.broken
    assert status == (3 if broken else 0)
    assert main(["audit", str(run)]) == status


def test_what_the_feeder_breaks_by_itself_is_told_and_no_failure(
    small_day: Path, tmp_path: Path
) -> None:
    """The line is overloaded before anybody comes: nobody is admitted, and nothing is broken."""
    folder, run = Path(shutil.copytree(small_day, tmp_path / "scenario")), tmp_path / "run"
    (folder / "events.csv").write_text(HEADER + "0,load_factor,,2,,\n", encoding="utf-8")
    assert main(["run", str(folder), "--out", str(run)]) == 0
    summary = json.loads((run / "summary.json").read_text(encoding="utf-8"))
    assert summary["limits_broken_by_feeder"]
    assert summary["limits_broken_by_station"] == []
    assert summary["admitted"] == 0


@pytest.mark.parametrize("name", ["nothing happens", "all chargers fail"])
def test_a_race_and_an_export_end_alike(name: str, small_day: Path, tmp_path: Path) -> None:
    folder, told = Path(shutil.copytree(small_day, tmp_path / "scenario")), DAYS[name]
    if told.events:
        (folder / "events.csv").write_text(HEADER + told.events, encoding="utf-8")
    status = 3 if told.broken else 0
    assert main(["race", str(folder), "--policies", "fcfs", "edf"]) == status
    assert main(["export", str(folder), "--report", str(tmp_path / "report.html")]) == status
