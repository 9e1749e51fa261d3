"""The library: its examples hold, its tables are the files', and what is wrong is told at once."""

import doctest
import inspect
import io
import subprocess
import sys
from dataclasses import replace

import docstring_parser
import numpy as np
import pandas as pd
import pytest

import evdash
from evdash.domain.plan import Plan, Snapshot
from evdash.files.explanation_rows import EXPLANATION_TABLES
from evdash.files.run_tables import RUN_TABLES
from evdash.reports.words import decided_words
from evdash.scheduling.p1 import p1_policy

FLAGS = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS


@pytest.fixture(scope="module")
def day() -> evdash.Day:
    return evdash.load("summer-weekday").run()


def offered() -> dict[str, object]:
    """Everything the library offers by name: functions, classes, and what those have."""
    told = {name: getattr(evdash, name) for name in evdash.__all__}
    for name, thing in list(told.items()):
        if inspect.isclass(thing) and thing.__module__.startswith("evdash.api"):
            told |= {f"{name}.{key}": part for key, part in vars(thing).items() if key[0] != "_"}
    return told


OFFERED = offered()
SHOWN = [name for name, thing in OFFERED.items() if ">>>" in (inspect.getdoc(thing) or "")]


@pytest.mark.parametrize("name", SHOWN)
def test_every_example_gives_what_it_says(name: str) -> None:
    # by each docstring, as doctest itself passes cached properties over
    doc = inspect.getdoc(OFFERED[name]) or ""
    example = doctest.DocTestParser().get_doctest(doc, {}, name, None, 0)
    said = io.StringIO()
    found = doctest.DocTestRunner(optionflags=FLAGS).run(example, out=said.write)
    assert found.attempted == doc.count(">>> ") > 0
    assert not found.failed, said.getvalue()


@pytest.mark.parametrize("name", [name for name, thing in OFFERED.items() if callable(thing)])
def test_docstrings_name_every_parameter(name: str) -> None:
    told = docstring_parser.parse(inspect.getdoc(OFFERED[name]) or "")
    assert told.short_description
    if not inspect.isclass(OFFERED[name]):
        named = ", ".join(param.arg_name for param in told.params).split(", ")
        parameters = inspect.signature(OFFERED[name]).parameters
        assert named == [parameter for parameter in parameters if parameter != "self"]
        assert told.raises


def test_tables_are_those_of_the_files_to_the_last_digit(day: evdash.Day, tmp_path) -> None:
    day.save(tmp_path / "run")
    for name, record in RUN_TABLES.items():
        table = getattr(day, name.removesuffix(".csv"))
        assert list(table.columns) == list(record.model_fields)
        text = table.assign(
            **{
                column: table[column].dt.strftime("%Y-%m-%dT%H:%M")
                for column in table.select_dtypes("datetime")
            }
        ).to_csv(index=False, lineterminator="\n")
        assert same(text, (tmp_path / "run" / name).read_text(encoding="utf-8")), name
    with pytest.raises(evdash.InputError, match="force"):
        day.save(tmp_path / "run")


def same(one: str, other: str) -> bool:
    """Whether two CSV tables hold the same, cell by cell, whichever way a float is written."""
    cells = [pd.read_csv(io.StringIO(text), dtype=str, na_filter=False) for text in (one, other)]
    return all(
        a == b or float(a) == float(b)
        for a, b in zip(cells[0].to_numpy().flat, cells[1].to_numpy().flat, strict=True)
    )


