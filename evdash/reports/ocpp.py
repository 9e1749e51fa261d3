"""The executed schedule as OCPP charging profiles, one message for each vehicle served.

A `SetChargingProfile` request for the vehicle's transaction: purpose TxProfile, kind Absolute, in
W or in A per phase, each period from `startPeriod` seconds after `startSchedule` on. OCPP 1.6 and
2.0.1 differ in names and nesting, not in what they say.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Any, Literal
from zoneinfo import ZoneInfo, available_timezones

from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.domain.vehicles import Request
from evdash.errors import Fault, InputError
from evdash.files.draft import zipped
from evdash.metrics.records import executed_power, vehicle_records
from evdash.reports.ocpp_limits import (
    WATT_PER_KW,
    Current,
    Pulses,
    Unit,
    parts,
    periods,
    steps_of,
)

Version = Literal["1.6", "2.0.1"]
VERSIONS: tuple[Version, ...] = ("1.6", "2.0.1")
MOST_PERIODS = 1024
"""So many periods a 2.0.1 schedule may have."""
DEFAULT_ZONE = "UTC"


@dataclass(frozen=True, slots=True)
class Profile:
    """What one vehicle is charged with: `limits` from `starts` on, both (periods,).

    `starts` are in s after `begin`, which lies `duration` s before the end. Limits are in W of all
    phases together, or in A of each where `current` says what the outlet is connected to. `outlet`
    counts from 1: where the vehicle is plugged in.
    """

    vehicle: str
    number: int
    outlet: int
    begin: datetime
    duration: int
    starts: tuple[int, ...]
    limits: tuple[float, ...]
    current: Current | None = None

    @property
    def unit(self) -> Unit:
        return "A" if self.current else "W"


def profiles(
    trace: Trace, zone: str = DEFAULT_ZONE, current: Current | None = None
) -> tuple[Profile, ...]:
    """A profile for everyone served, in order of arrival; local times are taken to be `zone`'s.

    Limits are in W, or in A for outlets connected to `current`. Raises InputError for a time zone
    that is unknown or has no such start, a charger that can hold no step of the unit, or a schedule
    with more periods than 2.0.1 allows.
    """
    day_begins = begin_of_day(trace.scenario, zone)
    power: dict[str, dict[int, float]] = {}
    for interval, vehicle, power_kw in executed_power(trace):
        power.setdefault(vehicle, {})[interval] = power_kw
    served = [r.request for r in vehicle_records(trace) if r.vehicle in power]
    seconds = trace.scenario.interval_minutes * 60
    pulses = Pulses(seconds)
    found = []
    for number, (request, outlet) in enumerate(zip(served, outlets(served), strict=True), 1):
        window = range(request.arrival_interval, request.deadline_interval)
        power_w = [WATT_PER_KW * power[request.vehicle].get(t, 0.0) for t in window]
        duration = len(window) * seconds
        starts, limits = periods(
            parts(window, power_w, steps_of(request, current), pulses), duration
        )
        begin = day_begins + timedelta(seconds=request.arrival_interval * seconds)
        found.append(
            Profile(request.vehicle, number, outlet, begin, duration, starts, limits, current)
        )
    _refuse_too_long(found)
    return tuple(found)


def check_zone(zone: str) -> None:
    """Refuse the name of a time zone that is none."""
    if zone not in available_timezones():
        allowed = "should be a name such as UTC, Europe/Berlin or America/Los_Angeles"
        raise InputError([Fault("the time zone", repr(zone), allowed)])


def begin_of_day(scenario: Scenario, zone: str) -> datetime:
    """The moment of interval 0 in UTC; all others are counted from it.

    A scenario has no clock changes: its intervals follow each other at one spacing, and what was
    checked together must happen together. So the whole day keeps the offset its start has.
    """
    check_zone(zone)
    begin = scenario.start.replace(tzinfo=ZoneInfo(zone)).astimezone(UTC)
    if begin.astimezone(ZoneInfo(zone)).replace(tzinfo=None) != scenario.start:
        found, allowed = f"{scenario.start:%Y-%m-%dT%H:%M}", f"clocks of {zone} jump over that time"
        raise InputError([Fault("the scenario's start", found, allowed)])
    return begin


def clock_note(scenario: Scenario, zone: str) -> str:
    """What to know where clocks of the zone change during the day; empty where they do not."""
    begin, local = begin_of_day(scenario, zone), ZoneInfo(zone)
    offsets = {
        (begin + (scenario.time_of(t) - scenario.start)).astimezone(local).utcoffset()
        for t in range(scenario.intervals)
    }
    first = scenario.start.replace(tzinfo=local)
    twice = first.utcoffset() != first.replace(fold=1).utcoffset()
    if len(offsets) == 1 and not twice:
        return ""
    changed = "" if len(offsets) == 1 else f"Clocks of {zone} change during the day. "
    earlier = "The start comes twice on that day's clocks and is the first. " if twice else ""
    return (
        f"{changed}{earlier}Profiles keep the start's offset from UTC, {first:%z}, all day, "
        "so that intervals follow each other as they were checked; after a change the scenario's "
        "times are not those on the wall."
    )


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
    phases = {"numberPhases": profile.current.phases} if profile.current else {}
    schedule: dict[str, Any] = {
        "duration": profile.duration,
        "startSchedule": profile.begin.strftime("%Y-%m-%dT%H:%M:%SZ"),
        "chargingRateUnit": profile.unit,
        "chargingSchedulePeriod": [
            {"startPeriod": start, "limit": limit} | phases
            for start, limit in zip(profile.starts, profile.limits, strict=True)
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


def profiles_zip(trace: Trace, zone: str = DEFAULT_ZONE, current: Current | None = None) -> bytes:
    """All profiles in both versions as a .zip, with a list of whose each file is.

    In W, and in A as well where `current` says what outlets are connected to.
    """
    sets = {"": profiles(trace, zone)}
    if current:
        sets["-A"] = profiles(trace, zone, current)
    amperes = AMPERES.format(phases=current.phases, volts=current.volts) if current else ""
    note = clock_note(trace.scenario, zone)
    readme = README.format(zone=zone, amperes=amperes, note=f"\n{note}\n" if note else "")
    files: dict[str, str] = {"README.md": readme}
    index = []
    for profile in sets[""]:
        name = f"{profile.number:04d}.json"
        index.append({"file": name, "vehicle": profile.vehicle, "outlet": profile.outlet})
    for ending, found in sets.items():
        for profile in found:
            for version in VERSIONS:
                text = json.dumps(message(profile, version), indent=2)
                files[f"ocpp-{version}{ending}/{profile.number:04d}.json"] = text + "\n"
    files["index.json"] = json.dumps(index, indent=2, ensure_ascii=False) + "\n"
    return zipped(dict(files), "profiles")


README = """\
# OCPP charging profiles

