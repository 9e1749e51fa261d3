"""What the parts of a scenario must agree on.

Each check yields the problems it finds. A problem names every place it draws on, so that it
can be left untold where one of them is already known to be faulty.
"""

import math
from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Iterator
from dataclasses import dataclass
from datetime import timedelta

from evdash.domain.arrivals import (
    MOST_VEHICLES,
    ArrivalStatistics,
    GeneratedArrivals,
    RecordedArrivals,
)
from evdash.domain.scenario import Scenario
from evdash.grid.radial import topology_problems

Place = tuple[str | int, ...]
EVERY = -1
"""In the place of a row: every row there is, as many checks draw on a column as a whole."""
SUM_TOLERANCE = 1e-6
MOST_CELLS = 5_000_000
"""Intervals times nodes; the feeder's arrays have so many numbers each."""
MOST_PLANNED = 500_000_000
"""Intervals squared times chargers; every step keeps a plan to the end of the horizon: 4 GB."""
FEW_INTERVALS = 600
"""Two days of five minutes, which any station may have."""
LEAST_OHM = 1e-6
LEAST_SOC = 1e-4
"""A wish smaller than this is none, and would be a contract of no interval at all."""


@dataclass(frozen=True, slots=True)
class Problem:
    """A disagreement: where it stands (first place) and what it draws on (the others).

    A first place that stands alone is drawn on, too.
    """

    places: tuple[Place, ...]
    found: str
    allowed: str


Check = Callable[[Scenario], Iterator[Problem]]


def interval_length(scenario: Scenario) -> Iterator[Problem]:
    if 60 % scenario.interval_minutes:
        yield Problem(
            (("interval_minutes",),),
            f"{scenario.interval_minutes}",
            "should divide 60: 5, 6, 10, 12, 15, 20, 30 or 60 min",
        )


def size(scenario: Scenario) -> Iterator[Problem]:
    cells = scenario.intervals * len(scenario.nodes)
    if cells > MOST_CELLS:
        yield Problem(
            (("intervals",), ("nodes",)),
            f"{scenario.intervals} intervals for {len(scenario.nodes)} nodes",
            f"should be at most {MOST_CELLS:,} in all, intervals times nodes",
        )
    known = scenario.arrivals
    if isinstance(known, GeneratedArrivals):
        arriving = min(scenario.arrivals_end, scenario.intervals)
        expected = known.vehicles_per_day * arriving * scenario.interval_hours / 24
        if expected > MOST_VEHICLES:
            yield Problem(
                (("arrivals", "vehicles_per_day"), ("intervals",), ("arrivals_until",)),
                f"{known.vehicles_per_day:g}, or {expected:,.0f} vehicles in all",
                f"should be at most {MOST_VEHICLES:,} in all",
            )


