"""Small scenarios for tests: one made to measure, and random ones for hypothesis.

Everything goes through `validate`, so that no test runs on input a user could not give.
"""

from collections.abc import Iterable, Mapping, Sequence
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

from hypothesis import strategies as st

from evdash.domain.elements import Element
from evdash.domain.scenario import Scenario
from evdash.files.validate import validate

PRESETS = Path(__file__).parent.parent / "data" / "presets"
START = datetime(2024, 5, 6)
FEEDER = {
    "source_node": "s",
    "source_voltage_pu": 1.0,
    "voltage_min_pu": 0.9,
    "voltage_max_pu": 1.1,
    "base_mva": 1.0,
    "base_kv": 4.16,
    "load_scale": 1.0,
    "power_factor": 0.9,
}
STATION = {"node": "a", "chargers": 3, "min_kw": 2.0, "max_kw": 10.0, "efficiency": 1.0}
OPTIONS = (
    {"name": "C1", "price_per_kwh": 0.4, "average_kw": 8.0},
    {"name": "C2", "price_per_kwh": 0.3, "average_kw": 4.0},
)


def node(name: str, **fields: float | None) -> dict[str, Any]:
    """A row of nodes.csv: `node("a", load_kw=40)`."""
    return {"node": name, **fields}


def line(from_node: str, to_node: str, r: float = 0.1, x: float = 0.1, rating: Any = None) -> Any:
    """A row of lines.csv."""
    ends = {"from_node": from_node, "to_node": to_node}
    return {**ends, "r_ohm": r, "x_ohm": x, "rating_kva": rating}


def vehicle(name: str, hour: float = 0.0, need_kwh: float = 10.0, **fields: Any) -> dict[str, Any]:
    """A row of arrivals.csv that asks for `need_kwh` (at efficiency 1) `hour` hours after START."""
    arrival = START + timedelta(minutes=round(60 * hour))
    battery = fields.pop("battery_kwh", 2 * need_kwh)
    row = {"vehicle": name, "arrival": arrival, "option": "C1", "battery_kwh": battery}
    return {**row, "soc_in": 0.25, "soc_out": 0.25 + need_kwh / battery, **fields}


def make_scenario(
    *,
    nodes: Sequence[Mapping[str, Any]] = ({"node": "s"}, {"node": "a"}),
    lines: Sequence[Mapping[str, Any]] = (
        {"from_node": "s", "to_node": "a", "r_ohm": 0.1, "x_ohm": 0.1},
    ),
    price: Sequence[float] = (0.1, 0.2, 0.15, 0.05),
    load: Sequence[float] | None = None,
    generation: Sequence[float] | None = None,
    vehicles: Sequence[Mapping[str, Any]] = (),
    feeder: Mapping[str, Any] | None = None,
    station: Mapping[str, Any] | None = None,
    options: Sequence[Mapping[str, Any]] = OPTIONS,
    arrivals: Mapping[str, Any] | None = None,
    **fields: Any,
) -> Scenario:
    """A scenario on the feeder s–a unless told otherwise; one interval for each price.

    `feeder` and `station` change single keys of those tables; `arrivals` stands in for
    `vehicles` where they are to be drawn; other keywords are keys of scenario.toml.
    """
    rows = zip(price, load or [1.0] * len(price), generation or [1.0] * len(price), strict=True)
    raw: dict[str, Any] = {
        "format": 1,
        "name": "made for a test",
        "start": START,
        "interval_minutes": 60,
        "intervals": len(price),
        "feeder": FEEDER | dict(feeder or {}),
        "station": STATION | dict(station or {}),
        "option": list(options),
        "arrivals": arrivals or {"vehicles": list(vehicles)},
        "nodes": list(nodes),
        "lines": list(lines),
        "profile": [
            {"interval": t, "price_per_kwh": c, "load_pu": pu, "generation_pu": generated}
            for t, (c, pu, generated) in enumerate(rows)
        ],
    }
    return validate(raw | fields)


