"""Bands and differences against pandas, and cells no spreadsheet runs."""

import pandas as pd
import pytest

from evdash.domain.study import Result
from evdash.studies.reading import read_study
from evdash.studies.tables import Found, bands, csv_text, reference_bands, runs_table
from tests.studies.small import STUDY, finished, rows, write_study


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("study")
    return finished(write_study(place, STUDY.format(count=5)), place / "out")


AXES = ["station.chargers", "line s-a, kVA"]


def test_bands_are_the_quantiles_of_the_runs(folder) -> None:
    runs = pd.read_csv(folder.path / "runs.csv")
    summary = pd.read_csv(folder.path / "summary.csv").set_index([*AXES, "metric"])
    for metric in ("profit", "admitted", "lowest_ac_pu", "ac_losses_kwh"):
        grouped = runs.groupby(AXES)[metric]
        for name, wanted in {
            "p05": grouped.quantile(0.05),
            "p50": grouped.median(),
            "p95": grouped.quantile(0.95),
            "mean": grouped.mean(),
            "standard_error": grouped.sem(),
            "days": grouped.count(),
        }.items():
            for labels, value in wanted.items():
                assert summary.loc[(*labels, metric), name] == pytest.approx(value, abs=1e-12)
    assert "tightest" not in {row["metric"] for row in rows(folder, "summary.csv")}
    assert set(runs["tightest"]) <= {"line:s-a", "voltage_min:a", "voltage_min:b"}


def test_differences_are_paired_by_seed_with_the_first_point(folder) -> None:
    runs = pd.read_csv(folder.path / "runs.csv")
    told = pd.read_csv(folder.path / "differences.csv").set_index([*AXES, "metric"])
    first = runs[(runs[AXES[0]] == 1) & (runs[AXES[1]] == 30)].set_index("seed")["profit"]
    for labels, group in runs.groupby(AXES):
        if labels == (1, 30):
            assert (*labels, "profit") not in told.index
            continue
        paired = group.set_index("seed")["profit"] - first
        assert told.loc[(*labels, "profit"), "p50"] == pytest.approx(paired.median())
        assert told.loc[(*labels, "profit"), "p95"] == pytest.approx(paired.quantile(0.95))
    # a band of pairs is no difference of bands: nothing here would tell otherwise
    summary = pd.read_csv(folder.path / "summary.csv").set_index([*AXES, "metric"])
    apart = summary["p95"] - summary.loc[(1, 30, "profit"), "p95"]
    assert told.loc[(3, 60, "profit"), "p95"] != pytest.approx(apart[(3, 60, "profit")])


def test_batched_ac_agrees_with_pandapower(tmp_path) -> None:
    # which are refereed is drawn by their keys, and so by the code: enough of them to draw from
    text = STUDY.format(count=6).replace('"ac_losses_kwh"', '"referee_error_pu"')
    text = text.replace("referee_every = 0", "referee_every = 2")
    table = rows(finished(write_study(tmp_path, text), tmp_path / "out"), "runs.csv")
    errors = [float(row["referee_error_pu"]) for row in table if row["referee_error_pu"]]
    assert 0 < len(errors) < len(table)
    assert max(errors) < 1e-7


def test_no_cell_starts_a_formula(tmp_path) -> None:
    runs = read_study(write_study(tmp_path, STUDY.format(count=1)))
    reason = "=1+1\nand more"
    results = {run.key: Result(run.key, "failed", reason, {}, 0.0) for run in runs.runs}
    table = csv_text(runs_table(Found(runs, results)))
    assert "'=1+1 and more" in table
    assert ",=" not in table


def test_a_study_not_run_yet_has_its_rows_and_no_bands(tmp_path) -> None:
    found = Found(read_study(write_study(tmp_path, STUDY.format(count=1))), {})
    assert csv_text(runs_table(found)).count("not run yet") == 4
    assert bands(found) == reference_bands(found) == []
