"""Encodings, row numbers, clock times; and all faults of all files told at once."""

from datetime import timedelta

import pytest

from evdash.domain.arrivals import RecordedArrivals
from evdash.files.scenario_folder import parse_scenario
from tests.builders import START
from tests.files.spoiling import (
    faults_of,
    files_of,
    generated_scenario,
    recorded_scenario,
    with_cell,
    with_key,
    with_text,
)

RECORDED = files_of(recorded_scenario())
GENERATED = files_of(generated_scenario())


def test_all_faults_of_all_files_are_told_at_once():
    spoilt = with_key(RECORDED, "station.chargers", -1)
    spoilt = with_key(spoilt, "option.1.average_kw", "x")
    spoilt = with_key(spoilt, "interval_minutes", 25)
    spoilt = with_cell(spoilt, "nodes.csv", 3, "load_kw", "much")
    spoilt = with_cell(spoilt, "lines.csv", 3, "to_node", "a")
    spoilt = with_cell(spoilt, "profile.csv", 4, "price_per_kwh", "")
    spoilt = with_cell(spoilt, "arrivals.csv", 3, "soc_out", "0.1")
    spoilt = with_cell(spoilt, "fleet.csv", 2, "battery_kwh", "0")
    spoilt = {**spoilt, "spare.csv": b""}
    places = sorted(fault.split(": found")[0] for fault in faults_of(spoilt))
    assert places == [
        "arrivals.csv, row 3, column soc_out",
        "fleet.csv, row 2, column battery_kwh",
        "lines.csv",  # b is left without a way to the source
        "lines.csv, row 3",
        "nodes.csv, row 3, column load_kw",
        "profile.csv, row 4, column price_per_kwh",
        "scenario.toml, interval_minutes",
        "scenario.toml, option.C2.average_kw",
        "scenario.toml, station.chargers",
        "spare.csv",
    ]


def test_what_draws_on_a_faulty_place_stays_untold():
    assert len(faults_of(with_key(RECORDED, "start", "noon"))) == 1
    assert len(faults_of(with_key(RECORDED, "intervals", "four"))) == 1
    assert len(faults_of(with_key(RECORDED, "station.max_kw", "x"))) == 1
    assert len(faults_of({**RECORDED, "nodes.csv": b"\xff"})) == 1
    assert len(faults_of(with_cell(RECORDED, "nodes.csv", 3, "node", ""))) == 1
    assert len(faults_of(with_key(RECORDED, "option.0.name", 5))) == 1
    both = with_cell(with_key(RECORDED, "option.0.name", 5), "arrivals.csv", 3, "option", "C9")
    assert len(faults_of(both)) == 1
    shares = {"C1": 0.5, "C2": "half"}  # the sum is then for nobody to judge
    assert len(faults_of(with_key(GENERATED, "arrivals.option_share", shares))) == 1


def test_what_does_not_draw_on_a_faulty_place_is_told_beside_it():
    load = with_cell(RECORDED, "nodes.csv", 3, "load_kw", "x")
    assert len(faults_of(with_cell(load, "lines.csv", 3, "to_node", "z"))) == 2
    assert len(faults_of(with_cell(load, "profile.csv", 3, "generation_pu", ""))) == 2
    price = with_key(RECORDED, "option.0.price_per_kwh", "x")
    assert len(faults_of(with_cell(price, "arrivals.csv", 3, "option", "C9"))) == 2
    row = with_cell(RECORDED, "profile.csv", 3, "load_pu", "x")
    assert len(faults_of(with_cell(row, "profile.csv", 5, "interval", "1"))) == 3