A folder for each version of OCPP, in it the payload of one `SetChargingProfile` request for every
vehicle that was charged; `index.json` says whose each file is. Limits are in W of all phases
together, grid side; where the schedule pauses the limit is 0. The local times of the scenario are
taken to be those of {zone} and are given in UTC.
{note}
The schedule and the feeder's limits are means of intervals. Where a mean lies below the least power
a charger can hold, the limit is a power it can hold for a part of the interval, in whole seconds,
and 0 for the rest, so that the energy is the schedule's; such parts follow one another as far as an
interval has room. For a moment the station may draw more than an interval's mean then, never more
energy within the interval. A vehicle that takes less than a charger's least power is given that
as its limit for as long as it needs at its own power. All rounding is downward: a limit by less
than 0.1 W, a part by less than a second where the charger knows one power only.
{amperes}
A charging station takes a TxProfile only for a running transaction: add its `transactionId`
before sending one. `connectorId` or `evseId` counts outlets as if every vehicle kept one of its
own from its arrival to its promised return; set the real one.
"""
AMPERES = """
The folders ending in `-A` say the same in A of each phase, for outlets connected to {phases} x
{volts:g} V (`numberPhases`), rounded down to 0.1 A: up to {phases} x {volts:g} x 0.1 W less than
the schedule, which a vehicle may lack when it returns. At another voltage than this the power is
another; send them only to outlets so connected.
"""
