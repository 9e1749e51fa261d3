"""Every way to spoil a scenario is told: file, row, column, what was found, what is allowed."""

import pytest

from tests.files.spoiling import (
    faults_of,
    files_of,
    generated_scenario,
    recorded_scenario,
    with_cell,
    with_key,
    with_text,
    without_column,
)

RECORDED = files_of(recorded_scenario())
GENERATED = files_of(generated_scenario())
# file, a row of it, columns that hold a number that must be given, that may be blank, and names
TABLES = [
    ("nodes.csv", 3, (), ("load_kw", "load_kvar", "shunt_kvar", "rating_kva", "x", "y"), ("node",)),
    ("lines.csv", 2, ("r_ohm", "x_ohm"), ("rating_kva",), ("from_node", "to_node")),
    ("profile.csv", 3, ("price_per_kwh", "load_pu"), (), ()),
    ("arrivals.csv", 2, ("battery_kwh", "soc_in", "soc_out"), ("max_kw",), ("vehicle", "option")),
    ("fleet.csv", 2, ("share", "battery_kwh", "max_kw"), (), ("model",)),
]
REQUIRED = [(file, row, column) for file, row, must, _, _ in TABLES for column in must]
NUMBERS = REQUIRED + [(file, row, column) for file, row, _, may, _ in TABLES for column in may]
NAMES = [(file, row, column) for file, row, _, _, names in TABLES for column in names]
NUMBER_KEYS = [
    *(f"feeder.{key}" for key in ("source_voltage_pu", "voltage_min_pu", "voltage_max_pu")),
    *(f"feeder.{key}" for key in ("base_mva", "base_kv", "load_scale", "power_factor")),
    *(f"station.{key}" for key in ("min_kw", "max_kw", "efficiency")),
    *("option.0.price_per_kwh", "option.1.average_kw", "arrivals.vehicles_per_day"),
]
COUNT_KEYS = ["interval_minutes", "intervals", "arrivals_until", "station.chargers"]
COUNT_KEYS += ["arrivals.seed"]
TEXT_KEYS = ["name", "feeder.source_node", "station.node", "option.0.name"]


def told_once(files, *parts):
    """There is one fault and it says all of `parts`."""
    faults = faults_of(files)
    assert len(faults) == 1, faults
    for part in parts:
        assert part in faults[0]


def test_unspoilt_scenarios_are_valid():
    assert faults_of(RECORDED) == []
    assert faults_of(GENERATED) == []


@pytest.mark.parametrize("cell", NUMBERS, ids=str)
@pytest.mark.parametrize(
    ("text", "rule"),
    [
        *((text, "should be a number") for text in ("abc", "1,5", "0x10", "=1+1", "true", "1 000")),
        *((text, "should be a finite number") for text in ("nan", "inf", "-Infinity", "1e400")),
        ("1e300", "should be at most"),
    ],
)
def test_cell_that_is_no_usable_number(cell, text, rule):
    file, row, column = cell
    place = f"{file}, row {row}, column {column}: found '{text}'; {rule}"
    told_once(with_cell(RECORDED, *cell, text), place)


@pytest.mark.parametrize("cell", REQUIRED, ids=str)
def test_blank_cell_that_must_be_filled(cell):
    file, row, column = cell
    for blank in ("", "  "):
        spoilt = with_cell(RECORDED, *cell, blank)
        told_once(spoilt, f"{file}, row {row}, column {column}: found a blank; should be a number")


@pytest.mark.parametrize("cell", NAMES, ids=str)
@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "found a blank; should not be blank"),
        ("-1", "found '-1'; should begin with a letter or digit"),
        ("=cmd()", "should begin with a letter or digit"),
        ("a\x01b", "hold no control characters"),
        ("n" * 61, "should have at most 60 characters"),
    ],
)
def test_cell_that_is_no_name(cell, text, told):
    file, row, column = cell
    told_once(with_cell(RECORDED, *cell, text), f"{file}, row {row}, column {column}: ", told)