def test_a_table_given_anew_is_read_like_a_file(tmp_path) -> None:
    scenario = evdash.load("summer-weekday")
    for name in ("nodes", "lines", "profile"):
        assert scenario.replace_table(name, getattr(scenario, name)).data == scenario.data
    few = scenario.replace_table("arrivals", scenario.arrivals.head(3))
    assert few.run().vehicles.vehicle.tolist() == scenario.arrivals.vehicle.head(3).tolist()
    failing = pd.DataFrame([{"interval": 3, "event": "chargers_fail", "value": 12}])
    failed = few.replace_table("events", failing)
    assert failed.events.event.tolist() == ["chargers_fail"]
    failed.save(tmp_path / "failed.zip")
    assert evdash.load(tmp_path / "failed.zip") == failed
    with pytest.raises(evdash.InputError, match=r"profile\.csv, row 3, column price_per_kwh"):
        scenario.replace_table(
            "profile",
            scenario.profile.replace({"interval": {1: 2}}).assign(
                price_per_kwh=lambda rows: rows.price_per_kwh.where(rows.index != 1, 1e6)
            ),
        )
    with pytest.raises(evdash.InputError, match="should be one of nodes"):
        scenario.replace_table("weather", scenario.profile)
    with pytest.raises(evdash.InputError, match=r"\.zip"):
        failed.save(tmp_path / "failed")


def test_columns_have_units_and_times_are_times(day: evdash.Day) -> None:
    assert day.intervals.attrs["units"]["price_per_kwh"] == "$/kWh"
    assert day.intervals.start.dtype == "datetime64[s]"
    assert day.vehicles.completed_interval.dtype == "Int64"
    assert day.voltages.voltage_ac_pu.dtype == float


def test_a_day_explains_itself(day: evdash.Day) -> None:
    small = evdash.load("summer-weekday", {"arrivals.vehicles_per_day": 20}).run()
    refused = small.vehicles.query("status == 'refused'").vehicle
    assert small.explanations.vehicle.tolist() == refused.tolist()
    for name in ("binding", "revisions", "worths"):
        assert list(getattr(small, name)) == list(EXPLANATION_TABLES[f"{name}.csv"].model_fields)
    with pytest.raises(evdash.InputError, match="refused"):
        day.explain("nobody")


@pytest.mark.parametrize(
    "kind", ["schedule", "admissions", "load", "headroom", "voltages", "gap", "feeder", "hot_spot"]
)
def test_a_day_is_drawn(day: evdash.Day, kind: str) -> None:
    assert day.plot(kind).data


def test_a_report_is_a_page_or_a_workbook(day: evdash.Day, tmp_path) -> None:
    for name, begin in (("day.html", b"<!DOCTYPE html>"), ("day.xlsx", b"PK")):
        day.report(tmp_path / name)
        assert (tmp_path / name).read_bytes().lower().startswith(begin.lower())
    with pytest.raises(evdash.InputError, match=r"\.xlsx"):
        day.report(tmp_path / "day.pdf")


def test_a_policy_of_ones_own_is_certified_like_ours() -> None:
    ours = p1_policy()

    def twice_the_power(snapshot: Snapshot) -> Plan:
        plan = ours(snapshot)
        return replace(plan, power_kw=2 * plan.power_kw)

    scenario = evdash.load("summer-weekday")
    same_day = scenario.run(ours)
    decided = [name for name in same_day.vehicles.columns if name != "reason"]
    assert same_day.vehicles[decided].equals(scenario.run().vehicles[decided])
    assert same_day.label.policy == "own:policy"
    refused = scenario.run(twice_the_power)
    assert refused.label.policy == "tests.api.test_api:twice_the_power"
    assert refused.is_sound
    assert set(refused.intervals.query("admitted + refused > 0").status) == {"fallback"}
    race = scenario.race(["p1", twice_the_power, lambda _: {}])
    assert list(race.figures.index) == ["p1", "tests.api.test_api:twice_the_power", "own:policy"]
    assert (race.figures.admitted.iloc[1:] == 0).all()
    with pytest.raises(evdash.InputError, match="two functions called own:policy"):
        scenario.race([lambda _: {}, ours])


