"""OCPP charging profiles against the published schemas, as the package `ocpp` carries them."""

import asyncio
import io
import json
import zipfile
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta
from itertools import pairwise
from zoneinfo import ZoneInfo

import pytest
from ocpp.messages import Call, validate_payload

from evdash.domain.trace import Trace
from evdash.errors import InputError
from evdash.metrics.records import executed_power, vehicle_records
from evdash.reports.ocpp import VERSIONS, clock_note, message, outlets, profiles, profiles_zip
from evdash.reports.ocpp_limits import Current, current_of
from tests.builders import make_scenario, vehicle
from tests.reports.conftest import finished


@pytest.fixture(scope="module")
def archive(usual) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(profiles_zip(usual.trace, "America/Los_Angeles"))) as opened:
        return {name.removeprefix("profiles/"): opened.read(name) for name in opened.namelist()}


def validate(version: str, payload: dict) -> None:
    call = Call(unique_id="1", action="SetChargingProfile", payload=payload)
    # a thread of its own: a browser test before this one may have left a loop running here
    with ThreadPoolExecutor(1) as pool:
        pool.submit(asyncio.run, validate_payload(call, version)).result()


@pytest.mark.parametrize("version", VERSIONS)
def test_every_profile_validates_against_the_published_schema(archive, version, usual):
    payloads = [json.loads(b) for n, b in archive.items() if n.startswith(f"ocpp-{version}/")]
    assert len(payloads) == usual.totals.admitted
    for payload in payloads:
        validate(version, payload)


@pytest.mark.parametrize("version", VERSIONS)
def test_the_schema_would_have_found_what_is_wrong(usual, version):
    payload = message(profiles(usual.trace)[0], version)
    part = payload["csChargingProfiles" if version == "1.6" else "chargingProfile"]
    part["chargingProfileKind"] = "absolute"
    with pytest.raises(Exception, match="absolute"):
        validate(version, payload)


def test_each_vehicle_gets_its_energy_within_its_window_and_not_a_watt_beyond(archive, usual):
    index = json.loads(archive["index.json"])
    records = {record.vehicle: record for record in vehicle_records(usual.trace)}
    assert {row["vehicle"] for row in index} == {
        vehicle for vehicle, record in records.items() if record.delivered_kwh
    }
    scenario = usual.scenario
    for row in index:
        told = json.loads(archive[f"ocpp-1.6/{row['file']}"])["csChargingProfiles"]
        schedule, record = told["chargingSchedule"], records[row["vehicle"]]
        periods = schedule["chargingSchedulePeriod"]
        ends = [period["startPeriod"] for period in periods[1:]] + [schedule["duration"]]
        energy_kwh = sum(
            period["limit"] * (end - period["startPeriod"]) / 3.6e6
            for period, end in zip(periods, ends, strict=True)
        )
        assert energy_kwh == pytest.approx(record.delivered_kwh, abs=2e-3)
        assert periods[0]["startPeriod"] == 0
        assert max(period["limit"] for period in periods) <= 1000 * record.request.max_kw + 0.05
        begin = datetime.fromisoformat(schedule["startSchedule"])
        # Los Angeles in July is seven hours behind
        local = (begin.astimezone(UTC) - timedelta(hours=7)).replace(tzinfo=None)
        assert local == scenario.time_of(record.request.arrival_interval)
        end = local + timedelta(seconds=schedule["duration"])
        assert end == scenario.time_of(record.request.deadline_interval)


def test_both_versions_say_the_same(usual):
    for profile in profiles(usual.trace):
        old = message(profile, "1.6")
        new = message(profile, "2.0.1")
        assert old["connectorId"] == new["evseId"]
        (schedule,) = new["chargingProfile"]["chargingSchedule"]
        assert schedule | old["csChargingProfiles"]["chargingSchedule"] == schedule


def union_w(messages: list[dict]) -> dict[datetime, float]:
    """Power of all 1.6 payloads together from each UTC instant on at which it changes, W."""
    changes: dict[datetime, float] = {}
    for payload in messages:
        schedule = payload["csChargingProfiles"]["chargingSchedule"]
        begin = datetime.fromisoformat(schedule["startSchedule"])
        before = 0.0
        for period in [
            *schedule["chargingSchedulePeriod"],
            {"startPeriod": schedule["duration"], "limit": 0.0},
        ]:
            at = begin + timedelta(seconds=period["startPeriod"])
            changes[at] = changes.get(at, 0.0) + period["limit"] - before
            before = period["limit"]
    total = 0.0
    return {at: (total := total + changes[at]) for at in sorted(changes)}


