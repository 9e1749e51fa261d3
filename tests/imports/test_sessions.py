"""Sessions made up in the forms recorded ones have, as a scenario's arrivals."""

import json
from datetime import date, datetime
from typing import Any

import pytest

from evdash.domain.arrivals import RecordedArrivals
from evdash.domain.scenario import Scenario
from evdash.errors import InputError
from evdash.files.bundled import DEFAULT
from evdash.files.draft import draft_of, scenario_of
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.arrivals import arrivals_of
from evdash.horizon.day import run_day, start_day
from evdash.imports.clock import Reading, read_time
from evdash.imports.session_columns import proposed
from evdash.imports.session_rows import SessionRules
from evdash.imports.sessions import with_sessions
from evdash.imports.tables import read_foreign
from evdash.imports.workbook import written
from evdash.metrics.service import totals
from evdash.policies.registry import RULES

CSV = (
    "session_id,station_id,arrival,departure,requested_energy_kwh\n"
    "a1,X,2019-03-01 06:20:00,2019-03-01 16:20:00,9.0\n"
    "a2,X,2019-03-01 07:05:00,2019-03-01 08:05:00,8.0\n"
    "a3,Y,2019-03-02 23:50:00,2019-03-03 01:00:00,0.01\n"
    "a4,Y,2019-03-02 12:00:00,2019-03-02 13:00:00,70\n"
)
ACN = {
    "_items": [
        {
            "sessionID": "s1",
            "connectionTime": "Fri, 01 Mar 2019 14:24:58 GMT",
            "disconnectTime": "Fri, 01 Mar 2019 23:00:00 GMT",
            "kWhDelivered": 12.5,
            "timezone": "America/Los_Angeles",
            "userInputs": [{"kWhRequested": 10}, {"kWhRequested": 20, "paymentRequired": True}],
        },
        {
            "sessionID": "s2",
            "connectionTime": "Mon, 11 Mar 2019 15:00:00 GMT",
            "disconnectTime": "Mon, 11 Mar 2019 19:00:00 GMT",
            "kWhDelivered": 6.0,
            "timezone": "America/Los_Angeles",
            "userInputs": None,
        },
    ]
}
EVI_DIST = (
    "ev_id,event_index,plug_in_time,duration,start_SOC,energy_need,energy_capacity,max_charge_rate\n"
    "7,0,2024-05-06T18:30,600,0.2,27,60,9.6\n"
    "7,1,2024-05-07T18:45,540,0.5,18,60,9.6\n"
)


def of(content: str | bytes, name: str = "mine.csv", **rules: Any) -> tuple[Scenario, str]:
    data = content.encode() if isinstance(content, str) else content
    table = read_foreign(name, data)
    columns = rules.pop("columns", None) or proposed(table.columns)
    base = draft_of(read_scenario(DEFAULT))
    draft, told = with_sessions(base, table, SessionRules(columns=columns, **rules))
    return scenario_of(draft), " ".join(told)


def faults(content: str, **rules: Any) -> str:
    with pytest.raises(InputError) as error:
        of(content, **rules)
    return str(error.value)


def needs(scenario: Scenario) -> list[float]:
    assert isinstance(scenario.arrivals, RecordedArrivals)
    efficiency = scenario.station.efficiency
    return [(v.soc_out - v.soc_in) * v.battery_kwh / efficiency for v in scenario.arrivals.vehicles]


def test_energy_times_and_options_follow_the_rules() -> None:
    scenario, told = of(CSV)
    vehicles = arrivals_of(scenario)
    assert [v.vehicle for v in vehicles] == ["a1", "a2", "a4"]
    assert needs(scenario) == pytest.approx([9.0, 8.0, 70.0])
    # 0.9 kW and 8 kW on average: the slowest option that is fast enough; 70 kW is beyond any
    assert [v.option for v in vehicles] == ["C2", "C1", "C1"]
    assert vehicles[2].battery_kwh == pytest.approx(70.0)
    assert vehicles[2].soc_in >= 0
    assert (scenario.start, scenario.intervals) == (datetime(2019, 3, 1), 48)
    assert "1 sessions of less than 0.05 kWh" in told
    assert "1 sessions drew more than any option" in told
    assert "1 batteries were enlarged" in told


def test_the_profile_repeats_by_clock_time() -> None:
    base = read_scenario(DEFAULT)
    scenario, _ = of(CSV)
    for t, row in enumerate(scenario.profile):
        assert row.price_per_kwh == base.profile[t % 24].price_per_kwh


def test_one_day_is_chosen_of_many() -> None:
    scenario, told = of(CSV, first_day=date(2019, 3, 2), days=1)
    assert [v.vehicle for v in arrivals_of(scenario)] == ["a4"]
    assert scenario.intervals == 24
    assert "2 sessions outside the chosen days" in told


def test_acn_data_is_put_on_the_stations_clock_across_a_clock_change() -> None:
    scenario, told = of(json.dumps(ACN), "acn.json")
    first, second = arrivals_of(scenario)
    assert first.arrival == datetime(2019, 3, 1, 6, 24)
    # 08:00 on the wall, where clocks went forward on the 10th; the scenario's did not
    assert second.arrival == datetime(2019, 3, 11, 7, 0)
    assert "Clocks in America/Los_Angeles change" in told
    assert needs(scenario) == pytest.approx([12.5, 6.0])
    columns = {"arrival": "connectionTime", "energy_kwh": "userInputs.kWhRequested"}
    asked = faults_or_first(json.dumps(ACN), columns)
    assert "record 2, column userInputs.kWhRequested: found a blank" in asked


