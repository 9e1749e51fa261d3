"""`run --explain`: one row for each refused vehicle, beside the files of fixed form."""

import csv

from evdash.cli.main import main

SMALL = ("run", "data/presets/price-spike", "--set", "arrivals.vehicles_per_day=12.0")


def rows(path):
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_every_refused_vehicle_has_its_row(tmp_path):
    out = tmp_path / "run"
    assert main([*SMALL, "--explain", "--out", str(out)]) == 0
    told = rows(out / "explanations.csv")
    refused = [row["vehicle"] for row in rows(out / "vehicles.csv") if row["status"] == "refused"]
    assert [row["vehicle"] for row in told] == refused != []
    assert list(told[0]) == ["vehicle", "cause", "detail", "remedy"]
    assert all(row["cause"] and row["detail"].startswith("Refused because") for row in told)
    assert main(["audit", str(out)]) == 0
    assert main([*SMALL, "--force", "--out", str(out)]) == 0
    assert not (out / "explanations.csv").exists()


def test_without_a_folder_they_are_printed(capsys):
    assert main([*SMALL, "--explain"]) == 0
    assert "Refused because" in capsys.readouterr().out
    assert main([*SMALL]) == 0
    assert "Refused because" not in capsys.readouterr().out
