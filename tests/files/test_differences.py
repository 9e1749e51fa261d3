"""Differences between scenarios: each one told, and nothing where there is none."""

import pytest

from evdash.domain.scenario import Scenario
from evdash.files.bundled import PRESETS, bundled_scenarios
from evdash.files.differences import Difference, scenario_differences
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario, resolved
from evdash.horizon.arrivals import arrivals_of


@pytest.fixture(scope="module")
def day() -> Scenario:
    return read_scenario(PRESETS / "summer-weekday")


@pytest.mark.parametrize("folder", bundled_scenarios(), ids=lambda folder: folder.name)
def test_a_scenario_does_not_differ_from_itself(folder) -> None:
    assert scenario_differences(read_scenario(folder), read_scenario(folder)) == []


@pytest.mark.parametrize(
    ("key", "value", "before", "after"),
    [
        ("station.chargers", 8, "12", "8"),
        ("feeder.voltage_min_pu", 0.95, "0.97", "0.95"),
        ("option.C1.price_per_kwh", 0.4, "0.35", "0.4"),
        ("arrivals.seed", 2, "1", "2"),
        ("arrivals.soc_out", [0.7, 0.9], "0.8, 1", "0.7, 0.9"),
        ("arrivals.hourly_share", [1.0] * 24, "mean 0.04167, 0.0022 to 0.1274", "mean 1, 1 to 1"),
        ("arrivals_until", None, "24", "–"),
        ("name", "Other", "Summer weekday", "Other"),
    ],
)
def test_every_key_that_differs_is_named(day, key, value, before, after) -> None:
    changed = edit_scenario(day, {key: value})
    assert scenario_differences(day, changed) == [Difference(key, before, after)]
    assert scenario_differences(changed, day) == [Difference(key, after, before)]


def test_few_cells_are_told_one_by_one_and_many_are_summed_up(day) -> None:
    prices = day.price_per_kwh.tolist()
    one = edit_scenario(day, {}, [*prices[:-1], 0.5])
    assert scenario_differences(day, one) == [
        Difference("profile.csv, 23, price_per_kwh", f"{prices[-1]:.10g}", "0.5")
    ]
    all_rows = edit_scenario(day, {}, [0.5] * 24)
    (summed,) = scenario_differences(day, all_rows)
    assert summed.place == "profile.csv, price_per_kwh: 24 of 24 rows"
    assert summed.after == "mean 0.5, 0.5 to 0.5"


def test_rows_that_only_one_has_are_told(day) -> None:
    longer = day.replacing(nodes=(*day.nodes, day.nodes[0].model_copy(update={"node": "new"})))
    assert scenario_differences(day, longer) == [Difference("nodes.csv, new", "–", "there")]
    assert scenario_differences(longer, day) == [Difference("nodes.csv, new", "there", "–")]


def test_drawn_and_listed_arrivals_differ_in_kind(day) -> None:
    listed = resolved(day, arrivals_of(day))
    told = {difference.place: difference for difference in scenario_differences(day, listed)}
    assert (told["arrivals"].before, told["arrivals"].after) == ("drawn at random", "from a list")
    assert told["arrivals.csv"].after == f"{len(arrivals_of(day))} rows"
    assert "fleet.csv" not in told