def plans_kept(scenario: Scenario) -> Iterator[Problem]:
    chargers = scenario.station.chargers
    most = max(FEW_INTERVALS, math.isqrt(MOST_PLANNED // max(1, chargers)))
    if scenario.intervals > most:
        yield Problem(
            (("intervals",), ("station", "chargers")),
            f"{scenario.intervals} intervals with {chargers} chargers",
            f"should be at most {most:,} intervals with so many, as the plan of each is kept to "
            "the end; longer intervals or fewer days do",
        )


def arrivals_end(scenario: Scenario) -> Iterator[Problem]:
    if scenario.arrivals_end > scenario.intervals:
        yield Problem(
            (("arrivals_until",), ("intervals",)),
            f"{scenario.arrivals_until}",
            f"should be at most the number of intervals, {scenario.intervals}",
        )


def voltage_band(scenario: Scenario) -> Iterator[Problem]:
    low, high = scenario.feeder.voltage_min_pu, scenario.feeder.voltage_max_pu
    if low >= high:
        yield Problem(
            (("feeder", "voltage_min_pu"), ("feeder", "voltage_max_pu")),
            f"{low:g} pu",
            f"should be below voltage_max_pu, {high:g} pu",
        )


def charger_limits(scenario: Scenario) -> Iterator[Problem]:
    station = scenario.station
    if station.min_kw > station.max_kw:
        yield Problem(
            (("station", "min_kw"), ("station", "max_kw")),
            f"{station.min_kw:g} kW",
            f"should be at most max_kw, {station.max_kw:g} kW",
        )
    for i, option in enumerate(scenario.option):
        if option.average_kw > station.max_kw:
            yield Problem(
                (("option", i, "average_kw"), ("station", "max_kw")),
                f"{option.average_kw:g} kW",
                f"should be at most the station's max_kw, {station.max_kw:g} kW",
            )


def unique_names(scenario: Scenario) -> Iterator[Problem]:
    nodes = [node.node for node in scenario.nodes]
    yield from _repeated(nodes, [("nodes", i, "node") for i in range(len(nodes))])
    options = [option.name for option in scenario.option]
    yield from _repeated(options, [("option", i, "name") for i in range(len(options))])
    if isinstance(scenario.arrivals, RecordedArrivals):
        vehicles = [arrival.vehicle for arrival in scenario.arrivals.vehicles]
        places: list[Place] = [("arrivals", "vehicles", i, "vehicle") for i in range(len(vehicles))]
        yield from _repeated(vehicles, places)


def known_nodes(scenario: Scenario) -> Iterator[Problem]:
    nodes = {node.node for node in scenario.nodes}
    source, station = scenario.feeder.source_node, scenario.station.node
    node_names = _column("nodes", "node")
    named: list[tuple[Place, str]] = [
        (("feeder", "source_node"), source),
        (("station", "node"), station),
    ]
    for i, line in enumerate(scenario.lines):
        named += [
            (("lines", i, "from_node"), line.from_node),
            (("lines", i, "to_node"), line.to_node),
        ]
    for place, name in named:
        if name not in nodes:
            rule = "should be a node of nodes.csv"
            yield Problem((place, node_names), repr(name), rule)
    if station == source:
        yield Problem(
            (("station", "node"), ("feeder", "source_node")),
            repr(station),
            "should not be the source node",
        )


def radial_topology(scenario: Scenario) -> Iterator[Problem]:
    nodes = {node.node for node in scenario.nodes}
    ends = {end for line in scenario.lines for end in (line.from_node, line.to_node)}
    source = scenario.feeder.source_node
    if not (ends | {source}) <= nodes:
        return  # told by `known_nodes`
    drawn_on = (
        _column("nodes", "node"),
        _column("lines", "from_node"),
        _column("lines", "to_node"),
        ("feeder", "source_node"),
    )
    for row, found, allowed in topology_problems(scenario.nodes, scenario.lines, source):
        place: Place = ("lines",) if row is None else ("lines", row)
        yield Problem((place, *drawn_on), found, allowed)


def line_impedances(scenario: Scenario) -> Iterator[Problem]:
    for i, line in enumerate(scenario.lines):
        if max(line.r_ohm, line.x_ohm) < LEAST_OHM:
            yield Problem(
                (("lines", i, "r_ohm"), ("lines", i, "x_ohm")),
                f"{line.r_ohm:g} ohm, and x_ohm {line.x_ohm:g}",
                f"one of them should be at least {LEAST_OHM:g}; a switch has a small resistance",
            )


def profile_rows(scenario: Scenario) -> Iterator[Problem]:
    listed = [row.interval for row in scenario.profile]
    for i, interval in enumerate(listed):
        if interval >= scenario.intervals:
            yield Problem(
                (("profile", i, "interval"), ("intervals",)),
                f"{interval}",
                f"should be below the number of intervals, {scenario.intervals}",
            )
    yield from _repeated(listed, [("profile", i, "interval") for i in range(len(listed))])
    missing = sorted(set(range(scenario.intervals)) - set(listed))
    if missing:
        yield Problem(
            (("profile",), ("intervals",), _column("profile", "interval")),
            f"no row for interval {_spans(missing)}",
            f"should have one row for each of the {scenario.intervals} intervals",
        )
    generating = _column("nodes", "generation_kw")
    if any(node.generation_kw for node in scenario.nodes):
        for i, row in enumerate(scenario.profile):
            if row.generation_pu is None:
                yield Problem(
                    (("profile", i, "generation_pu"), generating),
                    "a blank",
                    "should be given, as nodes.csv has generation",
                )


def recorded_arrivals(scenario: Scenario) -> Iterator[Problem]:
    if not isinstance(scenario.arrivals, RecordedArrivals):
        return
    # an end beyond the horizon is told elsewhere, and may be beyond the calendar
    minutes = scenario.interval_minutes * min(scenario.arrivals_end, scenario.intervals)
    end = scenario.start + timedelta(minutes=minutes)
    timing: tuple[Place, ...] = (
        ("start",),
        ("interval_minutes",),
        ("intervals",),
        ("arrivals_until",),
    )
    for i, arrival in enumerate(scenario.arrivals.vehicles):
        row: Place = ("arrivals", "vehicles", i)
        if not scenario.start <= arrival.arrival < end:
            yield Problem(
                ((*row, "arrival"), *timing),
                f"{arrival.arrival:%Y-%m-%dT%H:%M}",
                f"should be from {scenario.start:%Y-%m-%dT%H:%M} to before {end:%Y-%m-%dT%H:%M}",
            )
        if arrival.option not in scenario.options_by_name:
            yield Problem(
                ((*row, "option"), _column("option", "name")),
                repr(arrival.option),
                f"should be one of {', '.join(scenario.options_by_name)}",
            )
        if arrival.soc_out - arrival.soc_in < LEAST_SOC:
            yield Problem(
                ((*row, "soc_out"), (*row, "soc_in")),
                f"{arrival.soc_out:g}",
                f"should be above soc_in, {arrival.soc_in:g}, by at least {LEAST_SOC:g}",
            )


def arrival_statistics(scenario: Scenario) -> Iterator[Problem]:
    known = scenario.arrivals
    if isinstance(known, GeneratedArrivals):
        yield from _statistics_problems(scenario, known, ("arrivals",))
    elif isinstance(known, RecordedArrivals) and known.forecast is not None:
        yield from _statistics_problems(scenario, known.forecast, ("arrivals", "forecast"))


def _statistics_problems(
    scenario: Scenario, statistics: ArrivalStatistics, where: Place
) -> Iterator[Problem]:
    shares = statistics.option_share
    for name in shares:
        if name not in scenario.options_by_name:
            yield Problem(
                ((*where, "option_share", name), _column("option", "name")),
                repr(name),
                f"should be one of {', '.join(scenario.options_by_name)}",
            )
    if abs(sum(shares.values()) - 1) > SUM_TOLERANCE:
        yield Problem(
            ((*where, "option_share"),), f"a sum of {sum(shares.values()):g}", "should sum to 1"
        )
    if sum(statistics.hourly_share) <= 0:
        yield Problem(((*where, "hourly_share"),), "a sum of 0", "should sum to more than 0")
    if sum(model.share for model in statistics.fleet) <= 0:
        yield Problem(((*where, "fleet"),), "shares with a sum of 0", "should sum to more than 0")
    low, high = statistics.soc_out
    if low > high:
        yield Problem(
            ((*where, "soc_out"),), f"[{low:g}, {high:g}]", "should be [low, high], low first"
        )


CHECKS: tuple[Check, ...] = (
    interval_length,
    size,
    plans_kept,
    arrivals_end,
    voltage_band,
    charger_limits,
    unique_names,
    known_nodes,
    radial_topology,
    line_impedances,
    profile_rows,
    recorded_arrivals,
    arrival_statistics,
)


def _column(table: str, column: str) -> Place:
    return (table, EVERY, column)


def _repeated(names: Iterable[Hashable], places: list[Place]) -> Iterator[Problem]:
    listed = list(names)
    counts = Counter(listed)
    seen: set[Hashable] = set()
    for name, place in zip(listed, places, strict=True):
        if counts[name] > 1 and name in seen:
            yield Problem((place,), f"{name!r} again", "should be named once only")
        seen.add(name)


def _spans(numbers: list[int]) -> str:
    """Consecutive numbers as spans, `3, 7–12`."""
    spans: list[list[int]] = []
    for number in numbers:
        if spans and number == spans[-1][1] + 1:
            spans[-1][1] = number
        else:
            spans.append([number, number])
    return ", ".join(f"{a}" if a == b else f"{a}–{b}" for a, b in spans)
