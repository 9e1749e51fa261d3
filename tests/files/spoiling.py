"""A valid scenario folder as bytes, ways to spoil it, and the faults that are then told."""

import csv
import io
import re
from collections.abc import Mapping

import tomlkit

from evdash.domain.arrivals import ArrivalStatistics, RecordedArrivals
from evdash.errors import InputError
from evdash.files.scenario_folder import parse_scenario, scenario_files
from tests.builders import generator, line, make_scenario, node, vehicle

Files = Mapping[str, bytes]


def recorded_scenario():
    """Arrivals from file, a forecast beside them, every table in use."""
    statistics = {key: value for key, value in generator().items() if key != "seed"}
    plain = make_scenario(
        nodes=[
            node("634"),
            node("a", load_kw=40, load_kvar=10, generation_kw=5, rating_kva=200, x=1, y=-2.5),
            node("b", load_kw=20, shunt_kvar=30),
        ],
        lines=[line("634", "a", rating=300), line("a", "b", 0.2, 0.0)],
        feeder={"source_node": "634"},
        station={"node": "b"},
        vehicles=[vehicle("1", 0.5, 12, max_kw=7.4), vehicle("2", 1, 8, option="C2")],
    )
    arrivals = RecordedArrivals(
        vehicles=plain.arrivals.vehicles,
        seed=7,
        forecast=ArrivalStatistics.model_validate(statistics),
    )
    return plain.replacing(arrivals=arrivals)


def generated_scenario():
    return make_scenario(arrivals=generator())


def files_of(scenario) -> dict[str, bytes]:
    return {name: text.encode() for name, text in scenario_files(scenario).items()}


def with_cell(files: Files, file: str, row: int, column: str, text: str) -> dict[str, bytes]:
    """One cell changed; `row` as a spreadsheet counts, the header being row 1."""
    table = list(csv.reader(io.StringIO(files[file].decode())))
    table[row - 1][table[0].index(column)] = text
    return {**files, file: _table_bytes(table)}


def without_column(files: Files, file: str, column: str) -> dict[str, bytes]:
    table = list(csv.reader(io.StringIO(files[file].decode())))
    index = table[0].index(column)
    return {**files, file: _table_bytes([row[:index] + row[index + 1 :] for row in table])}


def _table_bytes(table) -> bytes:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(table)
    return text.getvalue().encode()


def with_key(files: Files, key: str, value: object) -> dict[str, bytes]:
    """One key of scenario.toml set to `value`; options by their place, `option.0.name`."""
    settings = tomlkit.parse(files["scenario.toml"].decode()).unwrap()
    *way, last = [int(part) if part.isdigit() else part for part in key.split(".")]
    table = settings
    for part in way:
        table = table[part]
    if value is None:
        del table[last]
    else:
        table[last] = value
    return {**files, "scenario.toml": tomlkit.dumps(settings).encode()}


def with_text(files: Files, file: str, found: str, instead: str) -> dict[str, bytes]:
    """Text of a file exchanged; it must occur."""
    text = files[file].decode()
    assert re.search(found, text), f"{found!r} not in {file}"
    return {**files, file: re.sub(found, instead, text, count=1).encode()}


def faults_of(files: Files, *settings) -> list[str]:
    """Every fault told, in words; none if the scenario is valid."""
    try:
        parse_scenario(files, settings)
    except InputError as error:
        return [str(fault) for fault in error.faults]
    return []
