"""The feeder with the executed loads as a pandapower network."""

from datetime import datetime, time, timedelta

import numpy as np

from evdash.domain.arrivals import LOCAL_TIME_FORMAT
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.errors import Fault, InputError
from evdash.grid.handover import handover_json
from evdash.metrics.records import executed_station_kw


def network_json(trace: Trace, interval: int | None = None) -> str:
    """pandapower JSON of a finished day, loaded as in `interval`, by default when the station
    draws most; the other intervals' loads are within."""
    station_kw = executed_station_kw(trace)
    chosen = int(np.argmax(station_kw)) if interval is None else interval
    return handover_json(trace.scenario, station_kw, chosen)


def interval_at(scenario: Scenario, clock: str) -> int:
    """The interval that HH:MM (its first occurrence) or YYYY-MM-DDTHH:MM lies in.

    Raises InputError for what is no time, or none of the day's.
    """
    end = scenario.time_of(scenario.intervals)
    moment = _moment(scenario.start, clock.strip())
    if moment is None or not scenario.start <= moment < end:
        allowed = (
            f"should be HH:MM or YYYY-MM-DDTHH:MM, from {scenario.start:{LOCAL_TIME_FORMAT}} "
            f"to before {end:{LOCAL_TIME_FORMAT}}"
        )
        raise InputError([Fault("the time", repr(clock), allowed)])
    return (moment - scenario.start) // timedelta(minutes=scenario.interval_minutes)


def _moment(start: datetime, clock: str) -> datetime | None:
    try:
        return datetime.strptime(clock, LOCAL_TIME_FORMAT)
    except ValueError:
        pass
    try:
        parsed = datetime.strptime(clock, "%H:%M")
    except ValueError:
        return None
    moment = datetime.combine(start.date(), time(parsed.hour, parsed.minute))
    return moment if moment >= start else moment + timedelta(days=1)
