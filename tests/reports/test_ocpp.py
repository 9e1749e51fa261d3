"""OCPP charging profiles against the published schemas, as the package `ocpp` carries them."""

import asyncio
import io
import json
import zipfile
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta

import pytest
from ocpp.messages import Call, validate_payload

from evdash.errors import InputError
from evdash.metrics.records import executed_power, vehicle_records
from evdash.reports.ocpp import VERSIONS, message, outlets, profiles, profiles_zip


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


def test_all_profiles_together_are_the_stations_load(usual):
    step_s = usual.scenario.interval_minutes * 60
    station_w = [0.0] * usual.scenario.intervals
    for profile in profiles(usual.trace):
        first = round((profile.begin.replace(tzinfo=None) - usual.scenario.start).seconds / step_s)
        for slot in range(profile.duration // step_s):
            now = max(n for n, start in enumerate(profile.starts) if start <= slot * step_s)
            station_w[first + slot] += profile.limit_w[now]
    executed = [0.0] * usual.scenario.intervals
    for interval, _, power_kw in executed_power(usual.trace):
        executed[interval] += 1000 * power_kw
    assert station_w == pytest.approx(executed, abs=2.0)


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