@pytest.mark.parametrize("file", sorted(RECORDED))
def test_encodings(file):
    content = RECORDED[file]
    assert parse_scenario({**RECORDED, file: b"\xef\xbb\xbf" + content}) == parse_scenario(RECORDED)
    assert parse_scenario({**RECORDED, file: content.replace(b"\n", b"\r\n")}) == parse_scenario(
        RECORDED
    )
    for spoilt in (b"\xff\xfe" + content, content + b"\xe9", content.decode().encode("utf-16")):
        (fault,) = faults_of({**RECORDED, file: spoilt})
        assert fault.startswith(f"{file}: found byte 0x")
        assert fault.endswith("should be UTF-8 text")


@pytest.mark.parametrize("file", sorted(RECORDED))
def test_nul_bytes(file):
    for spoilt in (b"\0", b"\0" * 100, RECORDED[file] + b"\0", RECORDED[file][:20] + b"\0"):
        faults = faults_of({**RECORDED, file: spoilt})
        assert faults
        assert all(fault.startswith(file) for fault in faults)


@pytest.mark.parametrize(
    "toml",
    [
        *("=", "a = ", "[feeder", "x = 1\nx = 2", "[feeder]\n[feeder]", "\x01"),
        *(f"x = {'9' * 5000}", "x = " + "[" * 5000, "x = " + "{a=" * 3000),
    ],
)
def test_text_that_is_not_toml_is_the_only_fault(toml):
    (fault,) = faults_of({**RECORDED, "scenario.toml": toml.encode()})
    assert fault.startswith("scenario.toml: found text that is not TOML")


def test_numbers_of_any_length_are_told():
    digits = f"0x{'f' * 5000}"
    for key in ("seed", "vehicles_per_day"):
        (fault,) = faults_of(
            with_text(GENERATED, "scenario.toml", f"{key} = .*", f"{key} = {digits}")
        )
        assert "found a number too long to print" in fault
    assert faults_of(with_cell(RECORDED, "profile.csv", 2, "interval", "9" * 5000))


def test_rows_are_counted_as_a_spreadsheet_counts_them():
    rows = RECORDED["nodes.csv"].decode().splitlines()
    rows[2] = rows[2].replace("40.0", "much")
    blank_before = "\n".join([*rows[:2], "", *rows[2:]]).encode()
    (fault,) = faults_of({**RECORDED, "nodes.csv": blank_before})
    assert fault.startswith("nodes.csv, row 4, column load_kw: found 'much'")
    rows[1] = '"6\n34"' + rows[1].removeprefix("634")
    faults = faults_of({**RECORDED, "nodes.csv": "\n".join(rows).encode()})
    assert [fault.split(": ")[0] for fault in faults] == [
        "nodes.csv, row 2, column node",
        "nodes.csv, row 3, column load_kw",
    ]


@pytest.mark.parametrize(("row", "told"), [("1,2,3", "3 cells"), ("x," * 11 + "x", "12 cells")])
def test_wrong_number_of_cells_is_told_in_every_row(row, told):
    extra = f"{row}\n".encode() * 2
    faults = faults_of({**RECORDED, "nodes.csv": RECORDED["nodes.csv"] + extra})
    assert faults == [
        f"nodes.csv, row {n}: found {told}; should be 8, as in the header" for n in (5, 6)
    ]


def test_a_quote_never_closed_is_told():
    (fault,) = faults_of({**RECORDED, "nodes.csv": RECORDED["nodes.csv"] + b'"b'})
    assert fault.startswith("nodes.csv, row 5: found unexpected end of data")


def test_semicolons_are_told_by_the_header():
    faults = faults_of({**RECORDED, "lines.csv": RECORDED["lines.csv"].replace(b",", b";")})
    assert any("lines.csv, header: found unknown column" in fault for fault in faults)


def test_columns_in_any_order_and_left_out_where_they_may_be_blank():
    table = b"rating_kva,x_ohm,r_ohm,to_node,from_node\n300,0.1,0.1,a,634\n,0,0.2,b,a\n"
    assert parse_scenario({**RECORDED, "lines.csv": table}) == parse_scenario(RECORDED)
    plain = parse_scenario({**RECORDED, "nodes.csv": b"node\n634\na\nb\n"})
    assert [node.node for node in plain.nodes] == ["634", "a", "b"]