def faults_or_first(content: str, columns: dict[str, str]) -> str:
    with pytest.raises(InputError) as error:
        of(content, "acn.json", columns=columns)
    return str(error.value)


def test_evi_dists_columns_are_known() -> None:
    scenario, _ = of(EVI_DIST, duration_unit="min")
    vehicles = arrivals_of(scenario)
    assert needs(scenario) == pytest.approx([27.0, 18.0])
    assert [v.battery_kwh for v in vehicles] == [60.0, 60.0]
    assert [v.max_kw for v in vehicles] == [9.6, 9.6]
    assert [v.option for v in vehicles] == ["C2", "C2"]


def test_times_in_hours_count_from_a_day() -> None:
    text = "start_time,end_time_prk,kwh\n7.5,17.0,10\n32.25,40,5\n"
    scenario, _ = of(text, origin=date(2024, 5, 6))
    assert [v.arrival for v in arrivals_of(scenario)] == [
        datetime(2024, 5, 6, 7, 30),
        datetime(2024, 5, 7, 8, 15),
    ]


def test_options_are_drawn_by_shares_and_seed() -> None:
    rows = "".join(f"2019-03-01 0{n % 10}:00,5\n" for n in range(400))
    text = "arrival,energy_kwh\n" + rows
    shares = {"C1": 0.25, "C2": 0.75}
    first, _ = of(text, option_share=shares, seed=3)
    again, _ = of(text, option_share=shares, seed=3)
    other, _ = of(text, option_share=shares, seed=4)
    assert first == again != other
    drawn = [v.option for v in arrivals_of(first)].count("C1")
    assert 70 < drawn < 130
    assert "sum 1" in faults(text, option_share={"C1": 0.5, "C2": 0.6})


def test_a_workbook_and_a_csv_of_the_same_table_are_the_same() -> None:
    lines = [line.split(",") for line in CSV.splitlines()]
    rows: list[list[object]] = [lines[0]]
    for line in lines[1:]:
        rows.append([*line[:4], float(line[4])])
    assert of(written({"sessions": rows}), "mine.xlsx")[0] == of(CSV)[0]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (CSV.replace("9.0", "lots"), "mine.csv, row 2, column requested_energy_kwh: found 'lots'"),
        (CSV.replace("8.0", "-8"), "row 3"),
        (CSV.replace("2019-03-01 07:05:00", "yesterday"), "row 3, column arrival"),
        (CSV.replace("2019-03-01 16:20:00", "2019-03-01 05:00:00"), "should be after the arrival"),
        (CSV.replace("2019-03-01 06:20:00", "3/1/2019 6:20"), "day or the month comes first"),
        (CSV.replace("2019-03-02 12:00:00", "2020-03-02 12:00:00"), "should be"),
        ("a,b\n1,2\n", "mapping, arrival: found no column"),
        ("arrival,arrival\n", "no rows"),
        ("", "no rows"),
        ("arrival,energy_kwh\n2019-03-01T06:20Z,4\n", "name the station's time zone"),
    ],
)
def test_faults_name_row_column_and_what_is_allowed(text: str, words: str) -> None:
    assert words in faults(text)


def test_nobody_leaves_with_an_empty_battery() -> None:
    text = "arrival,energy_kwh,departure_soc\n2019-03-01 06:20,4,0\n"
    assert "mine.csv, row 2, column departure_soc: found '0'" in faults(text)
    for soc_out in (0.0, -0.5, 1.5, float("nan")):
        assert "soc_out): found" in faults(CSV, soc_out=soc_out)


def test_columns_nobody_has_are_refused() -> None:
    assert "columns of the table are" in faults(CSV, columns={"arrival": "x", "energy_kwh": "y"})
    assert "time zone such as" in faults(CSV, reading=Reading("Mars/Olympus"))


def test_dates_are_read_as_told() -> None:
    for day_first, expected in ((True, datetime(2019, 4, 3, 6)), (False, datetime(2019, 3, 4, 6))):
        assert read_time("3/4/2019 6:00", Reading(day_first=day_first)) == expected
    assert read_time("13/4/2019 6:00", Reading()) == datetime(2019, 4, 13, 6)


def test_a_month_replays_and_every_promise_is_kept() -> None:
    rows = "".join(
        f"{day}-{n},{when} {8 + n:02d}:{7 * n:02d},{when} {15 + n}:00,{3 + n}\n"
        for day in range(1, 32)
        for when in [f"2019-03-{day:02d}"]
        for n in range(4)
    )
    scenario, _ = of("id,arrival,departure,kwh\n" + rows)
    assert scenario.intervals == 31 * 24
    rule = RULES["p1"]
    trace = start_day(scenario, "lindistflow")
    done = totals(run_day(trace, rule.make(trace.inputs), None, rule.decide))
    assert (done.arrived, done.admitted, done.charged) == (124, 124, 124)
