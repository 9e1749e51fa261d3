"""The executed schedule as OCPP charging profiles, one message for each vehicle served.

A `SetChargingProfile` request for the vehicle's transaction: purpose TxProfile, kind Absolute, in
W, each period from `startPeriod` seconds after `startSchedule` on. OCPP 1.6 and 2.0.1 differ in
names and nesting, not in what they say.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any, Literal
from zoneinfo import ZoneInfo, available_timezones

from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.domain.vehicles import Request
from evdash.errors import Fault, InputError
from evdash.files.draft import zipped
from evdash.metrics.records import executed_power, vehicle_records

Version = Literal["1.6", "2.0.1"]
VERSIONS: tuple[Version, ...] = ("1.6", "2.0.1")
WATT_PER_KW = 1000.0
MOST_PERIODS = 1024
"""So many periods a 2.0.1 schedule may have."""
DEFAULT_ZONE = "UTC"


@dataclass(frozen=True, slots=True)
class Profile:
    """What one vehicle is charged with: `limit_w` from `starts` on, both (periods,).

    `starts` are in s after `begin`, which lies `duration` s before the end. `outlet` counts from
    1: where it is plugged in.
    """

    vehicle: str
    number: int
    outlet: int
    begin: datetime
    duration: int
    starts: tuple[int, ...]
    limit_w: tuple[float, ...]


def profiles(trace: Trace, zone: str = DEFAULT_ZONE) -> tuple[Profile, ...]:
    """A profile for everyone served, in order of arrival; local times are taken to be `zone`'s.

    Raises InputError for an unknown time zone, or a schedule with more periods than 2.0.1 allows.
    """
    check_zone(zone)
    power: dict[str, dict[int, float]] = {}
    for interval, vehicle, power_kw in executed_power(trace):
        power.setdefault(vehicle, {})[interval] = power_kw
    served = [r.request for r in vehicle_records(trace) if r.vehicle in power]
    found = []
    for number, (request, outlet) in enumerate(zip(served, outlets(served), strict=True), 1):
        window = range(request.arrival_interval, request.deadline_interval)
        limits_kw = [power[request.vehicle].get(t, 0.0) for t in window]
        found.append(_profile(trace.scenario, request, (number, outlet), limits_kw, ZoneInfo(zone)))
    _refuse_too_long(found)
    return tuple(found)


def check_zone(zone: str) -> None:
    """Refuse the name of a time zone that is none."""
    if zone not in available_timezones():
        allowed = "should be a name such as UTC, Europe/Berlin or America/Los_Angeles"
        raise InputError([Fault("the time zone", repr(zone), allowed)])


def outlets(served: Sequence[Request]) -> list[int]:
    """An outlet for each vehicle, from 1 on, that no other one has at the same time.

    A vehicle keeps its outlet from its arrival to its promised return, so that there may be more
    outlets than vehicles charging at once.
    """
    free_from: list[int] = []
    given = []
    for request in served:
        free = (n for n, until in enumerate(free_from) if until <= request.arrival_interval)
        place = next(free, len(free_from))
        if place == len(free_from):
            free_from.append(0)
        free_from[place] = request.deadline_interval
        given.append(place + 1)
    return given


def _profile(
    scenario: Scenario,
    request: Request,
    numbers: tuple[int, int],
    window_kw: Sequence[float],
    zone: ZoneInfo,
) -> Profile:
    number, outlet = numbers
    seconds = scenario.interval_minutes * 60
    begin = scenario.time_of(request.arrival_interval).replace(tzinfo=zone)
    limits = [round(kw * WATT_PER_KW, 1) for kw in window_kw]
    changes = [t for t, limit in enumerate(limits) if t == 0 or limit != limits[t - 1]]
    return Profile(
        vehicle=request.vehicle,
        number=number,
        outlet=outlet,
        begin=begin.astimezone(UTC),
        duration=len(limits) * seconds,
        starts=tuple(t * seconds for t in changes),
        limit_w=tuple(limits[t] for t in changes),
    )


def _refuse_too_long(found: Sequence[Profile]) -> None:
    faults = [
        Fault(profile.vehicle, f"{len(profile.starts):,} periods", f"at most {MOST_PERIODS:,}")
        for profile in found
        if len(profile.starts) > MOST_PERIODS
    ]
    if faults:
        raise InputError(faults)


def message(profile: Profile, version: Version) -> dict[str, Any]:
    """The payload of a SetChargingProfile request."""
    schedule: dict[str, Any] = {
        "duration": profile.duration,
        "startSchedule": profile.begin.strftime("%Y-%m-%dT%H:%M:%SZ"),
        "chargingRateUnit": "W",
        "chargingSchedulePeriod": [
            {"startPeriod": start, "limit": limit}
            for start, limit in zip(profile.starts, profile.limit_w, strict=True)
        ],
    }
    of_transaction = {
        "stackLevel": 0,
        "chargingProfilePurpose": "TxProfile",
        "chargingProfileKind": "Absolute",
    }
    if version == "1.6":
        told = {"chargingProfileId": profile.number, **of_transaction, "chargingSchedule": schedule}
        return {"connectorId": profile.outlet, "csChargingProfiles": told}
    listed = [{"id": profile.number, **schedule}]
    told = {"id": profile.number, **of_transaction, "chargingSchedule": listed}
    return {"evseId": profile.outlet, "chargingProfile": told}


def profiles_zip(trace: Trace, zone: str = DEFAULT_ZONE) -> bytes:
    """All profiles in both versions as a .zip, with a list of whose each file is."""
    found = profiles(trace, zone)
    files: dict[str, str] = {"README.md": README.format(zone=zone)}
    index = []
    for profile in found:
        name = f"{profile.number:04d}.json"
        index.append({"file": name, "vehicle": profile.vehicle, "outlet": profile.outlet})
        for version in VERSIONS:
            text = json.dumps(message(profile, version), indent=2)
            files[f"ocpp-{version}/{name}"] = text + "\n"
    files["index.json"] = json.dumps(index, indent=2, ensure_ascii=False) + "\n"
    return zipped(dict(files), "profiles")


README = """\
# OCPP charging profiles

A folder for each version of OCPP, in it the payload of one `SetChargingProfile` request for every
vehicle that was charged; `index.json` says whose each file is. Limits are in W, grid side, the
mean of an interval; where the schedule pauses the limit is 0. The local times of the scenario are
taken to be those of {zone} and are given in UTC.

A charging station takes a TxProfile only for a running transaction: add its `transactionId`
before sending one. `connectorId` or `evseId` counts outlets as if every vehicle kept one of its
own from its arrival to its promised return; set the real one.
"""