def generator(**changes: Any) -> dict[str, Any]:
    """The `[arrivals]` of a scenario whose arrivals are drawn."""
    return {
        "seed": 1,
        "vehicles_per_day": 60.0,
        "hourly_share": [1.0] * 24,
        "option_share": {"C1": 0.5, "C2": 0.5},
        "soc_in_beta": [2.3, 1.7],
        "soc_out": [0.8, 1.0],
        "fleet": [
            {"model": "small", "share": 2, "battery_kwh": 30.0, "max_kw": 6.6},
            {"model": "large", "share": 1, "battery_kwh": 80.0, "max_kw": 11.0},
        ],
    } | changes


def _numbers(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False).map(lambda value: round(value, 4))


def _or_none(numbers: st.SearchStrategy[float]) -> st.SearchStrategy[float | None]:
    return st.one_of(st.none(), numbers)


@st.composite
def trees(draw: st.DrawFn, max_nodes: int = 8, rated: bool = True) -> dict[str, Any]:
    """A random radial feeder: nodes, lines and the station's node, as `make_scenario` takes them.

    Lines are told in any order and direction; loads are such that an AC solution exists.
    """
    names = ["s", *(f"{634 + i}" for i in range(draw(st.integers(1, max_nodes - 1))))]
    ratings = _or_none(_numbers(20, 800)) if rated else st.none()
    nodes = [{"node": "s"}] + [
        node(
            name,
            load_kw=draw(_or_none(_numbers(0, 90))),
            load_kvar=draw(_or_none(_numbers(-20, 50))),
            shunt_kvar=draw(_or_none(_numbers(-20, 60))),
            generation_kw=draw(_or_none(_numbers(0, 120))),
            rating_kva=draw(ratings),
        )
        for name in names[1:]
    ]
    lines = []
    for i, name in enumerate(names[1:], 1):
        ends = [names[draw(st.integers(0, i - 1))], name]
        ends = ends[::-1] if draw(st.booleans()) else ends
        lines.append(line(*ends, draw(_numbers(0.001, 0.3)), draw(_numbers(0, 0.3)), draw(ratings)))
    return {
        "nodes": draw(st.permutations(nodes)),
        "lines": draw(st.permutations(lines)),
        "station": {"node": draw(st.sampled_from(names[1:]))},
    }


@st.composite
def fleets(draw: st.DrawFn, hours: float, max_vehicles: int = 6) -> list[dict[str, Any]]:
    """Random arrivals within `hours`, of which some may be unattainable."""
    return [
        vehicle(
            f"{n}",
            hour=draw(st.integers(0, int(60 * hours) - 1)) / 60,
            need_kwh=draw(_numbers(0.1, 40)),
            battery_kwh=80.0,
            option=draw(st.sampled_from(["C1", "C2"])),
            max_kw=draw(_or_none(_numbers(3, 12))),
        )
        for n in range(draw(st.integers(0, max_vehicles)))
    ]


@st.composite
def scenarios(
    draw: st.DrawFn, max_nodes: int = 8, max_vehicles: int = 6, rated: bool = True
) -> Scenario:
    """A random radial feeder over a few intervals, with random arrivals."""
    intervals = draw(st.integers(1, 6))
    minutes = draw(st.sampled_from([15, 30, 60]))

    def series(low: float, high: float) -> list[float]:
        return [draw(_numbers(low, high)) for _ in range(intervals)]

    tree = draw(trees(max_nodes, rated))
    return make_scenario(
        nodes=tree["nodes"],
        lines=tree["lines"],
        station=tree["station"] | {"chargers": draw(st.integers(0, 4))},
        feeder={
            "source_voltage_pu": draw(_numbers(0.98, 1.04)),
            "voltage_min_pu": draw(_numbers(0.9, 0.98)),
            "voltage_max_pu": draw(_numbers(1.0, 1.06)),
            "base_mva": draw(st.sampled_from([0.5, 1.0, 5.0])),
            "load_scale": draw(st.sampled_from([0.0, 0.5, 1.0, 1.2])),
            "power_factor": draw(_numbers(0.8, 1.0)),
        },
        price=series(-0.1, 0.5),
        load=series(0, 1.2),
        generation=series(0, 1),
        vehicles=draw(fleets(intervals * minutes / 60, max_vehicles)),
        interval_minutes=minutes,
        intervals=intervals,
    )


def names(elements: Iterable[Element | None]) -> tuple[str, ...]:
    """Elements as files name them."""
    return tuple(str(element) for element in elements)