@pytest.mark.parametrize(
    ("cell", "text", "rule"),
    [
        (("nodes.csv", 3, "load_kw"), "-1", "at least 0 (Peak active load, kW)"),
        (("nodes.csv", 3, "generation_kw"), "-1", "at least 0"),
        (("lines.csv", 2, "rating_kva"), "-1", "at least 0"),
        (("lines.csv", 2, "r_ohm"), "-0.1", "at least 0"),
        (("profile.csv", 2, "interval"), "-1", "at least 0"),
        (("profile.csv", 2, "interval"), "0.5", "should be a whole number"),
        (("profile.csv", 2, "load_pu"), "-1", "at least 0"),
        (("profile.csv", 2, "generation_pu"), "", "should be given, as nodes.csv has generation"),
        (("arrivals.csv", 2, "soc_in"), "1.1", "at most 1"),
        (("arrivals.csv", 2, "soc_out"), "-0.1", "at least 0"),
        (("arrivals.csv", 2, "battery_kwh"), "0", "at least 0.1"),
        (("arrivals.csv", 2, "max_kw"), "0", "at least 0.01"),
        (("fleet.csv", 2, "share"), "-1", "at least 0"),
    ],
    ids=str,
)
def test_cell_out_of_range(cell, text, rule):
    file, row, column = cell
    told_once(with_cell(RECORDED, *cell, text), f"{file}, row {row}, column {column}: ", rule)


@pytest.mark.parametrize(
    ("cell", "text", "told"),
    [
        (("lines.csv", 3, "to_node"), "z", "lines.csv, row 3, column to_node: found 'z'"),
        (("lines.csv", 3, "to_node"), "634", "lines.csv, row 3: found a second line between"),
        (("lines.csv", 3, "to_node"), "a", "lines.csv, row 3: found a line from a to itself"),
        (("lines.csv", 2, "x_ohm"), "0", None),
        (("lines.csv", 3, "r_ohm"), "0", "lines.csv, row 3, column r_ohm: found 0 ohm"),
        (("arrivals.csv", 3, "option"), "C3", "column option: found 'C3'; should be one of C1, C2"),
        (("arrivals.csv", 3, "vehicle"), "1", "row 3, column vehicle: found '1' again"),
        (("arrivals.csv", 3, "soc_out"), "0.25", "column soc_out: found 0.25; should be above"),
        (("profile.csv", 5, "interval"), "2", "row 5, column interval: found 2 again"),
    ],
    ids=str,
)
def test_cells_that_disagree(cell, text, told):
    faults = faults_of(with_cell(RECORDED, *cell, text))
    assert not faults if told is None else any(told in fault for fault in faults), faults


@pytest.mark.parametrize("file", ["nodes.csv", "lines.csv", "profile.csv", "arrivals.csv"])
def test_repeated_row_is_told(file):
    last = RECORDED[file].decode().splitlines()[-1]
    faults = faults_of({**RECORDED, file: RECORDED[file] + last.encode() + b"\n"})
    assert len(faults) == 1
    assert f"{file}, row {len(RECORDED[file].splitlines()) + 1}" in faults[0]


@pytest.mark.parametrize("key", NUMBER_KEYS)
@pytest.mark.parametrize(
    ("value", "told"),
    [
        ("5", "found '5'; should be a number"),
        (True, "found true; should be a number"),
        (float("nan"), "should be a finite number"),
        (float("inf"), "should be a finite number"),
        (1e300, "should be "),
        (-1, "should be "),
        ([1], "found a list of 1; should be a number"),
        ({}, "found a table; should be a number"),
        (None, "found nothing; should be given"),
    ],
    ids=str,
)
def test_key_that_is_no_usable_number(key, value, told):
    place = key.replace("option.0", "option.C1").replace("option.1", "option.C2")
    told_once(with_key(GENERATED, key, value), f"scenario.toml, {place}: ", told)


@pytest.mark.parametrize(
    "key",
    [
        *("feeder.base_mva", "feeder.base_kv", "feeder.power_factor", "station.max_kw"),
        *("station.efficiency", "option.1.average_kw"),
    ],
)
def test_divisor_too_small_to_compute_with(key):
    for value in (0, 1e-300):
        faults = faults_of(with_key(GENERATED, key, value))
        assert any("should be at least " in fault for fault in faults), faults


