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
    worths = rows(out / "worths.csv")
    assert worths[0]["change"] == "One more charger"
    assert {row["change"].split(" by ")[0] for row in worths} >= {"A voltage band wider"}
    intervals = rows(out / "intervals.csv")
    tightest = {
        row["interval"]: row["element"]
        for row in rows(out / "binding.csv")
        if row["tightest"] == "1"
    }
    assert tightest == {row["interval"]: row["binding"] for row in intervals if row["binding"]}
    revised = rows(out / "revisions.csv")
    assert [row["interval"] for row in revised] == [row["interval"] for row in intervals[1:]]
    assert all(row["told"].endswith(".") for row in revised)
    assert main(["audit", str(out)]) == 0
    assert main([*SMALL, "--force", "--out", str(out)]) == 0
    for name in ("explanations", "worths", "binding", "revisions"):
        assert not (out / f"{name}.csv").exists()


def test_without_a_folder_they_are_printed(capsys):
    assert main([*SMALL, "--explain"]) == 0
    printed = capsys.readouterr().out
    for told in ("Refused because", "sets the headroom", "One more charger", "Plan revised"):
        assert told in printed
    assert main([*SMALL]) == 0
    assert "Refused because" not in capsys.readouterr().out
