"""A scenario: everything that decides a day, immutable, each field declared once.

Fields and files are those of the scenario folder (`docs/scenario.md`). What one field can
say about itself is checked here by pydantic; what several fields must agree on is checked
in `evdash.files.checks`, so that all faults can be told together.
"""

from collections import Counter
from collections.abc import Callable, Mapping
from datetime import datetime, timedelta
from functools import cached_property
from typing import Annotated, Any, Literal, TypeVar

import numpy as np
from pydantic import BeforeValidator, Field

from evdash.domain.arrivals import Arrivals, LocalTime
from evdash.domain.elements import Element
from evdash.domain.events import Event
from evdash.domain.fields import (
    LARGE,
    SMALL,
    Count,
    Name,
    Number,
    OptionalNumber,
    Record,
    Title,
    declare,
    declare_optional,
)
from evdash.domain.tariff import Tariff

FIRST_ROW = 2
"""A table's first row in its file, after the header."""
MOST_NODES, MOST_OPTIONS, MOST_EVENTS = 5_000, 100, 10_000
"""Sizes beyond which a day would fill the memory of an ordinary machine."""


def _one(value: object) -> object:
    if type(value) is not int:  # 1.0 and true equal 1, too
        raise ValueError("should be 1")
    return value


class Feeder(Record):
    """The `[feeder]` table: where the feeder begins and what its voltages may be."""

    source_node: Name = declare("Node at which the feeder is supplied", "node", "650")
    source_voltage_pu: Number = declare(
        "Voltage held at the source node", "pu", 1.02, gt=0.5, lt=1.5
    )
    voltage_min_pu: Number = declare("Lowest voltage allowed at any node", "pu", 0.97, gt=0, lt=1.5)
    voltage_max_pu: Number = declare("Highest voltage allowed at any node", "pu", 1.03, gt=0, lt=2)
    base_mva: Number = declare("Power base of the per-unit system", "MVA", 5.0, ge=0.001, le=LARGE)
    base_kv: Number = declare("Nominal voltage, line to line", "kV", 4.16, ge=0.1, le=1000)
    load_scale: Number = declare("Factor on every load, kW and kvar", "", 1.0, ge=0, le=100)
    power_factor: Number = declare(
        "Lagging power factor of loads whose kvar are not given", "", 0.9, ge=SMALL, le=1
    )


class Station(Record):
    """The `[station]` table: the charging station, its chargers and their limits."""

    node: Name = declare("Node that hosts the charging station", "node", "634")
    chargers: Count = declare(
        "How many vehicles can charge at the same time", "chargers", 12, ge=0, le=100_000
    )
    min_kw: Number = declare("Lowest power a running charger can hold", "kW", 3.3, ge=0)
    max_kw: Number = declare("Highest power of a charger", "kW", 19.2, ge=SMALL, le=10_000)
    efficiency: Number = declare(
        "Energy into the battery per energy drawn from the grid", "", 0.9, ge=SMALL, le=1
    )


class PriceOption(Record):
    """One `[[option]]`: what a kWh costs the driver and how fast it is promised.

    What that comes to is reckoned in `Request.pays`, the time of return in
    `evdash/horizon/requests.py`; what energy costs the station in `Tariff`.
    """

    name: Name = declare("Name of the price option", "", "C1")
    price_per_kwh: Number = declare(
        "What the driver pays for a kWh drawn from the grid", "$/kWh", 0.35, ge=0, le=1000
    )
    average_kw: Number = declare(
        "Average charging power promised; it sets the time of return", "kW", 9.6, ge=SMALL
    )


class Node(Record):
    """A row of `nodes.csv`. Loads are peak values, three-phase totals; blank means none."""

    node: Name = declare("Name of the node", "", "650")
    load_kw: OptionalNumber = declare_optional("Peak active load", "kW", ge=0, le=LARGE)
    load_kvar: OptionalNumber = declare_optional(
        "Peak reactive load; blank: from the power factor", "kvar", ge=-LARGE, le=LARGE
    )
    shunt_kvar: OptionalNumber = declare_optional(
        "Capacitor, constant power; positive injects", "kvar", ge=-LARGE, le=LARGE
    )
    generation_kw: OptionalNumber = declare_optional("Peak generation", "kW", ge=0, le=LARGE)
    rating_kva: OptionalNumber = declare_optional(
        "Limit of the node's net injection", "kVA", ge=0, le=LARGE
    )
    x: OptionalNumber = declare_optional("Drawing position, to the right", "", ge=-LARGE, le=LARGE)
    y: OptionalNumber = declare_optional("Drawing position, upward", "", ge=-LARGE, le=LARGE)


class Line(Record):
    """A row of `lines.csv`: a line, switch or transformer, positive-sequence at base_kv."""

    from_node: Name = declare("Node at one end", "", "650")
    to_node: Name = declare("Node at the other end", "", "632")
    r_ohm: float = declare("Series resistance", "ohm", 0.1, ge=0, le=LARGE)
    x_ohm: float = declare("Series reactance", "ohm", 0.1, ge=0, le=LARGE)
    rating_kva: OptionalNumber = declare_optional(
        "Limit of what flows through it", "kVA", ge=0, le=LARGE
    )

    @property
    def name(self) -> str:
        """The line as files and screens name it, `633-634`."""
        return f"{self.from_node}-{self.to_node}"

    @property
    def element(self) -> Element:
        """The line as what a limit stands on."""
        return Element("line", self.from_node, self.to_node)


Rated = TypeVar("Rated", Node, Line)