def means_w(union: dict[datetime, float], begin: datetime, minutes: int, count: int) -> list[float]:
    """The mean of each interval of real time, the first of which begins at `begin`."""
    span = timedelta(minutes=minutes)
    moments = [*union, begin + count * span]
    energy = [0.0] * count
    for at, until in pairwise(moments):
        for t in range(max(0, (at - begin) // span), min(count, (until - begin) // span + 1)):
            start = begin + t * span
            shared = min(until, start + span) - max(at, start)
            energy[t] += union[at] * max(0.0, shared / span)
    return energy


def messages_of(trace, zone="UTC", current=None):
    return [message(profile, "1.6") for profile in profiles(trace, zone, current)]


def station_w(trace) -> list[float]:
    executed = [0.0] * trace.scenario.intervals
    for interval, _, power_kw in executed_power(trace):
        executed[interval] += 1000 * power_kw
    return executed


def small_needs(start: datetime, minutes: int = 60, count: int = 4, **station) -> Trace:
    """Vehicles side by side whose needs leave a rest below what a charger can hold."""
    hours = count * minutes / 60
    prices = [0.1 + 0.01 * (t % 3) for t in range(count)]
    return finished(
        make_scenario(
            price=prices,
            start=start,
            interval_minutes=minutes,
            station={"min_kw": 3.3, "max_kw": 19.2, "chargers": 20} | station,
            options=[{"name": "C1", "price_per_kwh": 0.5, "average_kw": 2.0}],
            vehicles=[
                vehicle(f"V{n}", need_kwh=need, arrival=start + timedelta(hours=hours * n / 12))
                for n, need in enumerate((1.333, 2.5, 19.9, 4.0, 3.3, 0.7, 6.667))
            ],
        )
    )


CLOCK_CHANGES = [datetime(2025, 10, 25, 22), datetime(2026, 3, 28, 22)]


@pytest.mark.parametrize("start", CLOCK_CHANGES)
def test_over_a_clock_change_loads_meet_as_they_were_checked(start):
    trace = small_needs(start, 15, 48)
    found = messages_of(trace, "Europe/Berlin")
    assert len(found) >= 5
    begin = start.replace(tzinfo=ZoneInfo("Europe/Berlin")).astimezone(UTC)
    means = means_w(union_w(found), begin, 15, 48)
    assert sum(means) > 0
    assert means == pytest.approx(station_w(trace), abs=1.0)
    told = clock_note(trace.scenario, "Europe/Berlin")
    assert "change during the day" in told
    assert f"{begin.astimezone(ZoneInfo('Europe/Berlin')):%z}" in told
    with zipfile.ZipFile(io.BytesIO(profiles_zip(trace, "Europe/Berlin"))) as opened:
        assert told in opened.read("profiles/README.md").decode()
    assert clock_note(trace.scenario, "UTC") == ""


def test_vehicles_after_the_change_begin_at_the_starts_offset():
    trace = small_needs(CLOCK_CHANGES[0], 15, 48)
    records = {record.vehicle: record.request for record in vehicle_records(trace)}
    for profile in profiles(trace, "Europe/Berlin"):
        local = trace.scenario.time_of(records[profile.vehicle].arrival_interval)
        assert profile.begin.replace(tzinfo=None) == local - timedelta(hours=2)


def test_a_start_the_clocks_jump_over_is_refused_and_one_that_comes_twice_is_told():
    with pytest.raises(InputError, match="jump over"):
        profiles(small_needs(datetime(2026, 3, 29, 2, 30)), "Europe/Berlin")
    twice = small_needs(datetime(2025, 10, 26, 2, 30))
    assert "comes twice" in clock_note(twice.scenario, "Europe/Berlin")


@pytest.mark.parametrize(
    ("least", "most"), [(3.3, 19.2), (19.2, 19.2), (6.0, 7.4), (0.0, 5.0), (3.3333333, 7.0)]
)
@pytest.mark.parametrize("current", [None, Current(1, 240.0), Current(3, 230.0)])
def test_every_limit_can_be_held_and_each_interval_has_its_energy(least, most, current):
    if least == most and current == Current(3, 230.0):
        least = most = 13.8  # 20 A; 19.2 kW lie between two tenths of an ampere
    trace = small_needs(datetime(2024, 5, 6), min_kw=least, max_kw=most)
    limit_w = current.phases * current.volts if current else 1.0
    planned: dict[str, dict[int, float]] = {}
    for interval, name, power_kw in executed_power(trace):
        planned.setdefault(name, {})[interval] = 1000 * power_kw
    pulsed = 0
    for profile in profiles(trace, current=current):
        used = {limit * limit_w for limit in profile.limits} - {0.0}
        assert all(1000 * least - 0.01 <= watt <= 1000 * most + 0.01 for watt in used)
        begin = datetime(2024, 5, 6, tzinfo=UTC)
        means = means_w(union_w([message(profile, "1.6")]), begin, 60, 4)
        for t, mean in enumerate(means):
            plan_w, sent_w = planned[profile.vehicle].get(t, 0.0), mean * limit_w
            # a step of the unit, or a second at a fixed power: never above
            step_w = 0.1 * limit_w if current else 0.1
            second_w = most * 1000 / 3600 if 0 < plan_w < 1000 * least else 0.0
            assert plan_w - step_w - second_w <= sent_w <= plan_w + 0.01
            if least < most and not current and plan_w:
                assert sent_w == pytest.approx(plan_w, abs=0.5)  # to the Wh
            pulsed += 0 < plan_w < 1000 * least - 1
    assert pulsed or least == 0.0


def test_parts_of_an_interval_follow_one_another_where_there_is_room():
    scenario = make_scenario(
        price=(0.1,),
        station={"min_kw": 3.3},
        vehicles=[vehicle(f"V{n}", need_kwh=1.0) for n in range(3)],
    )
    found = messages_of(finished(scenario))
    assert len(found) == 3
    assert max(union_w(found).values()) == pytest.approx(3300, abs=5)  # not three times as much


def test_a_vehicle_slower_than_the_charger_gets_its_time_at_its_own_power():
    scenario = make_scenario(
        station={"min_kw": 3.3, "max_kw": 10.0},
        vehicles=[vehicle("slow", need_kwh=1.5, max_kw=2.0)],
    )
    (profile,) = profiles(finished(scenario))
    assert profile.limits == (3300.0, 0.0)[: len(profile.limits)]
    assert profile.starts[1] == 2700  # 1.5 kWh at the 2 kW it takes


@pytest.mark.parametrize("version", VERSIONS)
def test_profiles_in_amperes_state_phases_and_validate(usual, version):
    content = profiles_zip(usual.trace, current=Current(3, 230.0))
    with zipfile.ZipFile(io.BytesIO(content)) as opened:
        names = [n for n in opened.namelist() if f"/ocpp-{version}-A/" in n]
        assert len(names) == usual.totals.admitted
        assert "3 x\n230 V" in opened.read("profiles/README.md").decode()
        for name in names:
            payload = json.loads(opened.read(name))
            validate(version, payload)
            text = json.dumps(payload)
            assert '"chargingRateUnit": "A"' in text
            assert '"numberPhases": 3' in text


def test_a_power_between_two_tenths_of_an_ampere_is_refused_by_name():
    trace = small_needs(datetime(2024, 5, 6), min_kw=11.0, max_kw=11.0)
    with pytest.raises(InputError, match="V0, what its charger can hold: found 11,000 to"):
        profiles(trace, current=Current(3, 230.0))


@pytest.mark.parametrize("text", ["", "230", "4x230", "3x0", "3x230V", "0x230", "3x99999"])
def test_what_is_no_supply_is_refused(text):
    with pytest.raises(InputError, match="3x230, 1x240"):
        current_of(text)


def test_all_profiles_together_are_the_stations_load(usual):
    scenario = usual.scenario
    begin = scenario.start.replace(tzinfo=UTC)
    union = union_w(messages_of(usual.trace))
    means = means_w(union, begin, scenario.interval_minutes, scenario.intervals)
    assert means == pytest.approx(station_w(usual.trace), abs=10.0)
    assert all(m <= w + 0.01 for m, w in zip(means, station_w(usual.trace), strict=True))


def test_no_two_vehicles_share_an_outlet_at_the_same_time(usual):
    served = [r.request for r in vehicle_records(usual.trace) if r.delivered_kwh]
    given = outlets(served)
    spans = [
        (outlet, request.arrival_interval, request.deadline_interval)
        for outlet, request in zip(given, served, strict=True)
    ]
    for n, (outlet, begin, end) in enumerate(spans):
        for other, start, stop in spans[n + 1 :]:
            assert outlet != other or stop <= begin or start >= end
    busiest = max(
        sum(begin <= t < end for _, begin, end in spans) for t in range(usual.scenario.intervals)
    )
    assert max(given) == busiest


def test_names_are_text_in_the_index_and_never_file_names(hostile):
    with zipfile.ZipFile(io.BytesIO(profiles_zip(hostile.trace))) as opened:
        assert all(
            set(name) <= set("abcdefghijklmnopqrstuvwxyzREADME0123456789./-")
            for name in opened.namelist()
        )
        index = json.loads(opened.read("profiles/index.json"))
    assert any("</script>" in row["vehicle"] for row in index)


def test_an_unknown_time_zone_is_refused(usual):
    with pytest.raises(InputError, match="Europe/Berlin"):
        profiles(usual.trace, "Mars/Olympus")
    with pytest.raises(InputError, match="the time zone"):
        profiles(usual.trace, "../../etc/passwd")
