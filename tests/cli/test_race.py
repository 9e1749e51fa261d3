"""`race`: a table, sentences and files; wrong input told like anywhere else."""

import csv

QUIET = ("--set", "arrivals.vehicles_per_day=15")


def test_a_race_prints_a_table_and_writes_files(tmp_path, command):
    out = tmp_path / "race"
    chosen = ("--policies", "p1", "oracle", "uncoordinated")
    status, told, _ = command("race", *QUIET, *chosen, "--out", str(out))
    assert status == 0
    assert "Profit, $" in told
    assert "Knowing in advance who will come is worth $" in told
    with (out / "policies.csv").open(encoding="utf-8") as file:
        rows = {row["policy"]: row for row in csv.DictReader(file)}
    assert list(rows) == ["oracle", "p1", "uncoordinated"]
    assert float(rows["p1"]["profit_of_best"]) <= 1.0
    with (out / "intervals.csv").open(encoding="utf-8") as file:
        assert len(list(csv.DictReader(file))) == 24 * 3
    status, _, err = command("race", *QUIET, *chosen, "--out", str(out))
    assert (status, "--force" in err) == (2, True)


def test_the_same_seed_gives_the_same_race(tmp_path, command):
    for name in ("a", "b"):
        command(
            "race",
            *QUIET,
            "--seed",
            "5",
            "--policies",
            "p1",
            "edf",
            "bid-price",
            "--out",
            str(tmp_path / name),
        )
    files = [(tmp_path / name / "intervals.csv").read_bytes() for name in ("a", "b")]
    assert files[0] == files[1]


def test_a_policy_asked_for_that_cannot_run_is_wrong_input(tmp_path, command):
    command("run", *QUIET, "--out", str(tmp_path / "run"))
    folder = tmp_path / "run" / "scenario"
    toml = (folder / "scenario.toml").read_text(encoding="utf-8")
    start = toml.index("[arrivals.forecast]")
    after = toml.find("\n[", toml.find("\n[arrivals.forecast.", start) + 1)
    (folder / "scenario.toml").write_text(
        toml[:start] + (toml[after:] if after > 0 else ""), encoding="utf-8"
    )
    (folder / "fleet.csv").unlink(missing_ok=True)
    status, _, err = command("race", str(folder), "--policies", "p1", "bid-price")
    assert status == 2
    assert "--policies bid-price" in err