def test_a_policy_that_answers_nothing_is_told_wherever_the_day_is() -> None:
    def broken(snapshot: Snapshot) -> object:
        raise ValueError("boom")

    day = evdash.load(settings={"arrivals.vehicles_per_day": 5.0}).run(policy=broken)
    kept = day.intervals.query("status == 'fallback'")
    assert len(kept)
    first = f"{kept.start.iloc[0]:%H:%M} the last plan was kept: "
    assert first in str(day)
    assert any(told.startswith(first) and "boom" in told for told in day.sentences)
    assert any("boom" in line for line in decided_words(day.account))


def test_a_race_is_drawn_and_told() -> None:
    race = evdash.load("summer-weekday").race(["oracle", "p1", "bid-price"])
    assert race.most_profit is not None
    assert race.most_profit >= race.figures.profit.max() - 1e-6
    assert set(race.intervals.policy) == set(race.refusals.policy) == set(race.figures.index)
    assert race.sentences[0].startswith("Knowing in advance")
    for kind in ("profit", "load", "capacity price"):
        assert race.plot(kind).data


def test_a_study_is_kept_resumed_and_drawn(tmp_path) -> None:
    scenario = evdash.load("summer-weekday", {"arrivals.vehicles_per_day": 20})
    axes = {"station.chargers": [1, 3], "option.C1.price_per_kwh": [0.3, 0.4]}
    kept = scenario.study(axes, days=2, folder=tmp_path / "study", workers=1)
    again = scenario.study(axes, days=2, folder=tmp_path / "study", workers=1)
    pd.testing.assert_frame_equal(kept.runs, again.runs)
    read = pd.read_csv(tmp_path / "study" / "summary.csv", float_precision="round_trip")
    assert np.array_equal(read.p50, kept.summary.p50)
    assert len(kept.runs) == 8
    assert kept.plot("profit").data[0].type == "heatmap"
    assert kept.plot("profit", paired=True).data
    from_file = evdash.study(tmp_path / "study" / "study.toml", workers=1)
    pd.testing.assert_frame_equal(from_file.runs, kept.runs)


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: evdash.load("nowhere"), "nowhere: found nothing there; .* or one of summer-week"),
        (lambda: evdash.load("no/where"), "no/where"),
        (lambda: evdash.load(settings={"station.colour": 1}), "colour"),
        (lambda: evdash.load().run("p2"), "'p2'"),
        (lambda: evdash.load().run(network="dc"), "'dc'"),
        (lambda: evdash.load().run(policy=3), "found 3; should be a name, or a function"),
        (lambda: evdash.load().run(policy=None), "found None; should be a name"),
        (lambda: evdash.load().race(["p1", "p2"]), "'p2'"),
        (lambda: evdash.load().race(["p1", 3]), "found 3; should be a name"),
        (lambda: evdash.load().race([]), "should be a list of policies"),
        (lambda: evdash.load().race("p1"), "should be a list of policies"),
        (lambda: evdash.load().study({}, policies=[print]), "should be a name, such as module"),
        (lambda: evdash.load().study({}, policies=()), "should be a list of policies"),
        (lambda: evdash.load().study({"station.chargers": [-1]}), "-1"),
        (lambda: evdash.load().study({}, days=0), "seeds"),
        (lambda: evdash.load().study({}, metrics=["beauty"]), "beauty"),
        (lambda: evdash.study("nowhere"), "nowhere"),
        (lambda: evdash.compare({}), "two"),
        (lambda: evdash.load().run().plot("pie"), "'pie'"),
    ],
)
def test_what_is_wrong_is_told_before_anything_is_run(call, told: str) -> None:
    with pytest.raises(evdash.InputError, match=told):
        call()


def test_the_bare_package_is_light() -> None:
    script = "import sys, evdash; print(evdash.__version__, 'pandas' in sys.modules)"
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, capture_output=True, check=True, text=True)
    assert done.stdout.strip() == f"{evdash.__version__} False"
    assert set(evdash.__all__) <= set(dir(evdash))
    with pytest.raises(AttributeError, match="nothing"):
        _ = evdash.nothing  # type: ignore[attr-defined]
