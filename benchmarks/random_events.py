"""What might happen on a day nobody tuned to: random events of every kind."""

from typing import Any

import numpy as np

from evdash.domain.events import Event
from evdash.domain.trace import Trace

SHARE = 0.2
"""In how many intervals something happens."""
STATION = ("chargers_fail", "chargers_return", "chargers", "rating", "load_factor")
PRICES = ("price_factor", "price")
DRIVERS = ("leaves_early", "late", "no_show", "asks_more")


def random_events(rng: np.random.Generator, trace: Trace) -> tuple[Event, ...]:
    """What happens as the interval `trace.now` begins: usually nothing, at most three things."""
    if rng.random() > SHARE:
        return ()
    events: list[Event] = []
    working = trace.scenario.station.chargers
    for _ in range(int(rng.integers(1, 4))):
        kind = str(rng.choice([*STATION, *STATION, *PRICES, *DRIVERS, *DRIVERS]))
        cells = _cells(rng, trace, kind, working)
        if cells is None:
            continue
        event = Event.model_validate({"interval": trace.now, "event": kind} | cells)
        working = _working(event, working)
        events.append(event)
    return tuple(events)


def _working(event: Event, before: int) -> int:
    change = {"chargers_fail": -1, "chargers_return": 1}.get(event.event, 0)
    return int(event.amount) if event.event == "chargers" else before + change * int(event.amount)


def _cells(
    rng: np.random.Generator, trace: Trace, kind: str, working: int
) -> dict[str, Any] | None:
    """The other cells of the row; None where it cannot happen."""
    now, until = trace.now, trace.scenario.intervals
    if kind in DRIVERS:
        return _of_a_driver(rng, trace, kind)
    if kind == "chargers_fail":
        return {"value": int(rng.integers(1, working + 1))} if working else None
    if kind in ("chargers_return", "chargers"):
        return {"value": int(rng.integers(1, 6))}
    if kind == "rating":
        return _rating(rng, trace)
    begin = int(rng.integers(now, until))
    span = {"from_interval": begin, "until_interval": int(rng.integers(begin + 1, until + 1))}
    low, high = {"load_factor": (0.5, 2.0), "price_factor": (0.2, 3.0)}.get(kind, (-0.1, 0.5))
    return span | {"value": round(float(rng.uniform(low, high)), 3)}


def _rating(rng: np.random.Generator, trace: Trace) -> dict[str, Any]:
    """A rating of some line that leaves the station now ample room, now hardly any."""
    scenario = trace.scenario
    line = scenario.lines[int(rng.integers(0, len(scenario.lines)))]
    load = sum(node.load_kw or 0.0 for node in scenario.nodes) * scenario.feeder.load_scale
    station = scenario.station.chargers * scenario.station.max_kw
    value = load * float(rng.uniform(0.5, 1.3)) + station * float(rng.uniform(0.0, 0.5))
    return {"subject": f"line:{line.name}", "value": round(value, 2)}


def _of_a_driver(rng: np.random.Generator, trace: Trace, kind: str) -> dict[str, Any] | None:
    contracts = (*trace.state.contracts, *trace.state.waiting)
    if not contracts:
        return None
    request = contracts[int(rng.integers(0, len(contracts)))].request
    now, end = trace.now, request.deadline_interval
    cells: dict[str, Any] = {"subject": request.vehicle}
    if kind == "leaves_early":
        cells["until_interval"] = int(rng.integers(now, end + 1))
    if kind == "late":
        cells["from_interval"] = min(int(rng.integers(now, end + 1)), trace.scenario.intervals - 1)
    if kind == "asks_more":
        cells["value"] = round(float(rng.uniform(0.2, 1.0) * request.need_kwh) + 0.01, 3)
    return cells
