"""The audit of `summary.json`: every total and list worked out again from the other files."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from evdash.audit.coverage import SUMMARY_KEYS
from evdash.audit.objective import SOLVES_P1
from evdash.audit.record import RunRecord
from evdash.domain.breach import Breach
from evdash.domain.plan import is_outside
from evdash.files.run_folder import RUN_FORMAT
from evdash.grid.acflow import AcResult

CLOSE = 1e-6
"""How far apart numbers may be, relative to the larger and at least in their unit."""
LISTED = ("interval", "element", "depth", "unit")


def summary_findings(
    run: RunRecord,
    linear: Sequence[Breach],
    ac: Sequence[Breach],
    flow: AcResult,
    voltage_error_pu: float | None,
) -> Iterator[str]:
    """Keys of `summary.json` that the other files do not bear out.

    `linear` and `ac` are the limits exceeded in each model, chargers included; `flow` the AC
    power flow of what was executed; `voltage_error_pu` its largest difference from linearised.
    """
    summary = run.summary
    for key in sorted(set(SUMMARY_KEYS) ^ set(summary)):
        yield f"summary.json: {key} is {'missing' if key in SUMMARY_KEYS else 'not known'}"
    if summary.get("scenario_sha256") != run.scenario_hash:
        yield "scenario/ is not the scenario of this run: its hash differs from summary.json's"
    policy = summary.get("policy")
    if policy not in SOLVES_P1 and not is_outside(str(policy)):
        allowed = f"{', '.join(SOLVES_P1)}, and module:function from outside"
        yield f"summary.json: policy is {policy!r}, there are {allowed}"
    right = _totals(run) | {
        "format": RUN_FORMAT,
        "scenario": run.given.name,
        "seed": run.given.arrivals.seed,
        "ac_without_solution": list(flow.diverged),
        "worst_voltage_error_pu": voltage_error_pu,
    }
    for prefix, breaches in (("", linear), ("ac_", ac)):
        by_station = [told(breach) for breach in breaches if breach.by_station]
        by_feeder = [told(breach) for breach in breaches if not breach.by_station]
        right |= {
            f"{prefix}limits_broken_by_station": _in_order(by_station),
            f"{prefix}limits_broken_by_feeder": _in_order(by_feeder),
        }
    for key, value in right.items():
        if not same(_in_order(summary.get(key)), value):
            shown = [_shown(one) for one in (summary.get(key), value)]
            yield f"summary.json: {key} is {shown[0]}, worked out again {shown[1]}"
    yield from _circumstances(summary)


def _totals(run: RunRecord) -> dict[str, Any]:
    scenario, statuses = run.scenario, [row.status for row in run.vehicles]
    hours, station_kw = scenario.interval_minutes / 60, run.station_kw
    revenue = math.fsum(row.revenue for row in run.vehicles)
    cost = math.fsum((station_kw * scenario.price_per_kwh).tolist()) * hours
    decided = [row.status for row in run.intervals]
    return {
        "arrived": len(statuses),
        "admitted": len(statuses) - statuses.count("refused"),
        "refused": statuses.count("refused"),
        "charged": statuses.count("charged"),
        "broken": statuses.count("broken"),
        "released": statuses.count("released"),
        "energy_requested_kwh": math.fsum(one.need_kwh for one in run.asked.values()),
        "energy_delivered_kwh": math.fsum(station_kw.tolist()) * hours,
        "revenue": revenue,
        "energy_cost": cost,
        "profit": revenue - cost,
        "peak_station_kw": float(station_kw.max(initial=0.0)),
        "intervals": scenario.intervals,
        "optimal_intervals": decided.count("optimal"),
        "fallback_intervals": decided.count("fallback"),
    }


def _circumstances(summary: Mapping[str, object]) -> Iterator[str]:
    """The form of what is taken on trust."""
    wall = summary.get("wall_seconds")
    if isinstance(wall, bool) or not isinstance(wall, int | float) or not wall >= 0:
        yield f"summary.json: wall_seconds is {_shown(wall)}, should be a time in s"
    versions = summary.get("versions")
    if not isinstance(versions, dict) or not all(isinstance(v, str) for v in versions.values()):
        yield f"summary.json: versions is {_shown(versions)}, should be names with versions"


def told(breach: Breach) -> dict[str, object]:
    """A limit exceeded as `summary.json` tells it."""
    return {name: getattr(breach, name) for name in LISTED} | {"element": str(breach.element)}


def _in_order(value: Any) -> Any:
    """A list of limits exceeded in an order of its own, anything else as it is."""
    if isinstance(value, list) and all(isinstance(one, dict) for one in value):
        return sorted(value, key=lambda one: (str(one.get("interval")), str(one.get("element"))))
    return value


def same(found: Any, right: Any) -> bool:
    """Whether two values of JSON are the same, numbers but for what floating point makes of them.

    A number is no truth value, a whole number stays whole.
    """
    if isinstance(right, dict):
        is_like = isinstance(found, dict) and set(found) == set(right)
        return is_like and all(same(found[key], value) for key, value in right.items())
    if isinstance(right, list):
        is_like = isinstance(found, list) and len(found) == len(right)
        return is_like and all(same(*pair) for pair in zip(found, right, strict=True))
    if isinstance(right, float):
        if isinstance(found, bool) or not isinstance(found, int | float):
            return False
        return abs(found - right) <= CLOSE * max(1.0, abs(right))
    return type(found) is type(right) and bool(found == right)


def _shown(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, list):
        return f"a list of {len(value)} that differs" if value else "an empty list"
    return "blank" if value is None else str(value)


def voltage_error_pu(run: RunRecord) -> float | None:
    """Largest difference between the voltages of `voltages.csv`, pu; None without any in AC."""
    errors = [
        abs(row.voltage_pu - row.voltage_ac_pu)
        for row in run.voltages
        if row.voltage_ac_pu is not None
    ]
    return float(np.max(errors)) if errors else None
