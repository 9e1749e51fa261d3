"""The days the solver is measured on, each made from the bundled one: (case, seed) → scenario."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import timedelta
from itertools import pairwise
from pathlib import Path

import numpy as np

from evdash.domain.arrivals import FleetModel
from evdash.domain.scenario import Line, Node, Scenario
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario

BUNDLED = Path(__file__).parent.parent / "data" / "presets" / "summer-weekday"


@dataclass(frozen=True, slots=True)
class Case:
    """One row of the table: its days, and what they are to take, s.

    What must be true of the days for the row to say what it says: in every one at least so many
    intervals in which chargers and headroom both bind, and so much of all requests refused.
    `proven`: the share of intervals to end within a cent of their bound.
    """

    name: str
    title: str
    scenario: Callable[[int], Scenario]
    seeds: int
    day_target_seconds: float | None = None
    worst_target_seconds: float | None = None
    proven: float = 1.0
    both_bind: int = 0
    longest_target_seconds: float | None = None
    refused: tuple[float, float] = (0.0, 1.0)


def bundled_day(seed: int) -> Scenario:
    """The bundled summer weekday, about 100 arrivals, 24 intervals."""
    return edit_scenario(read_scenario(BUNDLED), {"arrivals.seed": seed})


def in_quarter_hours(scenario: Scenario) -> Scenario:
    """The same day in quarter-hours: prices hold for the hour, loads run between the hours."""
    hours = np.arange(scenario.intervals)
    quarters = np.arange(4 * scenario.intervals) / 4
    load = np.interp(quarters, hours, scenario.load_pu)
    generation = np.interp(quarters, hours, scenario.generation_pu)
    until = scenario.arrivals_until
    return scenario.replacing(
        interval_minutes=15,
        intervals=4 * scenario.intervals,
        arrivals_until=None if until is None else 4 * until,
        profile=tuple(
            scenario.profile[i // 4].model_copy(
                update={"interval": i, "load_pu": load[i], "generation_pu": generation[i]}
            )
            for i in range(len(quarters))
        ),
    )


def crowded_day(seed: int) -> Scenario:
    """300 arrivals with mixed on-board limits; chargers and headroom both bind in the evening.

    From noon to noon, so that evening and night lie within the horizon. The station's own
    connection is what limits it: under an even load it leaves 380 kW at every hour, 11.5 kW for
    each of the 33 chargers, between what the slow and the fast vehicles take.
    """
    day = edit_scenario(
        bundled_day(seed), {"arrivals.vehicles_per_day": 300.0, "station.chargers": 33}
    )
    fleet = tuple(
        FleetModel(model=f"{max_kw} kW", share=1.0, battery_kwh=battery_kwh, max_kw=max_kw)
        for max_kw, battery_kwh in ((7.2, 40.0), (11.0, 75.0), (19.2, 100.0))
    )
    options = {"fleet": fleet, "option_share": {"C1": 0.2, "C2": 0.8}}
    half = day.intervals // 2
    profile = (*day.profile[half:], *day.profile[:half])
    even = [row.model_copy(update={"interval": i, "load_pu": 0.8}) for i, row in enumerate(profile)]
    rated = [
        node.model_copy(update={"rating_kva": 716.0} if node.node == day.station.node else {})
        for node in day.nodes
    ]
    crowded = day.replacing(
        start=day.start + timedelta(hours=12),
        arrivals=day.arrivals.model_copy(update=options),
        profile=tuple(even),
        nodes=tuple(rated),
    )
    return stronger_feeder(crowded, 4.0)


def stronger_feeder(scenario: Scenario, factor: float) -> Scenario:
    """The same feeder carrying `factor` times the power at the same voltages."""
    return scenario.replacing(
        lines=tuple(
            line.model_copy(
                update={
                    "r_ohm": line.r_ohm / factor,
                    "x_ohm": line.x_ohm / factor,
                    "rating_kva": line.rating_kva and line.rating_kva * factor,
                }
            )
            for line in scenario.lines
        )
    )


def large_day(seed: int, chargers: int = 200, stronger: float = 1.0) -> Scenario:
    """1,000 arrivals and 200 chargers."""
    settings = {"arrivals.vehicles_per_day": 1000.0, "station.chargers": chargers}
    return stronger_feeder(edit_scenario(bundled_day(seed), settings), stronger)


def with_lateral(scenario: Scenario, n_nodes: int) -> Scenario:
    """The feeder grown to `n_nodes` by a long lateral of small loads behind node 671."""
    extra = n_nodes - len(scenario.nodes)
    names = ["671", *(f"x{i}" for i in range(extra))]
    return scenario.replacing(
        nodes=(*scenario.nodes, *(Node(node=name, load_kw=0.2) for name in names[1:])),
        lines=(
            *scenario.lines,
            *(Line(from_node=a, to_node=b, r_ohm=1e-4, x_ohm=1e-4) for a, b in pairwise(names)),
        ),
    )


CASES = (
    Case(
        "bundled",
        "bundled day, 24 intervals",
        bundled_day,
        100,
        0.16,
        0.15,
        longest_target_seconds=0.6,
    ),
    Case(
        "quarters",
        "the same in 96 quarter-hours",
        lambda seed: in_quarter_hours(bundled_day(seed)),
        30,
        1.2,
        0.3,
    ),
    Case(
        "crowded",
        "300 arrivals, 33 chargers, 24 intervals, both limits bind",
        crowded_day,
        30,
        0.5,
        0.5,
        proven=0.99,
        both_bind=4,
        refused=(0.28, 0.38),
    ),
    Case("large", "1,000 arrivals, 200 chargers, 24 intervals", large_day, 10, 2.0, 1.0, 0.99),
    Case(
        "large-quarters",
        "1,000 arrivals, 200 chargers, 96 intervals",
        lambda seed: in_quarter_hours(large_day(seed)),
        5,
        4.0,
        1.0,
        0.99,
    ),
    Case(
        "strong-feeder",
        "500 arrivals, 100 chargers, four times the feeder, 24 intervals",
        lambda seed: stronger_feeder(
            edit_scenario(
                bundled_day(seed),
                {"arrivals.vehicles_per_day": 500.0, "station.chargers": 100},
            ),
            4.0,
        ),
        3,
    ),
)