class ProfileRow(Record):
    """A row of `profile.csv`: the conditions of one interval."""

    interval: int = declare("Interval, counted from 0", "", 0, ge=0)
    price_per_kwh: float = declare("Energy price of the interval", "$/kWh", 0.03, ge=-1000, le=1000)
    load_pu: float = declare("Loads per unit of their peak", "pu", 1.0, ge=0, le=100)
    generation_pu: OptionalNumber = declare_optional(
        "Generation per unit of its peak", "pu", ge=0, le=100
    )


class Scenario(Record):
    """A complete day: feeder, station, options, conditions of each interval, arrivals."""

    format: Annotated[Literal[1], BeforeValidator(_one)] = declare(
        "Version of the scenario form", "", 1
    )
    name: Title = declare("Name of the scenario", "", "scenario")
    start: LocalTime = declare("Start of interval 0, local time", "", datetime(2020, 7, 15))
    interval_minutes: Count = declare("Length of an interval", "min", 60, ge=5, le=60)
    intervals: Count = declare("Number of intervals", "intervals", 24, ge=1, le=10_000)
    arrivals_until: Annotated[Count | None, Field()] = declare_optional(
        "Interval from which nobody arrives; left out: the last interval's end", "interval", ge=0
    )
    feeder: Feeder
    station: Station
    option: tuple[PriceOption, ...] = declare(
        "Price options", "", (), min_length=1, max_length=MOST_OPTIONS
    )
    arrivals: Arrivals
    nodes: tuple[Node, ...] = declare(
        "Nodes of the feeder", "", (), min_length=2, max_length=MOST_NODES
    )
    lines: tuple[Line, ...] = declare(
        "Lines of the feeder", "", (), min_length=1, max_length=MOST_NODES
    )
    profile: tuple[ProfileRow, ...] = declare("Conditions by interval", "", (), min_length=1)
    events: tuple[Event, ...] = Field(
        default=(),
        max_length=MOST_EVENTS,
        description="What happens on the way, known only from its interval on",
    )

    @cached_property
    def interval_hours(self) -> float:
        """Length of an interval in h, the paper's Δt."""
        return self.interval_minutes / 60

    @cached_property
    def price_per_kwh(self) -> np.ndarray:
        """Energy price of each interval, $/kWh, shape (intervals,)."""
        return _frozen([row.price_per_kwh for row in self.profile])

    @property
    def tariff(self) -> Tariff:
        """What energy costs the station over the whole horizon."""
        return Tariff(self.price_per_kwh, self.interval_hours)

    @cached_property
    def load_pu(self) -> np.ndarray:
        """Load factor of each interval, shape (intervals,)."""
        return _frozen([row.load_pu for row in self.profile])

    @cached_property
    def generation_pu(self) -> np.ndarray:
        """Generation factor of each interval, shape (intervals,)."""
        return _frozen([row.generation_pu or 0.0 for row in self.profile])

    @cached_property
    def options_by_name(self) -> Mapping[str, PriceOption]:
        return {option.name: option for option in self.option}

    @cached_property
    def rated_elements(self) -> Mapping[str, Element]:
        """What can have a rating, every line and every node but the source, by name in files.

        Where two lines would have one name, as `s-a` to `b` and `s` to `a-b`, that name is
        neither's and each is called by its row in `lines.csv`, `line:row 3`.
        """
        times = Counter(line.name for line in self.lines)
        lines = {
            f"line:row {row}" if times[line.name] > 1 else str(line.element): line.element
            for row, line in enumerate(self.lines, start=FIRST_ROW)
        }
        nodes = (n.node for n in self.nodes if n.node != self.feeder.source_node)
        return lines | {f"node:{node}": Element("node", node) for node in nodes}

    def file_name(self, element: Element | None) -> str:
        """An element as files name it; blank for none."""
        return "" if element is None else self._file_names.get(element, str(element))

    @cached_property
    def _file_names(self) -> Mapping[Element, str]:
        return {element: name for name, element in self.rated_elements.items()}

    def rating_kva_of(self, element: Element) -> float | None:
        """The rating of a line or node, kVA; None where it has none."""
        if element.kind == "node":
            return next((n.rating_kva for n in self.nodes if n.node == element.node), None)
        sought = element.import_side
        return next((line.rating_kva for line in self.lines if line.element == sought), None)

    def with_rating(
        self, element: Element, change: Callable[[float | None], float | None]
    ) -> "Scenario":
        """This scenario with the rating of a line or node, kVA, changed."""

        def changed(one: Rated) -> Rated:
            return one.model_copy(update={"rating_kva": change(one.rating_kva)})

        if element.kind == "node":
            nodes = (changed(n) if n.node == element.node else n for n in self.nodes)
            return self.replacing(nodes=tuple(nodes))
        lines = (changed(one) if one.element == element else one for one in self.lines)
        return self.replacing(lines=tuple(lines))

    @property
    def arrivals_end(self) -> int:
        """The interval from which nobody arrives."""
        return self.intervals if self.arrivals_until is None else self.arrivals_until

    def time_of(self, interval: int) -> datetime:
        """Clock time at which `interval` begins."""
        return self.start + timedelta(minutes=self.interval_minutes * interval)

    def replacing(self, **fields: Any) -> "Scenario":
        """This scenario with already validated parts exchanged."""
        kept = {name: getattr(self, name) for name in Scenario.model_fields}
        return Scenario.model_construct(**(kept | fields))


def _frozen(values: list[float]) -> np.ndarray:
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    return array
