"""`events.csv`: read, written, and every fault told with file, row and column."""

import pytest

from evdash.domain.events import EVENT_FORMS
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import parse_scenario, resolved
from evdash.horizon.arrivals import arrivals_of
from tests.builders import generator, make_scenario
from tests.files.spoiling import faults_of, files_of, recorded_scenario

HEADER = "interval,event,subject,value,from_interval,until_interval\n"
EVERY_KIND = HEADER + (
    "0,chargers_fail,,2,,\n"
    "3,chargers_return,,1,,\n"
    "1,chargers,,3,,\n"
    "1,rating,line:634-a,150.5,,\n"
    "2,rating,node:b,80,,\n"
    "1,load_factor,,1.2,2,4\n"
    "1,price_factor,,0,,3\n"
    "1,price,,-0.05,2,\n"
    "2,leaves_early,1,,,2\n"
    "2,late,2,,3,\n"
    "3,no_show,1,,,\n"
    "1,asks_more,2,2.5,,\n"
)
SHORT = "interval,event,subject,value\n"


def with_events(text: str, **fields) -> dict[str, bytes]:
    base = recorded_scenario() if not fields else make_scenario(**fields)
    return files_of(base) | {"events.csv": text.encode()}


def test_every_kind_reads_and_reads_back():
    scenario = parse_scenario(with_events(EVERY_KIND))
    assert {event.event for event in scenario.events} == set(EVENT_FORMS)
    assert [e.interval for e in scenario.events] == sorted(e.interval for e in scenario.events)
    assert parse_scenario(files_of(scenario)) == scenario


def test_columns_that_may_be_blank_may_be_left_out_and_no_events_make_no_file():
    assert len(parse_scenario(with_events(SHORT + "1,chargers_fail,,1\n")).events) == 1
    assert parse_scenario(with_events(HEADER)).events == ()
    assert "events.csv" not in files_of(recorded_scenario())


def test_every_kind_says_what_happens_in_words():
    texts = [event.text for event in parse_scenario(with_events(EVERY_KIND)).events]
    assert len(set(texts)) == len(texts)
    assert "the rating of line 634-a is 150.5 kVA from now on" in texts
    assert "2 asks for 2.5 kWh more" in texts


@pytest.mark.parametrize(
    ("row", "place", "told"),
    [
        ("1,chargers_fail,,,,", "column value", "found a blank; chargers_fail needs a number"),
        ("1,chargers_fail,,1.5,,", "column value", "found 1.5; should be a whole number"),
        ("1,chargers_fail,,0,,", "column value", "should be from 1 to 100000"),
        ("1,chargers_fail,,9,,", "column value", "would leave -6 chargers"),
        ("1,chargers_fail,a,1,,", "column subject", "should be blank for chargers_fail"),
        ("1,chargers_fail,,1,2,", "column from_interval", "should be blank"),
        ("1,chargers_fail,,some,,", "column value", "found 'some'; should be a number"),
        ("4,chargers_fail,,1,,", "column interval", "found 4; should be below the number of"),
        ("-1,chargers_fail,,1,,", "column interval", "should be at least 0"),
        ("1,fire,,,,", "column event", "found 'fire'; should be 'chargers_fail'"),
        ("1,rating,line:a-634,5,,", "column subject", "should be line:FROM-TO or node:NAME"),
        ("1,rating,node:634,5,,", "column subject", "should be line:FROM-TO or node:NAME"),
        ("1,rating,,5,,", "column subject", "found a blank; rating needs line:… or node:…"),
        ("1,rating,node:a,-5,,", "column value", "should be from 0 to"),
        ("1,load_factor,,101,,", "column value", "should be from 0 to 100 (factor"),
        ("2,price,,0.1,1,", "column from_interval", "found 1; should be from 2, when it is known"),
        ("2,price,,0.1,,2", "column until_interval", "found 2; should be from 3 to 4"),
        ("2,price,,0.1,3,3", "column until_interval", "found 3; should be from 4 to 4"),
        ("1,no_show,9,,,", "column subject", "found '9'; should be a vehicle of arrivals.csv"),
        ("1,leaves_early,1,,,", "column until_interval", "leaves_early needs an interval"),
        ("2,leaves_early,1,,,1", "column until_interval", "should be from 2 to 4"),
        ("1,late,1,,,2", "column until_interval", "should be blank for late"),
        ("1,asks_more,1,0,,", "column value", "should be from 0.001 to"),
    ],
)
def test_what_is_wrong_is_told_where_it_stands(row, place, told):
    faults = faults_of(with_events(HEADER + "0,chargers,,3,,\n" + row + "\n"))
    assert any(f"events.csv, row 3, {place}" in fault and told in fault for fault in faults), faults


def test_one_fault_is_told_once():
    assert len(faults_of(with_events(HEADER + "1,chargers_fail,,9,,\n"))) == 1
    assert len(faults_of(with_events(HEADER + "1,fire,,,,\n"))) == 1


def test_all_faults_come_together_and_unknown_columns_too():
    faults = faults_of(with_events(HEADER + "1,fire,,,,\n9,chargers,,1,,\n1,no_show,,,,\n"))
    assert [fault.split(",")[1] for fault in faults] == [" row 2", " row 4", " row 3"]
    assert "unknown column 'who'" in faults_of(with_events("interval,event,who\n"))[0]


def test_with_arrivals_drawn_any_vehicle_can_be_named():
    files = with_events(HEADER + "1,no_show,PEV-007,,,\n", arrivals=generator())
    assert faults_of(files) == []


def test_with_arrivals_drawn_a_name_that_nobody_can_have_is_told():
    files = with_events(HEADER + "1,no_show,7,,,\n1,no_show,PEV-7,,,\n", arrivals=generator())
    assert ["should be PEV-001" in fault for fault in faults_of(files)] == [True, True]


def test_a_run_of_a_day_on_which_somebody_named_did_not_come_can_be_read_again():
    text = HEADER + "1,no_show,PEV-4000,,,\n1,no_show,Guest-1,,,\n"
    scenario = parse_scenario(with_events(text, arrivals=generator()))
    run = resolved(scenario, arrivals_of(scenario))
    assert parse_scenario(files_of(run)) == run


def test_events_belong_in_their_file():
    files = files_of(recorded_scenario())
    told = files["scenario.toml"].replace(b"format = 1", b"format = 1\nevents = []")
    assert "goes in events.csv" in faults_of(files | {"scenario.toml": told})[0]


def test_an_edit_keeps_events():
    scenario = parse_scenario(with_events(EVERY_KIND))
    assert edit_scenario(scenario, {"station.max_kw": 11.0}).events == scenario.events
