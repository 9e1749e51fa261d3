"""Days by seed: the days one would run one by one, and a file that tells where they were timed."""

import json

from evdash.domain.scenario import Scenario
from evdash.files.bundled import DEFAULT
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario, resolved
from evdash.horizon.arrivals import arrivals_of
from evdash.horizon.day import run_day, start_day
from evdash.metrics.service import totals
from evdash.scheduling.p1 import p1_policy
from evdash.studies.days import days_taken, with_seed
from evdash.studies.days_file import days_text, measured, read_days


def small() -> Scenario:
    return edit_scenario(read_scenario(DEFAULT), {"arrivals.vehicles_per_day": 20.0})


def test_each_day_is_the_one_run_with_its_seed() -> None:
    steps: list[int] = []
    days = list(days_taken(small(), [3, 4], p1_policy(), lambda: steps.append(1)))
    assert len(steps) == 48
    for day in days:
        alone = run_day(start_day(with_seed(small(), day.seed)), p1_policy())
        sums = totals(alone)
        assert (day.arrived, day.admitted, day.profit) == (sums.arrived, sums.admitted, sums.profit)
        assert 0 < day.slowest_seconds <= day.seconds
        assert day.proven == day.intervals == 24


def test_a_list_of_vehicles_is_the_same_with_every_seed() -> None:
    scenario = small()
    listed = resolved(scenario, arrivals_of(scenario))
    assert with_seed(listed, 5) is listed


def test_measured_days_are_read_back_with_their_machine_and_versions(tmp_path) -> None:
    days = list(days_taken(small(), [1], p1_policy()))
    written = measured(small(), days, "a test")
    file = tmp_path / "days.json"
    file.write_text(days_text(written), encoding="utf-8")
    assert read_days(file) == written
    said = json.loads(file.read_text(encoding="utf-8"))
    assert said["machine"]["processor"]
    assert {"python", "highspy", "numpy", "evdash"} <= set(said["versions"])


def test_the_measured_hundred_days_are_of_the_bundled_day() -> None:
    kept = read_days()
    bundled = read_scenario(DEFAULT)
    assert kept.scenario_sha256 == measured(bundled, [], "").scenario_sha256
    assert [day.seed for day in kept.days] == list(range(1, 101))
    first = next(iter(days_taken(bundled, [1], p1_policy())))
    assert (first.arrived, first.admitted) == (kept.days[0].arrived, kept.days[0].admitted)
