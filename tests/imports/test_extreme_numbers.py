"""Networks with one number no feeder has, and files nested without end: told in words, quickly."""

import contextlib
import json
import math
from collections.abc import Iterator
from typing import Any

import pandapower as pp
import pytest

from evdash.cli.main import main
from evdash.errors import InputError
from evdash.files.bundled import DEFAULT
from evdash.files.draft import draft_of, scenario_of
from evdash.files.nested import MOST_LEVELS, read_json, read_toml
from evdash.files.scenario_folder import read_scenario
from evdash.grid.nets.records import RECORDS, Element
from evdash.imports.feeder import feeder_of_net, with_network
from evdash.imports.pandapower_json import read_net
from tests.imports.networks import two_levels

EXTREMES = (0, -5, 5e-324, -1e-300, 1e308, 1e9, 10**400, "x", "", None, True, [1], {"a": 1})
NOT_JSON = ("NaN", "Infinity", "-Infinity")


def network() -> Any:
    """One of every element that is read."""
    net = two_levels()
    a, b = net.bus.index[0], net.bus.index[-1]
    pp.create_load(net, b, 0.02, 0.01)
    pp.create_sgen(net, b, 0.01)
    pp.create_storage(net, b, 0.01, max_e_mwh=1.0)
    pp.create_shunt(net, b, 0.01)
    pp.create_ward(net, b, 0.01, 0.0, 0.01, 0.0)
    pp.create_switch(net, a, net.line.index[0] if len(net.line) else 0, et="l", closed=True)
    return net


def tables() -> dict[str, Any]:
    return json.loads(pp.to_json(network()))


def changed(told: dict[str, Any], table: str, column: str, value: object) -> bytes | None:
    """The file with every cell of a column replaced; None where it has no such column."""
    frame = json.loads(told["_object"][table]["_object"])
    if column not in frame["columns"] or not frame["data"]:
        return None
    at = frame["columns"].index(column)
    for row in frame["data"]:
        row[at] = value
    content = dict(told["_object"])
    content[table] = dict(content[table], _object=json.dumps(frame))
    return json.dumps(dict(told, _object=content)).encode()


def columns() -> Iterator[tuple[str, str]]:
    for table, record in RECORDS.items():
        for column in set(record.model_fields) - set(Element.model_fields) - {"x", "y"}:
            yield table, column


@pytest.fixture(scope="module")
def told() -> dict[str, Any]:
    return tables()


@pytest.fixture(scope="module")
def draft() -> Any:
    return draft_of(read_scenario(DEFAULT))


@pytest.mark.parametrize(("table", "column"), sorted(columns()))
def test_a_number_no_feeder_has_is_refused_in_words_or_a_right_import(
    table: str, column: str, told: dict[str, Any], draft: Any
) -> None:
    seen = 0
    for value in EXTREMES:
        content = changed(told, table, column, value)
        if content is None:
            continue
        seen += 1
        with contextlib.suppress(InputError):
            net, unread = read_net("net.json", content)
            lines = scenario_of(with_network(draft, feeder_of_net(net, unread))[0]).lines
            assert all(math.isfinite(x.r_ohm) and math.isfinite(x.x_ohm) for x in lines), value
    assert seen or column not in told  # pandapower writes nearly all of them


@pytest.mark.parametrize(
    "cell", [("line", "df", -5), ("bus", "vn_kv", 5e-324), ("ext_grid", "vm_pu", 5e-324)]
)
def test_the_command_line_says_where_it_is(
    cell: tuple[str, str, float], told: dict[str, Any], tmp_path: Any, capsys: Any
) -> None:
    table, column, value = cell
    file = tmp_path / "net.json"
    file.write_bytes(changed(told, table, column, value) or b"")
    assert main(["import", "feeder", str(file), "--into", str(tmp_path / "new")]) == 2
    said = capsys.readouterr().err
    assert f"table {table}" in said or f"{table} 0" in said
    assert column in said
    assert not (tmp_path / "new").exists()


def deep(levels: int, *, kind: str) -> str:
    return {
        "lists": "x = " + "[" * levels + "]" * levels,
        "tables": "x = " + "{a = " * levels + "1" + "}" * levels,
        "keys": ".".join(["a"] * levels) + " = 1",
        "quoted keys": ".".join(['"a b"'] * levels) + " = 1",
        "head": "[" + " . ".join(["a"] * levels) + "]",
    }[kind]


@pytest.mark.parametrize("kind", ["lists", "tables", "keys", "quoted keys", "head"])
@pytest.mark.parametrize("levels", [400, 700, 20_000])
def test_toml_nested_without_end_is_refused_at_once(kind: str, levels: int) -> None:
    with pytest.raises(ValueError, match="nested more than"):
        read_toml(deep(levels, kind=kind))
    read_toml(deep(MOST_LEVELS - 2, kind=kind))


def test_brackets_and_dots_in_texts_numbers_and_comments_are_no_levels() -> None:
    much = "[" * 99 + "a." * 99
    text = (
        f'a = "{much}"\nb = \'{much}\' # {much}\nc = """\n{much}\n"""\n'
        f"d = '''{much}'''\nf = [{', '.join(['0.5'] * 99)}]\n"
    )
    assert len(read_toml(text)["f"]) == 99
    assert read_json(json.dumps({"a": much + '"\\'}))["a"].endswith('"\\')


@pytest.mark.parametrize("levels", [400, 700, 500_000])
def test_json_nested_without_end_is_refused_at_once(levels: int) -> None:
    for text in ("[" * levels, '{"a":' * levels):
        with pytest.raises(ValueError, match="nested more than"):
            read_json(text)
        with pytest.raises(InputError, match=r"nested more than|lists and objects"):
            read_net("net.json", text.encode())


@pytest.mark.parametrize("levels", [400, 700, 20_000])
def test_every_file_a_person_brings_is_looked_at_first(
    levels: int, tmp_path: Any, capsys: Any
) -> None:
    (tmp_path / "scenario").mkdir()
    text = (DEFAULT / "scenario.toml").read_text(encoding="utf-8")
    for file in DEFAULT.iterdir():
        (tmp_path / "scenario" / file.name).write_bytes(file.read_bytes())
    (tmp_path / "run").mkdir()
    nested = deep(levels, kind="keys")
    (tmp_path / "scenario" / "scenario.toml").write_text(f"{nested}\n{text}", encoding="utf-8")
    (tmp_path / "study.toml").write_text(nested, encoding="utf-8")
    (tmp_path / "run" / "summary.json").write_text('{"a":' * levels, encoding="utf-8")
    (tmp_path / "net.json").write_text("[" * levels, encoding="utf-8")
    for command in (
        ["validate", tmp_path / "scenario"],
        ["run", tmp_path / "scenario"],
        ["run", "--set", f"{'.'.join(['a'] * levels)}=1"],
        ["run", "--set", f"station.chargers={'[' * levels}"],
        ["study", tmp_path / "study.toml", "--out", tmp_path / "out"],
        ["audit", tmp_path / "run"],
        ["export", tmp_path / "run", "--report", tmp_path / "report.html"],
        ["import", "feeder", tmp_path / "net.json", "--into", tmp_path / "new"],
    ):
        assert main([str(part) for part in command]) == 2, command[0]
        said = capsys.readouterr().err
        assert said
        assert "evdash failed" not in said
