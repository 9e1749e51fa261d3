"""Names reach the terminal as they are written: no emoji, no markup, no command to the terminal."""

import ast
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from evdash.cli.main import main
from evdash.domain.scenario import Scenario
from evdash.errors import printable
from evdash.files.scenario_folder import scenario_files
from tests.builders import OPTIONS, line, make_scenario, node, vehicle

CLI = Path(__file__).parents[2] / "evdash" / "cli"
TAGS = ":smile:[bold red][/]\\[x]\u200b"
"""What rich or a terminal would take for something else than text, all that a name may hold."""
COMMANDS = f"{TAGS}\x9b2J\u202e\x1b[31m\x1b]0;title\x07"
"""The same with what only files, arguments and wrong input hold."""


FILE_TAGS = COMMANDS.replace("/", "")


def named(name: str) -> str:
    return f"{name}{TAGS}"


def day() -> Scenario:
    """Four hours in which the line is full and outside its own limit; every name is nasty."""
    s, a, b = named("s"), named("a"), named("b")
    options = [{**option, "name": named(option["name"])} for option in OPTIONS]
    return make_scenario(
        name=named("day"),
        nodes=[node(s), node(a, load_kw=40), node(b, load_kw=20)],
        lines=[line(s, a, rating=75.0), line(a, b, rating=15.0)],
        price=(0.1, 0.3, 0.2, 0.05),
        feeder={"source_node": s},
        station={"node": a},
        options=options,
        vehicles=[
            vehicle(named(f"V{n}"), n / 4, need_kwh=12 + n, option=named("C1")) for n in range(12)
        ],
    )


EVENTS = (
    "interval,event,subject,value,from_interval,until_interval\n1,chargers,,0,,\n1,no_show,{},,,\n"
)
STUDY = """
format = 1
name = {name}
question = {question}
base = "day"
policies = ["p1", "fcfs"]
seeds = {{first = 1, count = 1}}
[[axis]]
name = {axis}
key = "station.chargers"
values = [1, 2]
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The scenario, the same with events, one with a name that is refused, and a study."""
    place = tmp_path_factory.mktemp("names")
    for folder in ("day", "events", "refused"):
        (place / folder).mkdir()
        for name, text in scenario_files(day()).items():
            (place / folder / name).write_text(text, encoding="utf-8", newline="")
    happened = EVENTS.format(f'"{named("V0")}"')
    (place / "events" / "events.csv").write_text(happened, encoding="utf-8", newline="")
    settings = place / "refused" / "scenario.toml"
    told = settings.read_text(encoding="utf-8")
    commands = toml(f"day{COMMANDS}")
    changed = re.sub(r"^name = .*", lambda _: f"name = {commands}", told, count=1, flags=re.M)
    assert changed != told
    settings.write_text(changed, encoding="utf-8")
    (place / "study.toml").write_text(
        STUDY.format(
            name=toml(named("study")), question=toml(f"why{COMMANDS}"), axis=toml(named("axis"))
        ),
        encoding="utf-8",
    )
    return place


def toml(text: str) -> str:
    escaped = "".join(c if c.isprintable() and c not in '"\\' else f"\\u{ord(c):04x}" for c in text)
    return f'"{escaped}"'


def commands(place: Path) -> Iterator[tuple[str, list[str], str]]:
    """Every command: a title, its arguments, and a name that it must tell, its tags left out."""
    scenario, run = f"{place / 'day'}", f"{place / 'run'}{FILE_TAGS}"
    b = named("b")
    yield "run", ["run", scenario, "--out", run], "day"
    yield "explain", ["run", scenario, "--explain"], "V9"
    yield "ac", ["run", scenario, "--network", "ac"], "transformer a"
    yield "events", ["run", f"{place / 'events'}"], "V0"
    yield "damage", ["run", scenario, "--policy", "uncoordinated"], "transformer s"
    yield "validate", ["validate", scenario], "day"
    yield "audit", ["audit", run], "day"
    yield "race", ["race", scenario, "--policies", "p1", "fcfs", "--out", f"{run}-race"], "day"
    study = f"{place / 'study.toml'}"
    yield "study", ["study", study, "--out", f"{run}-s", "--workers", "1"], "why"
    yield "export", ["export", run, "--report", f"{run}.html"], "run"
    yield "feeder", ["import", "feeder", scenario, "--into", f"{run}-i", "--station", b], "run"
    yield "template", ["import", "template", f"{run}-t"], "run"
    yield "unknown key", ["run", scenario, "--set", f"{COMMANDS}=1"], ""
    yield "unknown option", ["run", scenario, "--set", f"option.X{COMMANDS}.price_per_kwh=1"], "X"
    yield "refused", ["validate", f"{place / 'refused'}"], "day"
    yield "no such folder", ["validate", f"{run}-none"], "run"
    yield "no such argument", ["validate", scenario, named("one more")], "one more"


