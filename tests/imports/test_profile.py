"""Prices and loads by date and time, held against pandas' own time zones and resampling."""

from collections.abc import Sequence
from datetime import date, datetime
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evdash.domain.scenario import Scenario
from evdash.errors import InputError
from evdash.files.draft import draft_of, scenario_of
from evdash.imports.clock import Reading
from evdash.imports.profile import ProfileRules, with_profile
from evdash.imports.profile_columns import proposed, proposed_unit
from evdash.imports.tables import read_foreign
from evdash.imports.workbook import written
from tests.builders import make_scenario, vehicle

ZONES = ["Europe/Berlin", "America/Los_Angeles", "Australia/Lord_Howe", "America/St_Johns"]
CHANGES = {
    "Europe/Berlin": ("2024-03-31", "2024-10-27"),
    "America/Los_Angeles": ("2024-03-10", "2024-11-03"),
    "Australia/Lord_Howe": ("2024-10-06", "2024-04-07"),  # by half an hour
    "America/St_Johns": ("2024-03-10", "2024-11-03"),
}


def day(start: str, minutes: int = 60, count: int | None = None, **more: Any) -> Scenario:
    """A scenario to be filled: `count` intervals, else one day of them."""
    intervals = count or 24 * 60 // minutes
    return make_scenario(
        start=datetime.fromisoformat(start),
        interval_minutes=minutes,
        price=[0.5] * intervals,
        **more,
    )


def of(scenario: Scenario, content: str | bytes, name: str = "mine.csv", **rules: Any) -> Any:
    """The scenario with the table taken in, and what was told."""
    table = read_foreign(name, content.encode() if isinstance(content, str) else content)
    columns = rules.pop("columns", None) or proposed(table.columns)
    units = {f: proposed_unit(f, c) or "" for f, c in columns.items() if f != "time"}
    units |= rules.pop("units", {})
    reading = Reading(rules.pop("zone", None), rules.pop("day_first", None))
    asked = ProfileRules(columns=columns, units=units, reading=reading, **rules)
    draft, told = with_profile(draft_of(scenario), table, asked)
    return scenario_of(draft), " ".join(told)


def faults(scenario: Scenario, content: str, **rules: Any) -> str:
    with pytest.raises(InputError) as error:
        of(scenario, content, **rules)
    return str(error.value)


def prices(scenario: Scenario) -> list[float]:
    return [row.price_per_kwh for row in scenario.profile]


def text_of(times: Sequence[Any], values: Sequence[float], column: str = "price_per_kwh") -> str:
    """A table as a user would have it."""
    rows = [f"{time},{value!r}" for time, value in zip(times, values, strict=True)]
    return "\n".join([f"time,{column}", *rows, ""])


def referee(series: pd.Series, start: pd.Timestamp, minutes: int, count: int, hold: int) -> Any:
    """Interval means by pandas alone: every minute has the last value, if it is not too old."""
    each_minute = pd.date_range(start, periods=minutes * count, freq="1min")
    values = series.reindex(each_minute, method="ffill", tolerance=pd.Timedelta(minutes=hold - 1))
    return values.to_numpy().reshape(count, minutes).mean(axis=1)  # NaN where any minute is


@settings(max_examples=60, deadline=None)
@given(
    step=st.sampled_from([5, 10, 15, 20, 30, 60, 90, 180]),
    minutes=st.sampled_from([5, 15, 30, 60]),
    shift=st.integers(-3, 3),
    dropped=st.sets(st.integers(1, 20), max_size=2),
    seed=st.integers(0, 99),
)
def test_means_are_pandas_means_and_gaps_are_pandas_gaps(
    step: int, minutes: int, shift: int, dropped: set[int], seed: int
) -> None:
    scenario = day("2024-05-06T00:00", minutes)
    begin = pd.Timestamp("2024-05-05 22:00") + pd.Timedelta(minutes=5 * shift)
    times = pd.date_range(begin, "2024-05-07 03:00", freq=f"{step}min")
    drawn = np.random.default_rng(seed).uniform(-0.1, 0.4, len(times))
    full = pd.Series(drawn, times)
    series = full[[i not in dropped for i in range(len(full))]]
    want = referee(series, pd.Timestamp("2024-05-06"), minutes, scenario.intervals, step)
    table = text_of(series.index, series.tolist())
    if np.isnan(want).any():
        told = faults(scenario, table)
        first = scenario.time_of(int(np.flatnonzero(np.isnan(want))[0]))
        assert f"no value for all of {first:%Y-%m-%d %H:%M} to " in told
    else:
        assert prices(of(scenario, table)[0]) == pytest.approx(want.tolist(), abs=1e-12)