@pytest.mark.parametrize("key", COUNT_KEYS)
@pytest.mark.parametrize("value", ["5", True, 1.5, 1.0, -1, 10**30, [], {}], ids=str)
def test_key_that_is_no_usable_count(key, value):
    complete = with_key(GENERATED, "arrivals_until", 3)
    told_once(with_key(complete, key, value), f"scenario.toml, {key}: found ", "; should be ")


@pytest.mark.parametrize("key", TEXT_KEYS)
@pytest.mark.parametrize("value", [5, 1.5, True, "", [], {}, None], ids=str)
def test_key_that_is_no_text(key, value):
    place = key.replace("option.0", "option.1")  # an option without name goes by its number
    told_once(with_key(GENERATED, key, value), f"scenario.toml, {place}: found ", "; should ")


@pytest.mark.parametrize("value", [0, 2, "1", 1.0, True, None, {}], ids=str)
def test_format_is_1(value):
    told_once(with_key(GENERATED, "format", value), "scenario.toml, format: found ", "; should be ")


@pytest.mark.parametrize("table", ["feeder", "station", "arrivals"])
@pytest.mark.parametrize("value", ["abc", 5, True, 1.5, [], [1, 2], None], ids=str)
def test_table_that_is_none(table, value):
    """Whatever it is to hold is then not told missing, nor are its files told unknown."""
    told_once(with_key(GENERATED, table, value), f"scenario.toml, {table}: found ")


@pytest.mark.parametrize("value", ["abc", 5, True, {"a": 1}, [], None], ids=str)
def test_options_that_are_none(value):
    told_once(with_key(GENERATED, "option", value), "scenario.toml, option: found ")


def test_every_option_that_is_none_is_told():
    faults = faults_of(with_key(GENERATED, "option", [1, 2]))
    assert [fault.split(":")[0] for fault in faults] == [
        "scenario.toml, option.1",
        "scenario.toml, option.2",
    ]


@pytest.mark.parametrize("key", ["", "feeder.", "station.", "option.0.", "arrivals."])
def test_unknown_key(key):
    spoilt = with_key(GENERATED, f"{key}colour", 1)
    told_once(spoilt, "scenario.toml", "found unknown key 'colour'; keys are ")


@pytest.mark.parametrize("table", ["nodes", "lines", "profile"])
def test_table_of_a_file_is_no_key(table):
    told_once(with_key(GENERATED, table, []), f"unknown key '{table}'; goes in {table}.csv")


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("arrivals.hourly_share", [1.0] * 23, "at least 24 entries, has 23"),
        ("arrivals.hourly_share", [1.0] * 25, "at most 24 entries, has 25"),
        ("arrivals.hourly_share", [1.0] * 23 + ["a"], "hourly_share, entry 24: found 'a'"),
        ("arrivals.hourly_share", [1.0] * 23 + [-1], "entry 24: found -1; should be at least 0"),
        ("arrivals.hourly_share", [0.0] * 24, "a sum of 0"),
        ("arrivals.option_share", {"C1": 0.5, "C2": 0.6}, "a sum of 1.1; should sum to 1"),
        ("arrivals.option_share", {}, "a sum of 0; should sum to 1"),
        ("arrivals.option_share", {"C1": 0.5, "C3": 0.5}, "found 'C3'; should be one of C1, C2"),
        ("arrivals.option_share", {"C1": 2, "C2": -1}, "should be at most 1"),
        ("arrivals.soc_in_beta", [2.3], "found nothing; should be given"),
        ("arrivals.soc_in_beta", [], "found nothing; should be given"),
        ("arrivals.soc_in_beta", [0, 1.7], "entry 1: found 0; should be at least 0.01"),
        ("arrivals.soc_in_beta", [1, 2, 3], "entries"),
        ("arrivals.soc_out", [0.9, 0.8], "low first"),
        ("arrivals.soc_out", [0.9, 1.1], "entry 2: found 1.1; should be at most 1"),
        ("arrivals.fleet", "other.csv", "other.csv: found no such file"),
        ("arrivals.fleet", "", "found a blank; should be the name of a CSV file"),
        ("arrivals.fleet", "nodes.csv", "should be the name of a CSV file of its own"),
        ("arrivals.seed", -1, "at least 0"),
        ("interval_minutes", 25, "should divide 60"),
        ("interval_minutes", 4, "at least 5"),
        ("interval_minutes", 120, "at most 60"),
        ("intervals", 5, "profile.csv: found no row for interval 4"),
        ("intervals", 3, "profile.csv, row 5, column interval: found 3; should be below"),
        ("arrivals_until", 5, "should be at most the number of intervals, 4"),
        ("station.node", "s", "should not be the source node"),
        ("station.node", "z", "should be a node of nodes.csv"),
        ("feeder.source_node", "z", "should be a node of nodes.csv"),
        ("feeder.voltage_min_pu", 1.1, "should be below voltage_max_pu"),
        ("station.min_kw", 11, "should be at most max_kw"),
        ("option.0.average_kw", 10.5, "option.C1.average_kw: found 10.5 kW; should be at most"),
        ("option.1.name", "C1", "found 'C1' again"),
    ],
    ids=str,
)
def test_settings_that_will_not_do(key, value, told):
    faults = faults_of(with_key(GENERATED, key, value))
    assert any(told in fault for fault in faults), faults


