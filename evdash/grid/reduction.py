"""The exact reduction of (1)-(4) and the line ratings to named rows over station power.

Charging only lowers voltages and adds to what flows towards the station, so of each limit
only the side that charging worsens becomes a row (decision 5 of `docs/equations.md`).
Together the rows describe the paper's feasible set wherever the base case keeps its limits.
"""

import numpy as np

from evdash.domain.elements import Element
from evdash.domain.limits import Floats, LimitRows
from evdash.domain.scenario import Scenario
from evdash.grid.lindistflow import (
    Injections,
    base_injections,
    line_flows,
    sensitivity,
    voltage_sq_pu,
)
from evdash.grid.radial import KW_PER_MW, RadialFeeder, radial_feeder

Named = tuple[list[Element], list[Floats]]


def limit_rows(scenario: Scenario) -> LimitRows:
    """Every limit that the station's power can worsen, in kW of station power."""
    feeder = radial_feeder(scenario)
    base = base_injections(scenario, feeder)
    elements: list[Element] = []
    limits: list[Floats] = []
    for named, columns in (
        node_rating(scenario, feeder, base),
        line_ratings(scenario, feeder, base),
        voltage_minima(scenario, feeder, base),
    ):
        elements += named
        limits += columns
    return LimitRows(
        elements=tuple(elements),
        coefficient=np.ones((len(elements), 1)),
        limit_kw=np.array(limits).T if limits else np.empty((scenario.intervals, 0)),
    )


def active_limit_kw(rating_kva: float, reactive_kvar: Floats) -> Floats:
    """(2) |p| ≤ √(s̄² − q²), kW; 0 where the reactive power alone fills the rating."""
    return np.sqrt(np.maximum(0.0, rating_kva**2 - reactive_kvar**2))


def node_rating(scenario: Scenario, feeder: RadialFeeder, base: Injections) -> Named:
    """(2) at the station's node, the import side: p_load − p_gen + p_EV ≤ √(s̄² − q²)."""
    i = feeder.node_index(scenario.station.node)
    rating_kva = next(n.rating_kva for n in scenario.nodes if n.node == scenario.station.node)
    if rating_kva is None:
        return [], []
    room_kw = active_limit_kw(rating_kva, base.reactive_kvar[:, i]) + base.active_kw[:, i]
    return [Element("node", scenario.station.node)], [room_kw]


def line_ratings(scenario: Scenario, feeder: RadialFeeder, base: Injections) -> Named:
    """(2) for lines and transformers on the station's way, the side away from the source."""
    flows = line_flows(feeder, base)
    on_way = feeder.on_way[feeder.node_index(scenario.station.node)]
    rated = np.flatnonzero(on_way & np.isfinite(feeder.line_rating_kva))
    return [feeder.lines[row] for row in rated], [
        active_limit_kw(feeder.line_rating_kva[row], flows.reactive_kvar[:, row])
        - flows.active_kw[:, row]
        for row in rated
    ]


def voltage_minima(scenario: Scenario, feeder: RadialFeeder, base: Injections) -> Named:
    """(4c), lower side: v_i − R[i, station]·p_EV ≥ v̲ at every node the station can lower."""
    station_r = sensitivity(feeder, feeder.r_pu, feeder.node_index(scenario.station.node))
    slack = voltage_sq_pu(scenario, feeder, base) - scenario.feeder.voltage_min_pu**2
    lowered = np.flatnonzero(station_r > 0)
    base_kva = scenario.feeder.base_mva * KW_PER_MW
    return [Element("voltage_min", feeder.nodes[i]) for i in lowered], [
        slack[:, i] / station_r[i] * base_kva for i in lowered
    ]