@pytest.mark.parametrize("zone", ZONES)
@pytest.mark.parametrize("change", [0, 1])
@pytest.mark.parametrize(("step", "minutes"), [(60, 60), (15, 60), (30, 15), (5, 30)])
def test_clock_change_days_are_read_by_the_zones_rules(
    zone: str, change: int, step: int, minutes: int
) -> None:
    """The table has wall times, an hour of which is left out or comes twice."""
    first = CHANGES[zone][change]
    step = min(step, 30) if "Howe" in zone else step  # by the hour, its change is not to be seen
    start = pd.Timestamp(first, tz=zone)
    times = pd.date_range(start, periods=30 * 60 // step, freq=f"{step}min")
    values = np.random.default_rng(step).uniform(0, 0.3, len(times)).tolist()
    wall = times.tz_localize(None)
    scenario = day(first, minutes)
    changed, told = of(scenario, text_of(wall, values), zone=zone)
    want = referee(pd.Series(values, times), start, minutes, scenario.intervals, step)
    assert prices(changed) == pytest.approx(want.tolist(), abs=1e-12)
    assert "Clocks change within these days" in told
    assert ("comes twice" in told) == bool(change)
    # the same moments, each with its offset from UTC, are the same
    offsets = [time.isoformat() for time in times]
    assert prices(of(scenario, text_of(offsets, values), zone=zone)[0]) == prices(changed)
    utc = [f"{time:%Y-%m-%dT%H:%M}Z" for time in times.tz_convert("UTC")]
    assert prices(of(scenario, text_of(utc, values), zone=zone)[0]) == prices(changed)


def hourly(first: str, count: int = 30, **drop: Any) -> str:
    times = pd.date_range(first, periods=count, freq="1h")
    kept = [time for time in times if time.hour not in drop.get("hours", ())]
    return text_of(kept, [round(0.01 * time.hour, 2) for time in kept])


def test_without_a_zone_an_hour_twice_and_a_time_out_of_order_are_told() -> None:
    scenario = day("2024-10-27")
    times = pd.date_range("2024-10-27", periods=30, freq="1h", tz="Europe/Berlin")
    told = faults(scenario, text_of(times.tz_localize(None), [0.1] * 30))
    assert "mine.csv, row 5, column time: found 2024-10-27 02:00:00 a second time" in told
    assert "name the time zone" in told
    skipped = faults(day("2024-03-31"), hourly("2024-03-31"), zone="Europe/Berlin")
    assert "row 4, column time: found '2024-03-31 02:00:00', no time of that zone" in skipped
    lines = hourly("2024-05-06").splitlines()
    lines[4:6] = lines[5], lines[4]
    assert "row 6, column time" in faults(day("2024-05-06"), "\n".join(lines))


def test_gaps_are_told_with_their_row_and_filled_only_when_asked() -> None:
    scenario = day("2024-05-06")
    table = hourly("2024-05-06", hours=(7, 8))
    told = faults(scenario, table)
    assert "mine.csv, row 8, column price_per_kwh: found no value for all of 2024-05-06 07:00" in (
        told
    )
    assert "to 2024-05-06 09:00, intervals 7 to 8" in told
    assert "60 min" not in told
    changed, more = of(scenario, table, hold_minutes=180)
    assert prices(changed)[6:10] == [0.06, 0.06, 0.06, 0.09]
    assert "1 values hold for longer than the usual step, one from 2024-05-06 06:00 for 180" in more
    assert "hold for longer" not in of(scenario, hourly("2024-05-06"))[1]


def test_a_blank_is_a_gap_of_its_column_only() -> None:
    lines = ["time,price_per_kwh,load_mw"]
    lines += [f"2024-05-06T{h:02d}:00,0.1,{'' if h == 5 else h}" for h in range(24)]
    told = faults(day("2024-05-06"), "\n".join(lines))
    assert told.count("found no value") == 1
    assert "row 6, column load_mw: found no value for all of 2024-05-06 05:00" in told


def test_times_may_be_the_ends_of_what_they_stand_for() -> None:
    scenario = day("2024-05-06")
    times = pd.date_range("2024-05-06 01:00", periods=24, freq="1h")
    changed, told = of(scenario, text_of(times, [h / 100 for h in range(24)]), at_end=True)
    assert prices(changed) == [h / 100 for h in range(24)]
    assert "holds until its time" in told


def test_units_are_taken_from_the_columns_or_asked_for() -> None:
    scenario = day("2024-05-06")
    hours = pd.date_range("2024-05-06", periods=24, freq="1h")
    for column, value in (("price_mwh", 250.0), ("Price [EUR/MWh]", 250.0), ("price_ct_kwh", 25.0)):
        assert prices(of(scenario, text_of(hours, [value] * 24, column))[0]) == [0.25] * 24
    unstated = text_of(hours, [250.0] * 24, "price")
    assert "unit of price: found none; should be $/kWh, $/MWh, ct/kWh" in faults(scenario, unstated)
    changed, _ = of(scenario, unstated, units={"price": "$/MWh"})
    assert prices(changed) == [0.25] * 24


def test_powers_are_per_unit_of_their_peak() -> None:
    scenario = day("2024-05-06")
    hours = pd.date_range("2024-05-05", periods=72, freq="1h")
    load = [2.0] * 71 + [8.0]  # the peak is on another day
    table = text_of(hours, load, "load_mw")
    changed, told = of(scenario, table)
    assert [row.load_pu for row in changed.profile] == [0.25] * 24
    assert "per unit of the table's own peak, 8,000 kW" in told
    assert prices(changed) == [0.5] * 24
    assert "As before, interval by interval: price_per_kwh, generation_pu" in told
    changed, told = of(scenario, table, peak_kw={"load": 2500.0})
    assert [row.load_pu for row in changed.profile] == pytest.approx([0.8] * 24)
    assert "peak of load" in faults(scenario, table, peak_kw={"load": -1.0})
    assert "peak of price" in faults(scenario, table, peak_kw={"price": 1.0})


def test_the_first_day_is_chosen_and_arrivals_move_along() -> None:
    scenario = day("2024-05-06", vehicles=[vehicle("V1", 2.5), vehicle("V2", 23.0)])
    table = hourly("2019-07-01", 48)
    assert "Choose another first day" in faults(scenario, table)
    changed, told = of(scenario, table, first_day=date(2019, 7, 2))
    assert changed.start == datetime(2019, 7, 2)
    assert [v.arrival for v in changed.arrivals.vehicles] == [
        datetime(2019, 7, 2, 2, 30),
        datetime(2019, 7, 2, 23, 0),
    ]
    assert "moved along by -1770 days" in told


def test_more_days_are_asked_for() -> None:
    scenario = day("2024-05-06")
    changed, _ = of(scenario, hourly("2024-05-06", 72), days=3)
    assert changed.intervals == 72
    assert prices(changed) == [round(0.01 * h, 2) for h in range(24)] * 3
    assert "should be 1 to 366" in faults(scenario, hourly("2024-05-06"), days=0)


def test_tables_that_run_backwards_are_turned() -> None:
    head, *lines = hourly("2024-05-06", 24).splitlines()
    changed, told = of(day("2024-05-06"), "\n".join([head, *reversed(lines)]))
    assert prices(changed) == [round(0.01 * h, 2) for h in range(24)]
    assert "backwards" in told


def test_semicolons_decimal_commas_and_spans_of_time_are_read() -> None:
    lines = ["MTU (CET/CEST);Day-ahead Price [EUR/MWh];Load [MW]"]
    lines += [
        f"06.05.2024 {h:02d}:00 - 06.05.2024 {h + 1:02d}:00;{h},5;1.{h:03d},25" for h in range(23)
    ]
    lines.append("06.05.2024 23:00 - 07.05.2024 00:00;23,5;1.023,25")
    changed, told = of(day("2024-05-06"), "\n".join(lines))
    assert prices(changed) == [(h + 0.5) / 1000 for h in range(24)]
    assert changed.profile[0].load_pu == pytest.approx(1000.25 / 1023.25)
    assert "Commas are decimal signs in Day-ahead Price [EUR/MWh], Load [MW]" in told


def test_a_workbook_with_dates_of_excels_own_is_read() -> None:
    hours = pd.date_range("2024-05-06", periods=24, freq="1h")
    rows: list[list[object]] = [["time", "price_per_kwh"]]
    # as a spreadsheet has them: fractions of a day, off by some milliseconds
    rows += [[time.to_pydatetime(), 0.01 * time.hour] for time in hours]
    rows[5][0] = datetime(2024, 5, 6, 3, 59, 59, 999000)
    changed, _ = of(day("2024-05-06"), written({"prices": rows}), "mine.xlsx")
    assert prices(changed) == pytest.approx([0.01 * h for h in range(24)])


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (hourly("2024-05-06").replace("0.03", "lots", 1), "row 5, column price_per_kwh"),
        (hourly("2024-05-06").replace("0.03", "nan", 1), "should be a number from -1,000 to 1,000"),
        (hourly("2024-05-06").replace("0.03", "1e9", 1), "should be a number"),
        (hourly("2024-05-06").replace("2024-05-06 03:00:00", "soon"), "row 5, column time"),
        (hourly("2024-05-06").replace("2024-05-06 03:00:00", ""), "row 5, column time"),
        (hourly("2024-05-06").replace("2024-05-06 00:00:00", "0001-01-01"), "year from 1900 to"),
        (hourly("2024-05-06").replace("03:00:00", "03:00Z", 1), "with and without an offset"),
        (hourly("2024-05-06").replace(":00:00", ":00Z"), "name the station's time zone"),
        ("time,price_per_kwh\n2024-05-06,0.1\n", "one row"),
        ("time,price_per_kwh\n2024-05-06,\n2024-05-07,\n", "no number"),
        ("time,colour_kwh\n2024-05-06,3\n2024-05-07,3\n", "no column of values"),
        ("when,price_per_kwh\n2024-05-06,3\n2024-05-07,3\n", "mapping, time: found no column"),
        (hourly("2024-05-06", 12), "no value for all of 2024-05-06 12:00 to 2024-05-07 00:00"),
    ],
)
def test_faults_name_row_column_and_what_is_allowed(table: str, words: str) -> None:
    assert words in faults(day("2024-05-06"), table)


