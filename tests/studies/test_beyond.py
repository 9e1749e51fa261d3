"""What a study found is told beside the days on which charging was beyond limits."""

from evdash.studies.beyond import beyond_told
from evdash.studies.reading import read_study
from evdash.studies.tables import Found, bands
from evdash.ui.studies.words import answer, everywhere
from tests.builders import line, make_scenario, node, vehicle
from tests.studies.small import finished, write_study

STUDY = """
format = 1
name = "small"
base = "base"
referee_every = 0
policies = ["p1", "uncoordinated"]
metrics = ["profit"]

[[axis]]
key = "station.chargers"
values = [1, 4]
"""


def found_in(tmp_path) -> Found:
    base = make_scenario(
        nodes=(node("s"), node("a", load_kw=10)),
        lines=(line("s", "a", r=2.0, x=2.0, rating=40),),
        vehicles=[vehicle(f"v{n}", n / 4, need_kwh=12) for n in range(6)],
    )
    file = write_study(tmp_path, STUDY, base)
    return finished(file, tmp_path / "out").found(read_study(file))


def test_days_beyond_limits_are_counted_and_told_beside_the_best(tmp_path) -> None:
    found = found_in(tmp_path)
    figures = {run: found.results[run.key].figures for run in found.runs.runs}
    in_ac = [run for run, told in figures.items() if told["ac_limits_broken"]]
    kept = [run for run, told in figures.items() if told["limits_broken"]]
    assert 0 < len(kept) < len(figures)
    assert f"by AC power flow on {len(in_ac)} of 4 days" in beyond_told(found)
    assert f"in which they are kept, on {len(kept)} of 4 days" in beyond_told(found)
    rows = bands(found)
    best = max(rows, key=lambda band: band.p50)
    said = answer(found, rows, "profit")
    assert best.group[-2] == "uncoordinated"
    assert "There, charging exceeds limits" in said
    assert "of 1 day" in said
    assert "Over all, charging exceeds limits" in everywhere(found)
    for group, runs in found.groups().items():
        told = beyond_told(found, group.cells)
        assert ("in the linearised model" in told) == any(run in kept for run in runs)
        assert ("by AC power flow" in told) == any(run in in_ac for run in runs)


def test_nothing_is_told_where_every_day_kept_within(tmp_path) -> None:
    found = found_in(tmp_path)
    within = [
        group.cells
        for group, runs in found.groups().items()
        if not any(
            found.value(run, name)
            for run in runs
            for name in ("ac_limits_broken", "limits_broken", "broken")
        )
    ]
    assert all(beyond_told(found, cells) == "" for cells in within)
    assert within
