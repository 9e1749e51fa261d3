"""Remedies for who is refused at the door: another amount of energy, or another charger."""

from collections.abc import Iterator

import numpy as np

from evdash.explain.causes import at_the_door
from evdash.explain.remedies import Remedy, RemedyKind, change_by
from evdash.explain.trials import Trials

STEP = 0.01
"""To this the least amount, kWh, and the least power, kW, are told."""
HAIR = 1e-6


def other_terms(trials: Trials) -> tuple[Remedy, ...]:
    """The nearest amounts and powers with which P1 admits the vehicle; none if it would not."""
    return tuple(
        remedy
        for kind, least in _thresholds(trials)
        if (remedy := _verified(trials, kind, least)) is not None
    )


def _thresholds(trials: Trials) -> Iterator[tuple[RemedyKind, float]]:
    """By how much, kWh or kW, the request would have to differ to pass the door (decision 3)."""
    request, hours = trials.request, trials.snapshot.interval_hours
    door, mean_kw = at_the_door(trials), request.need_kwh / hours
    kind = None if door is None else door.kind
    if kind == "end of horizon":
        yield "amount", trials.window * request.max_kw * hours - request.need_kwh
    if kind != "unattainable":
        return
    if request.max_kw < min(request.min_kw, mean_kw):
        yield "amount", request.max_kw * hours - request.need_kwh
        yield "max_kw", min(request.min_kw, mean_kw) - request.max_kw
        return
    fewest = int(np.ceil(mean_kw / request.max_kw))
    yield "amount", fewest * request.min_kw * hours - request.need_kwh
    yield "amount", (fewest - 1) * request.max_kw * hours - request.need_kwh
    yield "max_kw", mean_kw / (fewest - 1) - request.max_kw


def _verified(trials: Trials, kind: RemedyKind, least: float) -> Remedy | None:
    """The remedy if it is possible at all and P1 then admits the vehicle."""
    sign = 1 if least > 0 else -1
    steps = np.ceil(abs(least) / STEP - HAIR)
    amount, less = (round(sign * n * STEP, 6) for n in (steps, steps - 1))
    possible = _fits_battery(trials, amount) if kind == "amount" else _fits_station(trials, amount)
    if not possible or not trials.admits(change_by(kind, amount)):
        return None
    if trials.admits(change_by(kind, less)):
        return None
    return Remedy(kind, amount=amount, refused_at=less, least=True)


def _fits_battery(trials: Trials, more_kwh: float) -> bool:
    request, station = trials.request, trials.inputs.scenario.station
    soc_out = request.soc_out + more_kwh * station.efficiency / request.battery_kwh
    return request.soc_in < soc_out <= 1 + HAIR


def _fits_station(trials: Trials, more_kw: float) -> bool:
    return trials.request.max_kw + more_kw <= trials.inputs.scenario.station.max_kw + HAIR
