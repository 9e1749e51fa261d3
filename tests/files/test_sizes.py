"""Much input is answered in time and memory that grow with it, or refused, and legibly."""

import pytest

from evdash.files import tables
from evdash.files.validate import Places
from tests.files.spoiling import faults_of, files_of, generated_scenario, with_key

GENERATED = files_of(generated_scenario())


@pytest.mark.parametrize("key", ["k" * 5000, "a\nb", "\x1b[31mred", "\u202eback"])
def test_faults_stay_legible_whatever_they_quote(key):
    faults = faults_of(with_key(GENERATED, f"station.{key}", 1))
    assert faults
    for fault in faults:
        assert fault.isprintable()
        assert len(fault) < 1000


def test_a_fault_costs_the_same_however_many_rows_there_are(monkeypatch):
    """Every line to a node that is not there was once held against every row of nodes.csv."""
    asked = []
    hold = Places.hold
    monkeypatch.setattr(
        Places, "hold", lambda self, place: asked.append(place) or hold(self, place)
    )
    rows = 300
    nodes = GENERATED["nodes.csv"] + "".join(f"x{n},,,,,,,\n" for n in range(rows)).encode()
    lines = GENERATED["lines.csv"] + "".join(f"p{n},q{n},1,1,\n" for n in range(rows)).encode()
    faults = faults_of({**GENERATED, "nodes.csv": nodes, "lines.csv": lines})
    assert len(faults) == 2 * rows
    assert len(asked) < 10 * rows


def test_a_table_too_long_to_be_a_scenarios_is_not_read_to_its_end(monkeypatch):
    monkeypatch.setattr(tables, "MOST_ROWS", 50)
    lines = GENERATED["lines.csv"] + b"a,b,1,1,\n" * 100 + b'"never closed'
    (fault,) = faults_of({**GENERATED, "lines.csv": lines})
    assert fault == "lines.csv: found more than 50 rows; should have at most 50"


def _of_intervals(count: int) -> dict[str, bytes]:
    header = GENERATED["profile.csv"].splitlines(keepends=True)[0]
    rows = "".join(f"{t},0.1,1,1\n" for t in range(count)).encode()
    return with_key({**GENERATED, "profile.csv": header + rows}, "intervals", count)


def test_more_vehicles_than_a_machine_holds_are_refused():
    files = with_key(_of_intervals(10_000), "arrivals.vehicles_per_day", 1.0)
    assert faults_of(files) == []
    (fault,) = faults_of(with_key(files, "arrivals.vehicles_per_day", 10_000.0))
    assert fault.endswith("should be at most 100,000 in all")


def test_a_horizon_whose_plans_no_machine_holds_is_refused():
    def faults(intervals: int, chargers: int) -> list[str]:
        files = with_key(_of_intervals(intervals), "arrivals.vehicles_per_day", 1.0)
        return faults_of(with_key(files, "station.chargers", chargers))

    assert faults(600, 100_000) == []
    assert faults(2976, 56) == []
    (fault,) = faults(2976, 57)
    assert "2976 intervals with 57 chargers; should be at most 2,961 intervals" in fault


def test_a_feeder_too_large_for_its_horizon_is_refused():
    files = with_key(_of_intervals(10_000), "arrivals.vehicles_per_day", 1.0)
    nodes = "".join(f"x{n},,,,,,,\n" for n in range(500)).encode()
    lines = "".join(f"s,x{n},1,1,\n" for n in range(500)).encode()
    large = {
        **files,
        "nodes.csv": files["nodes.csv"] + nodes,
        "lines.csv": files["lines.csv"] + lines,
    }
    (fault,) = faults_of(large)
    assert "10000 intervals for 502 nodes; should be at most 5,000,000 in all" in fault
    more = {**files, "nodes.csv": files["nodes.csv"] + nodes * 11}
    assert any("at most 5000 entries" in fault for fault in faults_of(more))
