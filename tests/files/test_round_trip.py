"""What is written reads back as the same scenario."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evdash.files.scenario_folder import parse_scenario, read_scenario, resolved, scenario_files
from evdash.horizon.arrivals import arrivals_of
from tests.builders import PRESETS, generator, make_scenario, scenarios, vehicle
from tests.files.spoiling import files_of, recorded_scenario

PRESET_FOLDERS = sorted(path.name for path in PRESETS.iterdir())


@pytest.mark.parametrize("name", PRESET_FOLDERS)
def test_presets_drawn_or_not(name):
    scenario = read_scenario(PRESETS / name)
    assert parse_scenario(files_of(scenario)) == scenario
    drawn = resolved(scenario, arrivals_of(scenario))
    again = parse_scenario(files_of(drawn))
    assert again == drawn
    assert arrivals_of(again) == arrivals_of(scenario)
    assert again.arrivals.forecast.vehicles_per_day == scenario.arrivals.vehicles_per_day


@given(scenario=scenarios())
def test_random_scenarios(scenario):
    assert parse_scenario(files_of(scenario)) == scenario


names = st.text(min_size=1, max_size=8).filter(
    lambda text: (
        (text[0].isalpha() or text[0].isdecimal()) and text == text.strip() and text.isprintable()
    )
)
floats = st.floats(0.02, 0.9)


@given(names=st.lists(names, min_size=4, max_size=4, unique=True), values=st.tuples(*[floats] * 6))
def test_names_of_any_letters_and_numbers_of_full_precision(names, values):
    source, station, first, second = names
    options = [
        {"name": first, "price_per_kwh": values[0], "average_kw": values[1]},
        {"name": second, "price_per_kwh": values[2], "average_kw": values[3]},
    ]
    shares = {first: values[4], second: 1 - values[4]}
    scenario = make_scenario(
        nodes=[{"node": source}, {"node": station, "load_kw": values[5]}],
        lines=[{"from_node": source, "to_node": station, "r_ohm": values[0], "x_ohm": values[1]}],
        feeder={"source_node": source},
        station={"node": station},
        options=options,
        arrivals=generator(option_share=shares),
        name=first,
    )
    assert parse_scenario(files_of(scenario)) == scenario
    drawn = resolved(scenario, arrivals_of(scenario))
    assert parse_scenario(files_of(drawn)) == drawn


def test_nobody_recorded_is_a_scenario_too():
    scenario = make_scenario(vehicles=[])
    assert parse_scenario(files_of(scenario)) == scenario


def test_resolving_recorded_arrivals_changes_nothing():
    scenario = recorded_scenario()
    assert resolved(scenario, arrivals_of(scenario)) == scenario


def test_rows_of_the_profile_may_come_in_any_order():
    scenario = make_scenario(vehicles=[vehicle("x", 1)])
    files = files_of(scenario)
    header, *rows = scenario_files(scenario)["profile.csv"].splitlines(keepends=True)
    files["profile.csv"] = "".join([header, *rows[::-1]]).encode()
    assert parse_scenario(files) == scenario