@pytest.mark.parametrize("coloured", [False, True])
def test_no_command_takes_a_name_for_anything_else(place, capfd, monkeypatch, coloured, tmp_path):
    if coloured:
        monkeypatch.setenv("FORCE_COLOR", "1")
        monkeypatch.setenv("TERM", "xterm-256color")
    there = place if not coloured else tmp_path
    if coloured:
        for name in ("day", "events", "refused", "study.toml"):
            (tmp_path / name).symlink_to(place / name)
    shown = r":smile:\[bold red\]\[/?\]"  # a file's name holds no slash
    for title, arguments, name in commands(there):
        capfd.readouterr()
        try:
            status = main(arguments)
        except SystemExit as stop:
            status = int(stop.code or 0)
        told = "".join(capfd.readouterr())
        assert status != 1, (title, told)
        if coloured:
            assert title == "no such argument" or "\x1b[" in told, title
            told = re.sub(r"\x1b\[[0-9;?]*[mKAlh]", "", told)
        for what in ("\x1b", "\x9b", "\x07", "\u202e", "\u200b", "😄"):
            assert what not in told, (title, what, told)
        assert re.search(re.escape(name) + shown, told), (title, told)


def test_tables_hold_names_whole_where_there_is_room(place, capfd, monkeypatch):
    monkeypatch.setenv("COLUMNS", "400")
    main(["run", str(place / "day")])
    assert f"line:{printable(named('s'))}-{printable(named('a'))}" in capfd.readouterr().out
    main(["race", str(place / "day"), "--policies", "p1", "fcfs"])
    assert f"Acceptance of {printable(named('C1'))}, %" in capfd.readouterr().out


def test_there_is_one_way_to_the_terminal():
    """No module of the command line but one makes a console, escapes markup or prints."""
    for file in CLI.glob("*.py"):
        if file.name == "terminal.py":
            continue
        used = {
            f"{node.module}.{name.name}"
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
            if isinstance(node, ast.ImportFrom)
            for name in node.names
        }
        assert {n for n in used if n.startswith("rich.")} <= {"rich.table.Table", "rich.text.Text"}


@pytest.mark.parametrize(
    "arguments", [["run"], ["--help"], ["export", "--help"], ["validate", "x"]]
)
def test_an_output_that_cannot_hold_every_name_is_told_before_any_work(arguments):
    done = subprocess.run(
        [sys.executable, "-m", "evdash", *arguments],
        env=os.environ | {"PYTHONIOENCODING": "iso8859-1"},
        capture_output=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (2, b"")
    assert b"Traceback" not in done.stderr
    assert b"standard output: found the encoding iso8859-1; should be UTF-8" in done.stderr


LONG = "n" * 300


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "DAY", "--out", LONG],
        ["run", LONG],
        ["validate", LONG],
        ["audit", LONG],
        ["race", "DAY", "--out", LONG],
        ["study", LONG, "--out", "x"],
        ["study", "STUDY", "--out", LONG],
        ["export", LONG, "--report", "x.html"],
        ["export", "DAY", "--report", f"{LONG}.html"],
        ["import", "template", LONG],
        ["import", "feeder", LONG, "--into", "x"],
        ["import", "feeder", "DAY", "--into", LONG],
        ["import", "sessions", LONG, "--into", "x"],
        ["import", "prices", LONG, "--into", "x"],
        ["import", "workbook", LONG, "--into", "x"],
    ],
)
def test_a_name_too_long_is_told_in_words(arguments, place, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    known = {"DAY": place / "day", "STUDY": place / "study.toml"}
    status, out, err = command(*(known.get(argument, argument) for argument in arguments))
    assert status == 2, (out, err)
    assert "evdash failed" not in err
    assert "Traceback" not in err
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]