def test_names_that_look_like_numbers_stay_text():
    scenario = parse_scenario(RECORDED)
    assert scenario.feeder.source_node == "634"
    assert scenario.lines[0].name == "634-a"
    assert [arrival.vehicle for arrival in scenario.arrivals.vehicles] == ["1", "2"]
    renamed = {name: content.replace(b"634", b"0634.10") for name, content in RECORDED.items()}
    assert parse_scenario(renamed).feeder.source_node == "0634.10"


def arrival_at(text, start="2024-05-06T00:00", **keys):
    files = with_key(with_cell(RECORDED, "arrivals.csv", 2, "arrival", text), "start", start)
    files = with_cell(files, "arrivals.csv", 3, "arrival", start)
    for key, value in keys.items():
        files = with_key(files, key, value)
    return files


@pytest.mark.parametrize(
    ("clock", "start", "day", "hour"),
    [
        ("00:00", "2024-05-06T00:00", 6, 0),
        ("3:59", "2024-05-06T00:00", 6, 3),
        ("22:00", "2024-05-06T22:00", 6, 22),
        ("01:59", "2024-05-06T22:00", 7, 1),
        ("00:00", "2024-05-06T23:59", 7, 0),
    ],
)
def test_clock_time_is_its_first_occurrence_at_or_after_the_start(clock, start, day, hour):
    arrivals = parse_scenario(arrival_at(clock, start)).arrivals
    assert isinstance(arrivals, RecordedArrivals)
    moment = arrivals.vehicles[0].arrival
    assert (moment.day, moment.hour) == (day, hour)


@pytest.mark.parametrize("start", ["2024-05-06T22:00", "2024-05-06T22:30"])
def test_clock_time_past_midnight_with_a_toml_start(start):
    files = arrival_at("00:15", start)
    dated = with_text(files, "scenario.toml", f'"{start}"', f"{start}:00")
    assert parse_scenario(dated) == parse_scenario(files)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("24:00", "should be a local time"),
        ("08:60", "should be a local time"),
        ("08:00:00", "should be a local time"),
        ("8", "should be a local time"),
        ("2024-05-06 01:00", "should be a local time"),
        ("2024-05-06T01:00Z", "should be a local time"),
        ("2024-05-06T01:00+01:00", "should be a local time"),
        ("2024-05-05T23:59", "found 2024-05-05T23:59; should be from 2024-05-06T00:00 to before"),
        ("2024-05-06T04:00", "to before 2024-05-06T04:00"),
        ("23:59", "found 2024-05-06T23:59; should be from"),
    ],
)
def test_arrival_times_that_will_not_do(text, told):
    (fault,) = faults_of(arrival_at(text))
    assert fault.startswith("arrivals.csv, row 2, column arrival: found ")
    assert told in fault


def test_nobody_arrives_from_arrivals_until_on():
    last = START + timedelta(hours=2, minutes=-1)
    assert faults_of(arrival_at(f"{last:%Y-%m-%dT%H:%M}", arrivals_until=2)) == []
    (fault,) = faults_of(arrival_at("02:00", arrivals_until=2))
    assert "should be from 2024-05-06T00:00 to before 2024-05-06T02:00" in fault
    assert len(faults_of(arrival_at("00:00", arrivals_until=0))) == 2


def test_generators_keys_beside_a_file_are_told():
    (fault,) = faults_of(with_key(RECORDED, "arrivals.vehicles_per_day", 5.0))
    assert "unknown key 'vehicles_per_day'; keys are file, seed, forecast" in fault
    (fault,) = faults_of(with_key(RECORDED, "arrivals.forecast.seed", 5))
    assert "scenario.toml, arrivals.forecast: found unknown key 'seed'" in fault
