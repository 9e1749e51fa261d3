"""The audit of the station: chargers, limits of the feeder, voltages."""

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from evdash.audit.events import chargers_at
from evdash.audit.record import RunRecord
from evdash.checker.feeder import FeederCheck
from evdash.domain.breach import Breach
from evdash.domain.limits import Floats
from evdash.grid.acflow import AcResult

POWER_KW = 1e-6
VOLTAGE_PU = 1e-6
MORE = 1.001
"""A headroom is right if this much more of it would break a limit."""
SHORT_OF_COLLAPSE = 1.01
"""The same where none has a solution beyond: so near the collapse solvers disagree on it."""
STEP_KW = 0.05
UTMOST_KW = 1e12
"""A power that any limit there is forbids."""
Breaches = Callable[[Floats], Sequence[Breach]]


def station_findings(run: RunRecord) -> Iterator[str]:
    """What is wrong with `intervals.csv` and what the station drew."""
    scenario = run.scenario
    if [row.interval for row in run.intervals] != list(range(scenario.intervals)):
        yield "intervals.csv does not hold every interval once, in order"
        return
    powers = np.array(list(run.power_kw.values())).reshape(-1, scenario.intervals)
    charging = (powers > 0).sum(axis=0)
    arrived = [row.arrival_interval for row in run.vehicles]
    refused = [row.arrival_interval for row in run.vehicles if row.status == "refused"]
    for t, row in enumerate(run.intervals):
        for told, value, right in (
            ("price_per_kwh", row.price_per_kwh, scenario.price_per_kwh[t]),
            ("station_kw", row.station_kw, run.station_kw[t]),
            ("charging", row.charging, charging[t]),
            ("arrived", row.arrived, arrived.count(t)),
            ("refused", row.refused, refused.count(t)),
            ("admitted", row.admitted, arrived.count(t) - refused.count(t)),
        ):
            if abs(value - right) > POWER_KW:
                yield f"interval {t}: {told} is {value:g}, worked out again {right:g}"
        chargers = chargers_at(scenario, t)
        if charging[t] > chargers:
            yield f"interval {t}: {charging[t]} vehicles charge, {chargers} can"
        if row.start != scenario.time_of(t):
            yield f"interval {t}: starts {row.start}, worked out again {scenario.time_of(t)}"


def limit_findings(run: RunRecord, breaches: Breaches, reached: Breaches) -> Iterator[str]:
    """Limits the station worsened, and headrooms that are not what they say.

    `breaches` judges a station power (intervals,) in the run's network model; by `reached`, the
    same without tolerance, a limit must show as exceeded MORE and STEP_KW beyond the headroom.
    """
    for breach in breaches(run.station_kw):
        if breach.by_station:
            clock = f"{run.scenario.time_of(breach.interval):%H:%M}"
            yield f"{breach.element} exceeded by {breach.depth:.6g} {breach.unit} at {clock}"
    headroom = np.array(
        [math.inf if r.headroom_kw is None else r.headroom_kw for r in run.intervals]
    )
    limited = np.isfinite(headroom)
    collapses = np.array([row.binding.startswith("power_flow:") for row in run.intervals])
    more = np.where(collapses, SHORT_OF_COLLAPSE, MORE)
    within = np.where(limited, headroom, 0.0)
    beyond = np.where(limited, np.nan_to_num(headroom * more) + STEP_KW, 0.0)
    too_high = {b.interval for b in breaches(within * (1 - 1e-9)) if b.by_station}
    name = run.scenario.file_name
    bind = {(b.interval, name(b.element.import_side)) for b in reached(beyond) if _is_worsened(b)}
    for t in np.flatnonzero(limited):
        if headroom[t] < 0:
            yield f"interval {t}: headroom_kw is {headroom[t]:g}, should be at least 0"
        if int(t) in too_high:
            yield f"interval {t}: a limit is exceeded before the headroom of {headroom[t]:g} kW"
        if (int(t), run.intervals[t].binding) not in bind:
            element = run.intervals[t].binding or "nothing"
            yield f"interval {t}: {element} does not bind at {headroom[t]:g} kW"
    yield from _unlimited_findings(run, breaches, limited)


def _unlimited_findings(
    run: RunRecord, breaches: Breaches, limited: NDArray[np.bool_]
) -> Iterator[str]:
    """Headrooms left blank where something limits, or said to be limited by something."""
    if limited.all():
        return
    limits = {
        b.interval: b.element for b in breaches(np.where(limited, 0.0, UTMOST_KW)) if b.by_station
    }
    for t in np.flatnonzero(~limited):
        if int(t) in limits:
            yield f"interval {t}: headroom_kw is blank, yet {limits[int(t)]} limits"
        if run.intervals[t].binding:
            yield f"interval {t}: {run.intervals[t].binding} binds, yet headroom_kw is blank"


def _is_worsened(breach: Breach) -> bool:
    """Whether the station worsens a limit, by any amount if the feeder is beyond it by itself.

    Far beyond, as under a load no line could carry, a kW more is less than what counts as equal.
    """
    own = breach.base_depth > breach.tolerance
    return breach.by_station or (own and breach.depth > breach.base_depth)


def voltage_findings(run: RunRecord, check: FeederCheck, flow: AcResult) -> Iterator[str]:
    """Voltages in the file that are not those worked out again, linearised or AC."""
    linear = check.sweep(run.station_kw).voltage_sq_pu
    index = {node: i for i, node in enumerate(flow.nodes)}
    listed = {(row.interval, row.node) for row in run.voltages}
    wanted = {(t, node) for t in range(run.scenario.intervals) for node in flow.nodes}
    if listed != wanted or len(run.voltages) != len(wanted):
        yield "voltages.csv does not hold every node but the source once in every interval"
        return
    for row in run.voltages:
        right = math.sqrt(max(0.0, float(linear[row.node][row.interval])))
        right_ac = float(flow.voltage_pu[row.interval, index[row.node]])
        told_ac = math.nan if row.voltage_ac_pu is None else row.voltage_ac_pu
        if abs(row.voltage_pu - right) > VOLTAGE_PU:
            yield f"interval {row.interval}, node {row.node}: voltage_pu is not {right:.6f}"
        if not _same(told_ac, right_ac):
            yield f"interval {row.interval}, node {row.node}: voltage_ac_pu is not {right_ac:.6f}"


def _same(told: float, right: float) -> bool:
    if math.isnan(told) or math.isnan(right):
        return math.isnan(told) and math.isnan(right)
    return abs(told - right) <= VOLTAGE_PU
