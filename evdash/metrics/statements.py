"""What a run shows of the statements a paper makes about such days."""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import time

import numpy as np

from evdash.domain.trace import Trace
from evdash.metrics.outlook import load_kw
from evdash.metrics.records import (
    executed_power,
    executed_station_kw,
    executed_tariff,
    vehicle_records,
)

Hours = Iterable[tuple[time, time]]
PEAK_SHARE = 0.9
EVEN_KW = 0.05


@dataclass(frozen=True, slots=True)
class Intermittent:
    """Admitted vehicles whose time is up: how many, fully charged, with changing power, paused."""

    over: int
    full: int
    uneven: int
    paused: int


def admitted_within(trace: Trace, hours: Hours) -> tuple[int, int]:
    """(admitted, asked) in the intervals that begin within clock hours, which may pass midnight."""
    spans = list(hours)
    steps = [step for step in trace.steps if any(_in(step.start.time(), *span) for span in spans)]
    admitted = sum(len(step.plan.admitted) for step in steps)
    return admitted, sum(len(step.requests) for step in steps)


def _in(moment: time, begin: time, end: time) -> bool:
    return begin <= moment < end if begin < end else moment >= begin or moment < end


def intermittent(trace: Trace) -> Intermittent:
    """How admitted vehicles were charged whose promised return has come."""
    powers: dict[str, dict[int, float]] = {}
    for interval, vehicle, power_kw in executed_power(trace):
        powers.setdefault(vehicle, {})[interval] = power_kw
    over = [record for record in vehicle_records(trace) if record.status in ("charged", "broken")]
    charged = [powers.get(record.vehicle, {}) for record in over]
    return Intermittent(
        over=len(over),
        full=sum(record.status == "charged" for record in over),
        uneven=sum(bool(p) and max(p.values()) - min(p.values()) > EVEN_KW for p in charged),
        paused=sum(bool(p) and max(p) - min(p) + 1 > len(p) for p in charged),
    )


def price_paid(trace: Trace) -> tuple[float | None, float]:
    """($/kWh paid on average for charging, plain mean of prices) of the intervals executed."""
    station_kw, tariff = executed_station_kw(trace), executed_tariff(trace)
    plain = float(tariff.price_per_kwh.mean()) if len(tariff) else 0.0
    return (tariff.mean_price(station_kw) if station_kw.sum() else None), plain


def station_share_at_peak(trace: Trace) -> float | None:
    """Mean station load while the feeder's is above 90 % of its highest, in % of that otherwise."""
    station_kw = executed_station_kw(trace)
    feeder_kw = np.array([load_kw(step.inputs.scenario)[step.interval] for step in trace.steps])
    if not len(station_kw):
        return None
    at_peak = feeder_kw >= PEAK_SHARE * feeder_kw.max()
    if at_peak.all() or not station_kw[~at_peak].mean():
        return None
    return float(100 * station_kw[at_peak].mean() / station_kw[~at_peak].mean())
