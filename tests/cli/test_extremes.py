"""Extremes that are legal run, keep every promise, and their files pass the audit."""

import json
from pathlib import Path

import pytest

from benchmarks.soundness import problems_of_day
from evdash.cli.main import main
from evdash.domain.scenario import Scenario
from evdash.files.scenario_folder import scenario_files
from evdash.horizon.day import run_day, start_day
from evdash.scheduling.p1 import p1_policy
from tests.builders import generator, make_scenario, vehicle

THREE = tuple(vehicle(f"v{n}", n * 0.5) for n in range(3))
MANY = 10_000
TWO_DAYS_OF_5_MINUTES = 576
NODES = ({"node": "s"}, {"node": "a", "rating_kva": 1e-3})
OUTSIDE = ({"node": "s"}, {"node": "a", "load_kw": 20_000.0})
NEEDS = (
    vehicle("least", 0, 1.01e-4 * 0.5, battery_kwh=0.5),
    vehicle("at the lowest power", 0, 2.0),
    vehicle("just below it", 0, 2.0 - 1e-6),
    vehicle("whole intervals", 0, 30.0),
    vehicle("a hair more", 0, 30.0 + 1e-6),
    vehicle("the longest possible", 0, 40.0),
    vehicle("too much for the day", 0, 40.1),
)

EXTREMES = {
    "one interval": (make_scenario(price=[0.1], vehicles=[vehicle("v", 0, 6.0)]), 1),
    "no vehicles": (make_scenario(), 0),
    "no chargers": (make_scenario(vehicles=THREE, station={"chargers": 0}), 0),
    "no headroom": (make_scenario(vehicles=THREE, nodes=NODES), 0),
    "negative prices": (make_scenario(vehicles=THREE, price=[-0.5, -1.0, -1000.0, -0.1]), None),
    "energy dearer than every option": (make_scenario(vehicles=THREE, price=[999.0] * 4), 0),
    "needs near the bounds": (make_scenario(vehicles=NEEDS, station={"chargers": 9}), None),
    "outside its limits by itself": (make_scenario(vehicles=THREE, nodes=OUTSIDE), 0),
    "two days of 5 minutes": (
        make_scenario(
            price=[0.1 + 0.001 * (t % 97) for t in range(TWO_DAYS_OF_5_MINUTES)],
            arrivals=generator(vehicles_per_day=10.0),
            interval_minutes=5,
        ),
        None,
    ),
    "ten thousand vehicles": (
        make_scenario(
            vehicles=[vehicle(f"v{n}", 2.0 * n / MANY, 5.0 + n % 7) for n in range(MANY)],
            station={"chargers": 20},
        ),
        None,
    ),
}
"""Each with how many are admitted where that is plain."""


@pytest.mark.parametrize("name", [name for name in EXTREMES if name != "two days of 5 minutes"])
def test_legal_extremes_run_and_keep_every_promise(name: str, tmp_path: Path) -> None:
    scenario, admitted = EXTREMES[name]
    given, out = written(scenario, tmp_path / "given"), tmp_path / "out"
    assert main(["run", str(given), "--out", str(out)]) == 0
    summary = json.loads((out / "summary.json").read_text())
    if admitted is None:
        assert summary["admitted"] > 0
    else:
        assert summary["admitted"] == admitted
    assert main(["audit", str(out)]) == 0


@pytest.mark.parametrize("name", [name for name in EXTREMES if name != "ten thousand vehicles"])
def test_every_step_of_a_legal_extreme_passes_the_independent_checker(name: str) -> None:
    assert problems_of_day(run_day(start_day(EXTREMES[name][0]), p1_policy())) == []


def test_five_minute_intervals_are_right_in_the_files_of_a_run(tmp_path: Path) -> None:
    """An hour of them: the AC referee takes its time over every interval of two days."""
    twelve = make_scenario(price=[0.1] * 12, vehicles=[vehicle("v", 0, 6.0)], interval_minutes=5)
    given, out = written(twelve, tmp_path / "given"), tmp_path / "out"
    assert main(["run", str(given), "--out", str(out)]) == 0
    assert main(["audit", str(out)]) == 0


def written(scenario: Scenario, folder: Path) -> Path:
    """The scenario as a folder of files."""
    folder.mkdir()
    for file, text in scenario_files(scenario).items():
        (folder / file).write_text(text, encoding="utf-8")
    return folder
