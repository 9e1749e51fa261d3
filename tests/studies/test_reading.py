"""A study file is checked as a whole, and each of its keys does what it says."""

import pytest

from evdash.domain.study import Study
from evdash.errors import InputError
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import resolved
from evdash.horizon.arrivals import arrivals_of
from evdash.studies.folder import study_text
from evdash.studies.keys import with_settings
from evdash.studies.reading import lay_out, parse_study, read_study, scenario_at
from tests.studies.small import STUDY, small, write_study

WRONG = """
format = 1
name = "wrong in many ways"
base = "base"
policies = ["p1", "best"]
metrics = ["profit", "fame", "profit"]
[seeds]
count = 3
[[axis]]
key = "station.chargers"
values = [1, -2, "many"]
[[axis]]
key = "line.s-z.rating_kva"
values = [30]
[[axis]]
key = "price.spread"
values = [1, -1]
[[axis]]
name = "profit"
[[axis.case]]
name = "as is"
[[axis.case]]
name = "wrong"
set = { "station.colour" = 3 }
"""


def faults_of(tmp_path, text: str) -> list[str]:
    with pytest.raises(InputError) as told:
        read_study(write_study(tmp_path, text))
    return [str(fault) for fault in told.value.faults]


def test_all_faults_are_told_at_once(tmp_path) -> None:
    told = "\n".join(faults_of(tmp_path, WRONG))
    for part in (
        "policies: found 'best'",
        "metrics: found 'fame'",
        "metrics: found 'profit' 2 times",
        "axis: found 'profit'; should be a name no other column has",
        "axis, -2, station.chargers: found -2; should be at least 0",
        "axis, 'many', station.chargers: found 'many'; should be a whole number",
        "nothing called 's-z'; there are s-a, a-b",
        "axis, -1, price.spread: found -1; should be 0 to 100",
        "axis, 'wrong', station: found unknown key 'colour'",
    ):
        assert part in told, told


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("name = 3", "name: found 3; should be text"),
        ("name = 'x'\nformat = 2", "format: found 2; should be 1"),
        ("format = 1\nname = 'x'\nseed = 3", "unknown key 'seed'"),
        ("format = 1\nname = ", "text that is not TOML"),
        ("format = 1\nname = 'x'\nbase = 'nowhere'", "base: found 'nowhere'; should be a folder"),
        ("format = 1\nname = 'x'\n[seeds]\ncount = 0", "seeds.count: found 0; should be at least"),
        ("format = 1\nname = 'x'\nnetworks = ['dc']", "networks.1: found 'dc'"),
        ("format = 1\nname = 'x'\n[[axis]]\nkey = 'station.chargers'", "axis.1: found no values"),
        (
            "format = 1\nname = 'x'\n[[axis]]\nkey = 'station.max_kw'\nvalues = 'all'",
            "only station.node takes it",
        ),
        (
            "format = 1\nname = 'x'\n[seeds]\ncount = 100000\n[[axis]]\nkey = 'station.chargers'\n"
            f"values = {list(range(20))}",
            "2,000,000 runs in all; at most 1,000,000",
        ),
    ],
)
def test_each_fault_names_its_place(tmp_path, text, part) -> None:
    assert any(part in told for told in faults_of(tmp_path, text)), faults_of(tmp_path, text)


def test_listed_arrivals_have_one_day_only(tmp_path) -> None:
    listed = resolved(small(), arrivals_of(small()))
    study = Study(format=1, name="x", base="base", seeds={"count": 2})
    with pytest.raises(InputError, match="lists its arrivals"):
        lay_out(study, listed)
    assert len(lay_out(study.model_copy(update={"seeds": None}), listed).runs) == 1


def test_combined_values_that_will_not_do_are_told(tmp_path) -> None:
    text = """
format = 1
name = "pairs"
base = "base"
[[axis]]
key = "feeder.voltage_min_pu"
values = [0.95, 0.99]
[[axis]]
key = "feeder.source_voltage_pu"
values = [1.0, 0.97]
[[axis]]
key = "feeder.voltage_max_pu"
values = [1.05, 0.97]
"""
    told = faults_of(tmp_path, text)
    assert told
    assert all("0.99" in one for one in told), told


def test_points_are_all_combinations_and_runs_stand_in_order(tmp_path) -> None:
    runs = read_study(write_study(tmp_path, STUDY.format(count=2)))
    assert [point.labels for point in runs.points] == [(1, 30), (1, 60), (3, 30), (3, 60)]
    assert [(run.point, run.seed) for run in runs.runs] == [
        (p, s) for p in range(4) for s in (3, 4)
    ]
    assert not any(run.referee for run in runs.runs)
    asked = read_study(write_study(tmp_path, STUDY.format(count=2).replace("= 0", "= 1000")))
    assert [run.referee for run in asked.runs] == [True] + [False] * 7
    assert scenario_at(runs, 3).station.chargers == 3


def test_a_written_study_reads_back_the_same(tmp_path) -> None:
    text = STUDY.format(count=2) + (
        '[[axis]]\nname = "tariff"\n[[axis.case]]\nname = "as is"\n[[axis.case]]\nname = "dearer"\n'
        "[axis.case.set.option.C1]\nprice_per_kwh = 0.5\n"
    )
    study = parse_study(text)
    assert study.axis[2].case[1].set == {"option.C1.price_per_kwh": 0.5}
    assert parse_study(study_text(study)) == study


def test_every_node_but_the_source() -> None:
    study = Study(format=1, name="x", axis=({"key": "station.node", "values": "all"},))
    runs = lay_out(study, small())
    assert [scenario_at(runs, p).station.node for p in range(2)] == ["a", "b"]


@pytest.mark.parametrize(
    ("key", "value", "of", "expected"),
    [
        ("price.factor", 2.0, lambda s: list(s.price_per_kwh), [0.2, 0.4, 0.3, 0.1, 0.6, 0.2]),
        ("price.spread", 0, lambda s: list(s.price_per_kwh), [0.15] * 6),
        (
            "price.spread",
            2,
            lambda s: list(s.price_per_kwh),
            pytest.approx([0.05, 0.25, 0.15, -0.05, 0.45, 0.05]),
        ),
        ("tariff.factor", 0.5, lambda s: [o.price_per_kwh for o in s.option], [0.2, 0.15]),
        (
            "voltage.band_pu",
            0.05,
            lambda s: (s.feeder.voltage_min_pu, s.feeder.voltage_max_pu),
            (0.95, 1.05),
        ),
        ("line.a-s.rating_kva", 70, lambda s: s.lines[0].rating_kva, 70),
        ("line.s-a.rating_kva", "", lambda s: s.lines[0].rating_kva, None),
        ("node.b.load_kw", 9, lambda s: s.nodes[2].load_kw, 9),
    ],
)
def test_keys_of_a_study_do_what_they_say(key, value, of, expected) -> None:
    assert of(with_settings(small(), {key: value})) == expected


def test_other_keys_are_those_of_set() -> None:
    settings = {"station.chargers": 2, "option.C1.price_per_kwh": 0.7, "station.node": "b"}
    assert with_settings(small(), settings) == edit_scenario(small(), settings)
