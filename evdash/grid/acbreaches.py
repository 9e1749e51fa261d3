"""Limits exceeded in the AC solution, and whether the station is to blame."""

from dataclasses import replace

import numpy as np

from evdash.domain.breach import Breach
from evdash.domain.elements import Element
from evdash.domain.limits import Floats
from evdash.domain.scenario import Scenario
from evdash.grid.acflow import AcResult
from evdash.grid.sides import Power, by_side

TOLERANCE_PU = 1e-6
TOLERANCE_KVA = 1e-3


def ac_breaches(scenario: Scenario, executed: AcResult, base: AcResult) -> tuple[Breach, ...]:
    """Voltages and ratings exceeded in `executed`; `base` is the same without the station.

    Both cover the same intervals, from 0 on. An interval without an AC solution counts as a
    limit exceeded, `power_flow:` and the station's node; the station's doing unless it draws
    nothing in it and there is none without it either.
    """
    limits = scenario.feeder
    found: list[Breach] = []
    for i, node in enumerate(executed.nodes):
        pair = executed.voltage_pu[:, i], base.voltage_pu[:, i]
        low = [limits.voltage_min_pu - voltage for voltage in pair]
        high = [voltage - limits.voltage_max_pu for voltage in pair]
        found += _beyond(Element("voltage_min", node), low, "pu", TOLERANCE_PU)
        found += _beyond(Element("voltage_max", node), high, "pu", TOLERANCE_PU)
    for i, line in enumerate(scenario.lines):
        ends = executed.line_power[:, i], base.line_power[:, i]
        found += _over_rating(line.element, ends, line.rating_kva)
    ratings = {node.node: node.rating_kva for node in scenario.nodes}
    for i, node in enumerate(executed.nodes):
        net = executed.node_power[:, i, None], base.node_power[:, i, None]
        found += _over_rating(Element("node", node), net, ratings[node])
    found += _without_solution(scenario, executed, base)
    return tuple(sorted(found, key=lambda breach: breach.interval))


def _without_solution(scenario: Scenario, executed: AcResult, base: AcResult) -> list[Breach]:
    element = Element("power_flow", scenario.station.node)
    own = set(base.diverged) - _drawing(executed, base)
    return [
        Breach(t, element, 1.0, float(t in own), "solution missing", 0.0) for t in executed.diverged
    ]


def _drawing(executed: AcResult, base: AcResult) -> set[int]:
    """Rows in which the station draws power: injections other than without it."""
    return set(np.flatnonzero((executed.node_power != base.node_power).any(axis=1)).tolist())


def _over_rating(
    element: Element, powers: tuple[Power, Power], rating_kva: float | None
) -> list[Breach]:
    """Both sides of a rating; `powers` executed and without the station, (intervals, ends)."""
    if rating_kva is None:
        return []
    found: list[Breach] = []
    for is_export, side, base in zip((False, True), *map(by_side, powers), strict=True):
        over = [side.kva - rating_kva, side.held_kva(base.end_kva) - rating_kva]
        found += _beyond(replace(element, is_export=is_export), over, "kVA", TOLERANCE_KVA)
    return found


def _beyond(element: Element, depths: list[Floats], unit: str, tolerance: float) -> list[Breach]:
    depth, base_depth = (np.maximum(0.0, values) for values in depths)
    # without an AC solution of the base case the station cannot be cleared
    base_depth = np.nan_to_num(base_depth)
    return [
        Breach(int(t), element, float(depth[t]), float(base_depth[t]), unit, tolerance)
        for t in np.flatnonzero(depth > tolerance)
    ]