def test_tables_with_offsets_run_backwards_over_a_clock_change_too() -> None:
    times = pd.date_range("2024-10-27", periods=26, freq="1h", tz="Europe/Berlin")
    stamps = [time.isoformat() for time in times]
    values = [0.01 * n for n in range(26)]
    changed, _ = of(day("2024-10-27"), text_of(stamps[::-1], values[::-1]), zone="Europe/Berlin")
    assert prices(changed) == values[:24]


@pytest.mark.parametrize("interval", ["x", "²", "9" * 5000, "-1", "3"])
def test_a_profile_whose_intervals_cannot_be_told_is_a_fault(interval: str) -> None:
    draft = draft_of(day("2024-05-06"))
    rows = draft.tables["profile.csv"]
    draft = draft.with_table("profile.csv", (*rows[:-1], rows[-1] | {"interval": interval}))
    table = read_foreign("mine.csv", hourly("2024-05-06").encode())
    rules = ProfileRules(proposed(table.columns), {"price": "$/kWh"})
    with pytest.raises(InputError, match="one row for each interval"):
        with_profile(draft, table, rules)


def test_a_first_day_beyond_the_calendar_is_refused() -> None:
    for first in (date(1, 1, 1), date(9999, 12, 31)):
        told = faults(day("2024-05-06"), hourly("2024-05-06"), first_day=first, days=2)
        assert "first day: found" in told
        assert "should be in a year from 1900 to 2999" in told


def test_a_zone_nobody_knows_and_a_time_a_value_cannot_hold_are_refused() -> None:
    scenario = day("2024-05-06")
    assert "time zone such as" in faults(scenario, hourly("2024-05-06"), zone="Mars/Olympus")
    assert "above 0 min" in faults(scenario, hourly("2024-05-06"), hold_minutes=0.0)
