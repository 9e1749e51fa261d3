"""`import` from the command line: what comes in runs, and what is faulty changes nothing."""

from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from evdash.files.bundled import DEFAULT
from evdash.files.draft import draft_of
from evdash.files.scenario_folder import read_scenario
from evdash.imports.scenario_book import scenario_workbook
from evdash.imports.workbook import written

Command = Callable[..., tuple[int, str, str]]


@pytest.mark.parametrize(("name", "network"), [("case33bw", "lindistflow"), ("cigre_mv", "ac")])
def test_a_network_by_name_runs(command: Command, tmp_path: Path, name: str, network: str) -> None:
    status, out, _ = command("import", "feeder", name, "--into", tmp_path / "s")
    assert status == 0
    assert "AC power flow at full load" in out
    assert command("validate", tmp_path / "s")[0] == 0
    status, _, _ = command(
        "run", tmp_path / "s", "--network", network, "--set", "intervals=3", "--set",
        "arrivals_until=3", "--set", "station.chargers=2", "--out", tmp_path / "out",
    )  # fmt: skip
    assert status == 2  # the profile has more rows than three intervals: told, nothing written
    status, _, _ = command("run", tmp_path / "s", "--network", network, "--out", tmp_path / "out")
    assert status == 0
    assert command("audit", tmp_path / "out")[0] == 0


def test_what_is_faulty_leaves_the_folder_as_it_was(command: Command, tmp_path: Path) -> None:
    folder = tmp_path / "s"
    assert command("import", "feeder", "four_bus", "--into", folder)[0] == 0
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    for arguments in (
        ("feeder", "nowhere.json"),
        ("feeder", "mv_oberrhein"),
        ("feeder", "case33bw", "--station", "nowhere"),
        ("feeder", "case33bw", "--set", "station.colour=3"),
    ):
        status, _, err = command("import", *arguments, "--into", folder)
        assert status == 2
        assert "fault" in err
        assert "Traceback" not in err
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    assert command("import", "feeder", "four_bus", "--into", tmp_path / "s" / "nodes.csv")[0] == 2


def test_a_workbook_brings_the_feeder_and_its_faults_by_sheet_and_row(
    command: Command, tmp_path: Path
) -> None:
    other = DEFAULT.parent / "voltage-limited"
    book = tmp_path / "mine.xlsx"
    book.write_bytes(scenario_workbook(draft_of(read_scenario(other))))
    assert command("import", "feeder", book, "--into", tmp_path / "s")[0] == 0
    there, want = read_scenario(tmp_path / "s"), read_scenario(other)
    assert (there.nodes, there.lines, there.feeder) == (want.nodes, want.lines, want.feeder)
    nodes = pd.read_excel(book, "nodes", dtype={"node": str})
    nodes["load_kw"] = nodes["load_kw"].astype(object)
    nodes.loc[3, "load_kw"] = "lots"
    lines = pd.read_excel(book, "lines", dtype={"from_node": str, "to_node": str})
    sheets = {
        name: [list(frame.columns), *frame.astype(object).where(frame.notna(), None).values]
        for name, frame in (("nodes", nodes), ("lines", lines))
    }
    book.write_bytes(written(sheets))
    status, _, err = command("import", "feeder", book, "--into", tmp_path / "t")
    assert status == 2
    assert "mine.xlsx, sheet nodes, row 5, column load_kw: found 'lots'" in err
    assert not (tmp_path / "t").exists()


def test_a_runs_workbook_comes_in_as_the_scenario_it_was(
    command: Command, small_run: Path, small_scenario: Path, tmp_path: Path
) -> None:
    book = tmp_path / "run.xlsx"
    assert command("export", small_run, "--excel", book)[0] == 0
    status, out, _ = command("import", "workbook", book, "--into", tmp_path / "s")
    assert status == 0
    assert "What came of a day is left out" in out
    want = read_scenario(small_scenario)
    there = read_scenario(tmp_path / "s")
    assert (there.nodes, there.lines, there.profile) == (want.nodes, want.lines, want.profile)
    assert len(there.arrivals.vehicles) == len(want.arrivals.vehicles)
    status, _, err = command(
        "import", "workbook", book, "--into", tmp_path / "t", "--set", "station.chargers=-1"
    )
    assert status == 2
    assert "run.xlsx, sheet scenario, row" in err
    assert ", station.chargers: found -1" in err
    assert command("import", "workbook", tmp_path / "s" / "nodes.csv", "--into", tmp_path)[0] == 2


