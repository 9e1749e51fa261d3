"""`--set KEY=VALUE` and the edits of a scenario."""

from datetime import datetime

import pytest

from evdash.errors import InputError
from evdash.files.overrides import Setting, edit_scenario, parse_setting
from evdash.files.scenario_folder import parse_scenario
from tests.builders import generator, make_scenario
from tests.files.spoiling import faults_of, files_of, generated_scenario, recorded_scenario

GENERATED = files_of(generated_scenario())
RECORDED = files_of(recorded_scenario())


def with_settings(*texts, files=GENERATED):
    return parse_scenario(files, tuple(parse_setting(text) for text in texts))


def told(*texts, files=GENERATED):
    return faults_of(files, *(parse_setting(text) for text in texts))


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("station.chargers=8", "station.chargers", 8),
        ("station.max_kw = 7.5", "station.max_kw", 7.5),
        (" station.chargers =8", "station.chargers", 8),
        ("station.node=634", "station.node", "634"),
        ("feeder.source_node=650", "feeder.source_node", "650"),
        ("name=true", "name", "true"),
        ("name=a = b", "name", "a = b"),
        ("name=", "name", ""),
        ('name="quoted"', "name", '"quoted"'),
        ("option.C1.name=1", "option.C1.name", "1"),
        ("arrivals.file=1.csv", "arrivals.file", "1.csv"),
        ("start=2024-05-06T00:00", "start", "2024-05-06T00:00"),
        ("start=2024-05-06T00:00:00", "start", datetime(2024, 5, 6)),
        ("arrivals.soc_out=[0.5, 0.9]", "arrivals.soc_out", [0.5, 0.9]),
        ("arrivals.option_share={C1=1}", "arrivals.option_share", {"C1": 1}),
        ("station.chargers=eight", "station.chargers", "eight"),
        ("station.chargers=", "station.chargers", ""),
        ("station.chargers=8\nname = 'x'", "station.chargers", "8\nname = 'x'"),
        ("station.chargers=" + "9" * 5000, "station.chargers", "9" * 5000),
        ("station.chargers=" + "[" * 5000, "station.chargers", "[" * 5000),
    ],
)
def test_value_is_toml_or_else_text(text, key, value):
    assert parse_setting(text) == Setting(key, value)


@pytest.mark.parametrize("text", ["station.chargers", "", "=8", " =8"])
def test_setting_without_key_or_value_is_a_fault(text):
    with pytest.raises(InputError, match="should be KEY=VALUE"):
        parse_setting(text)


def test_settings_are_laid_over_the_scenario():
    scenario = with_settings("station.chargers=8", "option.C2.price_per_kwh=0.2", "name=Other")
    assert (scenario.station.chargers, scenario.name) == (8, "Other")
    assert [option.price_per_kwh for option in scenario.option] == [0.4, 0.2]
    unchanged = generated_scenario()
    assert scenario.feeder == unchanged.feeder
    assert scenario.arrivals == unchanged.arrivals


def test_keys_that_were_left_out_can_be_set():
    assert with_settings("arrivals_until=2").arrivals_end == 2
    assert with_settings("arrivals.seed=9", files=RECORDED).arrivals.seed == 9
    shared = with_settings("arrivals.forecast.option_share={C1=1.0}", files=RECORDED)
    assert dict(shared.arrivals.forecast.option_share) == {"C1": 1.0}


def test_the_later_wins():
    assert with_settings("station.chargers=8", "station.chargers=9").station.chargers == 9
    assert told("station.chargers=x", "station.chargers=9") == []


def test_single_shares_and_names_with_dots():
    options = [
        {"name": "a.b", "price_per_kwh": 0.4, "average_kw": 8},
        {"name": "2", "price_per_kwh": 0.3, "average_kw": 4},
    ]
    shares = generator(option_share={"a.b": 0.5, "2": 0.5})
    files = files_of(make_scenario(options=options, arrivals=shares))
    scenario = with_settings(
        "option.a.b.average_kw=5",
        "option.2.average_kw=6",
        "arrivals.option_share.a.b=0.25",
        "arrivals.option_share.2=0.75",
        files=files,
    )
    assert [option.average_kw for option in scenario.option] == [5, 6]
    assert dict(scenario.arrivals.option_share) == {"a.b": 0.25, "2": 0.75}


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("colour=1", "scenario.toml: found unknown key 'colour'"),
        ("station.colour=1", "scenario.toml, station: found unknown key 'colour'"),
        ("option.C1.colour=1", "unknown key 'colour'"),
        ("option.C3.average_kw=1", "--set option.C3.average_kw: found no price option 'C3'"),
        ("station.node.x=1", "--set station.node.x: found no table that could hold 'x'"),
        ("nodes.a.load_kw=1", "unknown key 'nodes'"),
        ("station.chargers=eight", "scenario.toml, station.chargers: found 'eight'"),
        ("station.chargers=true", "found true; should be a whole number"),
        ("station.chargers=8.5", "found 8.5; should be a whole number"),
        ("station=5", "scenario.toml, station: found 5; should be a table"),
        ("option=5", "scenario.toml, option: found 5; should be a list"),
        ("arrivals.seed=-1", "arrivals.seed: found -1; should be at least 0"),
        ("station.node=s", "should not be the source node"),
        ("interval_minutes=7", "should divide 60"),
    ],
)
def test_settings_that_will_not_do_are_told(text, fault):
    faults = told(text)
    assert any(fault in one for one in faults), faults


def test_faults_of_settings_and_of_files_are_told_together():
    faults = told("station.chargers=x", "option.C9.name=y", files={**GENERATED, "spare": b""})
    assert len(faults) == 3


def test_edit_changes_what_is_told_and_validates():
    scenario = recorded_scenario()
    prices = [0.1, 0.2, 0.3, 0.4]
    edited = edit_scenario(
        scenario, {"station.chargers": 7, "option.C1.average_kw": 3.0}, price_per_kwh=prices
    )
    assert edited.price_per_kwh.tolist() == prices
    assert (edited.station.chargers, edited.option[0].average_kw) == (7, 3.0)
    assert edited.arrivals == scenario.arrivals
    assert scenario.station.chargers == 3
    assert edit_scenario(scenario, {}) == scenario
    generated = generated_scenario()
    assert edit_scenario(generated, {"arrivals.seed": 5}).arrivals.seed == 5


def test_edit_tells_every_fault():
    with pytest.raises(InputError) as caught:
        edit_scenario(recorded_scenario(), {"station.chargers": -1, "option.C1.average_kw": 50.0})
    assert len(caught.value.faults) == 2
    with pytest.raises(InputError, match="no price option 'C9'"):
        edit_scenario(recorded_scenario(), {"option.C9.average_kw": 5.0})
