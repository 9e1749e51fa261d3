"""The bundled scenarios: in step with their tables, and telling the story they promise."""

import csv
import importlib.util
import sys

import numpy as np
import pytest

from evdash.checker.feeder import FeederCheck
from evdash.files.scenario_folder import read_scenario
from evdash.grid.reduction import limit_rows
from evdash.horizon.day import run_day, start_day
from evdash.horizon.networks import NETWORKS
from evdash.metrics.records import interval_records
from evdash.scheduling.p1 import p1_policy
from tests.builders import PRESETS, names

DATA = PRESETS.parent
SOURCES = sorted((DATA / "sources").glob("*.csv"))


@pytest.fixture(scope="module")
def build():
    """data/build_presets.py, which is a script and no package."""
    spec = importlib.util.spec_from_file_location("build_presets", DATA / "build_presets.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # its dataclass looks itself up there
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


@pytest.fixture(scope="module")
def presets():
    return {path.name: read_scenario(path) for path in sorted(PRESETS.iterdir())}


def test_presets_are_what_the_script_writes(build, tmp_path):
    build.main(tmp_path)
    written = {path.relative_to(tmp_path): path.read_bytes() for path in tmp_path.rglob("*.*")}
    shipped = {path.relative_to(PRESETS): path.read_bytes() for path in PRESETS.rglob("*.*")}
    assert written == shipped


def test_every_table_names_its_source():
    told = (DATA / "README.md").read_text(encoding="utf-8").splitlines()
    for table in SOURCES:
        (row,) = [line for line in told if line.startswith(f"| `{table.name}` |")]
        assert len(row.split("|")[3].strip()) > 20


def test_arrival_shares_sum_to_one_and_loads_peak_at_one():
    shares = [float(row["weekday"]) for row in rows("arrival_share.csv")]
    assert len(shares) == 24
    assert sum(shares) == pytest.approx(1, abs=1e-3)
    loads = rows("epri_residential_load.csv")
    assert len(loads) == 24
    for column in set(loads[0]) - {"hour"}:
        assert max(float(row[column]) for row in loads) == pytest.approx(1, abs=1e-4)


def rows(table):
    with (DATA / "sources" / table).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_every_feeder_keeps_its_limits_by_itself(presets):
    for scenario in presets.values():
        assert FeederCheck(scenario).breaches(np.zeros(scenario.intervals)) == []


def test_transformer_binds_all_day_or_voltage_from_noon_on(presets):
    for name, scenario in presets.items():
        binding = names(limit_rows(scenario).binding())
        expected = {"line:633-634"} if name != "voltage-limited" else {"voltage_min:652"}
        assert set(binding if name != "voltage-limited" else binding[12:]) == expected


def test_headroom_falls_short_of_the_chargers_in_the_evening(presets):
    for name in ("summer-weekday", "price-spike", "voltage-limited"):
        scenario = presets[name]
        headroom = limit_rows(scenario).headroom_kw()
        wanted = scenario.station.chargers * scenario.station.max_kw
        assert headroom[18] < wanted / 3
        assert headroom[18] == headroom[:24].min()


def test_prices_are_what_the_titles_say(presets):
    spike = presets["price-spike"].price_per_kwh
    assert np.flatnonzero(spike > 1).tolist() == list(range(13, 21))
    negative = presets["negative-price"].price_per_kwh
    assert (negative < 0).sum() == 10
    assert (negative[9:15] < 0).all()
    for name in ("summer-weekday", "winter-weekday", "voltage-limited"):
        assert (presets[name].price_per_kwh > 0).all()
        assert (presets[name].price_per_kwh < 0.35).all()


def test_summer_and_winter_differ_in_their_load(presets):
    assert int(np.argmax(presets["summer-weekday"].load_pu)) == 18
    assert int(np.argmax(presets["winter-weekday"].load_pu)) == 20
    assert presets["winter-weekday"].load_pu.min() > presets["summer-weekday"].load_pu.min()


def test_past_midnight_has_six_hours_more_to_charge_in(presets):
    longer, day = presets["past-midnight"], presets["summer-weekday"]
    assert (longer.intervals, longer.arrivals_end) == (30, 24)
    assert day.arrivals == longer.arrivals
    assert longer.price_per_kwh[:24].tolist() == day.price_per_kwh.tolist()


def story(build, folder):
    return next(preset.story for preset in build.PRESETS if preset.folder == folder)


def test_stories_are_those_of_their_days(build, presets):
    """Every number and hour a preset's README tells, from its tables and its day."""
    summer = presets["summer-weekday"]
    assert story(build, "summer-weekday") == (
        "An ordinary day: the 500 kVA transformer at node 634 binds in the evening."
    )
    (transformer,) = [line for line in summer.lines if line.name == "633-634"]
    assert (transformer.rating_kva, summer.station.node) == (500, "634")
    reached = {r.interval for r in records(summer) if r.station_kw >= 0.999 * r.headroom_kw}
    assert reached
    assert reached <= set(range(18, 23))

    assert story(build, "price-spike").endswith("energy above 1 $/kWh from 13:00 to 21:00.")
    assert presets["price-spike"].start.strftime("%B %Y") == "August 2020"

    told = story(build, "negative-price")
    assert told == "A Sunday in June with ten hours of negative prices around noon."
    assert presets["negative-price"].start.strftime("%A %B") == "Sunday June"
    negative = np.flatnonzero(presets["negative-price"].price_per_kwh < 0)
    assert negative.tolist() == list(range(6, 16))

    told = story(build, "winter-weekday")
    assert told == "Heating gives the load two peaks, at 08:00 and, the higher one, at 20:00."
    load = presets["winter-weekday"].load_pu
    peaks = [t for t in range(1, 23) if load[t - 1] < load[t] > load[t + 1]]
    assert peaks == [8, 20]
    assert load[20] > load[8]

    assert "node 671, loads 8 % higher: the voltage at node 652 binds" in story(
        build, "voltage-limited"
    )
    limited = presets["voltage-limited"]
    assert (limited.station.node, limited.feeder.load_scale) == ("671", 1.08)
    full = {r.binding for r in records(limited) if r.station_kw >= 0.99 * r.headroom_kw}
    assert full == {"voltage_min:652"}

    assert "six hours more to charge in" in story(build, "past-midnight")
    day, longer = (
        sum(r.admitted for r in records(presets[n])) for n in ("summer-weekday", "past-midnight")
    )
    assert longer > day


def records(scenario):
    return interval_records(run_day(start_day(scenario), p1_policy()))


def test_the_linearised_model_leaves_more_room_than_ac_wherever_loads_are_all_there_is(presets):
    """What the switch between the two says in the app."""
    for scenario in presets.values():
        assert not any(row.generation_pu for row in scenario.profile)
        linear, ac = (NETWORKS[name].rows(scenario).headroom_kw() for name in ("lindistflow", "ac"))
        assert (linear > ac).all()