@pytest.mark.parametrize(
    "start",
    ["2024-05-06", "2024-05-06T00:00Z", "2024-05-06T00:00+02:00", "2024-02-30T00:00", "08:00", 5],
)
def test_start_that_is_no_local_time(start):
    told_once(with_key(GENERATED, "start", start), "start: found ", "should be a local time")


@pytest.mark.parametrize(
    ("toml", "told"),
    [
        ("2024-05-06T00:00:00Z", "without time zone"),
        ("2024-05-06T00:00:00+02:00", "without time zone"),
        ("2024-05-06T00:00:30", "a whole minute"),
        ("2024-05-06", "should be a local time"),
        ("00:00:00", "should be a local time"),
        ("1500-05-06T00:00:00", "should be in a year from 1900 to 2999"),
        ("9999-12-31T23:59:00", "should be in a year from 1900 to 2999"),
    ],
)
def test_start_as_toml_date(toml, told):
    spoilt = with_text(RECORDED, "scenario.toml", r'start = "[^"]*"', f"start = {toml}")
    told_once(spoilt, "scenario.toml, start: found ", told)


@pytest.mark.parametrize("file", ["nodes.csv", "lines.csv", "profile.csv", "arrivals.csv"])
def test_columns(file):
    columns = RECORDED[file].decode().splitlines()[0].split(",")
    must = {column for name, _, must, _, names in TABLES if name == file for column in must + names}
    for column in columns:
        faults = faults_of(without_column(RECORDED, file, column))
        if column in must:
            assert faults == [f for f in faults if f"{file}, header, column {column}" in f] != []
    unknown = RECORDED[file].replace(columns[0].encode(), b"colour", 1)
    assert any("unknown column 'colour'" in f for f in faults_of({**RECORDED, file: unknown}))
    twice = RECORDED[file].replace(columns[1].encode(), columns[0].encode(), 1)
    assert any("2 times" in fault for fault in faults_of({**RECORDED, file: twice}))


@pytest.mark.parametrize("file", ["nodes.csv", "lines.csv", "profile.csv", "fleet.csv"])
def test_missing_and_empty_files(file):
    absent = {name: content for name, content in GENERATED.items() if name != file}
    told_once(absent, f"{file}: found no such file")
    faults = faults_of({**GENERATED, file: b""})
    assert faults
    assert all(fault.startswith(f"{file}, header, column ") for fault in faults)
    header = GENERATED[file].splitlines()[0]
    told_once({**GENERATED, file: header}, file)


def test_missing_settings_are_the_only_fault():
    absent = {name: content for name, content in GENERATED.items() if name != "scenario.toml"}
    told_once(absent, "scenario.toml: found no such file")


def test_unknown_file():
    told_once({**GENERATED, "notes.txt": b""}, "notes.txt: found a file that nothing refers to")
    assert faults_of({**GENERATED, "README.md": b"\xff"}) == []