def test_a_template_comes_in_again_and_runs(command: Command, tmp_path: Path) -> None:
    status, out, _ = command("import", "template", tmp_path / "t")
    assert status == 0
    assert "scenario.xlsx" in out
    assert command("run", tmp_path / "t" / "scenario")[0] == 0
    into = ("--into", tmp_path / "s")
    assert command("import", "workbook", tmp_path / "t" / "scenario.xlsx", *into)[0] == 0
    for kind in ("sessions", "prices", "loads"):
        table = tmp_path / "t" / f"{kind}.csv"
        assert command("import", kind, table, "--accept", *into)[0] == 0, kind
    assert command("run", tmp_path / "s")[0] == 0
    status, _, err = command("import", "template", tmp_path / "t")
    assert status == 2
    assert "--force" in err


def hourly(column: str, values: list[float], first: str = "2024-03-31") -> str:
    times = pd.date_range(first, periods=len(values), freq="1h", tz="Europe/Berlin")
    rows = [f"{time:%d.%m.%Y %H:%M},{value}" for time, value in zip(times, values, strict=True)]
    return "\n".join([f"time,{column}", *rows, ""])


def test_prices_and_loads_by_date_and_time_run(command: Command, tmp_path: Path) -> None:
    folder = tmp_path / "s"
    prices, loads = tmp_path / "prices.csv", tmp_path / "loads.csv"
    prices.write_text(hourly("price_eur_mwh", [10.0 * h for h in range(26)]))
    loads.write_text(hourly("load", [4.0 + h % 5 for h in range(26)]))
    common = ("--zone", "Europe/Berlin", "--from", "2024-03-31", "--into", folder)
    status, _, err = command("import", "prices", prices, *common)
    assert status == 2
    assert "proposed time=time, price=price_eur_mwh; confirm with --accept" in err
    assert not folder.exists()
    status, out, _ = command("import", "prices", prices, "--accept", *common)
    assert status == 0
    assert "price_per_kwh is price_eur_mwh in $/MWh" in out
    status, _, err = command("import", "loads", loads, "--accept", *common)
    assert status == 2
    assert "unit of load: found none; should be kW, MW, pu" in err
    status, out, _ = command(
        "import", "loads", loads, "--accept", "--unit", "load=MW",
        "--peak-kw", "load=10000", *common,
    )  # fmt: skip
    assert status == 0
    assert "per unit of the stated peak, 10,000 kW" in out
    scenario = read_scenario(folder)
    assert [row.price_per_kwh for row in scenario.profile] == [h / 100 for h in range(24)]
    assert [row.load_pu for row in scenario.profile] == [(4 + h % 5) / 10 for h in range(24)]
    assert command("run", folder, "--out", tmp_path / "out")[0] == 0
    assert command("audit", tmp_path / "out")[0] == 0


def test_a_week_of_prices_is_a_week_of_days(command: Command, tmp_path: Path) -> None:
    week = tmp_path / "week.csv"
    week.write_text(hourly("price_per_kwh", [h / 1000 for h in range(168)], "2024-05-06"))
    options = ("--accept", "--zone", "Europe/Berlin", "--from", "2024-05-06", "--days", "7")
    assert command("import", "prices", week, *options, "--into", tmp_path / "s")[0] == 0
    scenario = read_scenario(tmp_path / "s")
    assert [row.price_per_kwh for row in scenario.profile] == [h / 1000 for h in range(168)]


def test_help_is_complete(command: Command) -> None:
    assert "feeder" in command("import", "--help")[1]
    for option in ("--into", "--base", "--source", "--station", "--set"):
        assert option in command("import", "feeder", "--help")[1]
    for option in ("--unit", "--days", "--hold", "--at-end", "--zone", "--accept", "--peak-kw"):
        assert option in command("import", "loads", "--help")[1]
    assert "--peak-kw" not in command("import", "prices", "--help")[1]
    assert "case33bw" in command("import", "networks")[1]
