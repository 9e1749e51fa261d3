"""What a scenario's events make of its day, interval by interval: the audit's own reading."""

from evdash.domain.events import Event
from evdash.domain.scenario import ProfileRow, Scenario

HEADER = 1
"""Rows of a table before its first, as where a line is called `line:row 2`."""
CUTS = ("no_show", "leaves_early", "late")


def known_by(scenario: Scenario, interval: int) -> list[Event]:
    """Events known at the start of an interval, in the order they became known."""
    known = [event for event in scenario.events if event.interval <= interval]
    return sorted(known, key=lambda event: event.interval)


def as_it_turned_out(scenario: Scenario) -> Scenario:
    """The scenario with the loads and prices each interval really had."""
    rows = tuple(_turned_out(row, known_by(scenario, row.interval)) for row in scenario.profile)
    return scenario.replacing(profile=rows)


def as_known_at(scenario: Scenario, interval: int) -> Scenario:
    """The scenario as it was expected at the start of an interval, in which chargers, ratings,
    loads and prices are those of the events known by then."""
    known = known_by(scenario, interval)
    rows = tuple(
        _turned_out(row, [event for event in known if event.interval <= row.interval])
        for row in scenario.profile
    )
    station = scenario.station.model_copy(update={"chargers": chargers_at(scenario, interval)})
    return _rated(scenario, interval).replacing(profile=rows, station=station)


def _turned_out(row: ProfileRow, known: list[Event]) -> ProfileRow:
    price, load = row.price_per_kwh, row.load_pu
    for event in known:
        too_early = event.from_interval is not None and row.interval < event.from_interval
        too_late = event.until_interval is not None and row.interval >= event.until_interval
        if too_early or too_late or event.value is None:
            continue
        if event.event == "price":
            price = event.value
        elif event.event == "price_factor":
            price = price * event.value
        elif event.event == "load_factor":
            load = load * event.value
    return row.model_copy(update={"price_per_kwh": price, "load_pu": load})


def chargers_at(scenario: Scenario, interval: int) -> int:
    """Chargers that work in an interval."""
    working = float(scenario.station.chargers)
    for event in known_by(scenario, interval):
        value = event.value or 0.0
        if event.event == "chargers":
            working = value
        elif event.event == "chargers_fail":
            working -= value
        elif event.event == "chargers_return":
            working += value
    return int(working)


def rated_spans(scenario: Scenario) -> list[tuple[Scenario, range]]:
    """The scenario with the ratings of each span of intervals between two changes of them."""
    ends = {e.interval for e in scenario.events if e.event == "rating"} | {scenario.intervals}
    spans, begin = [], 0
    for end in sorted(ends):
        if end > begin:
            spans.append((_rated(scenario, begin), range(begin, end)))
        begin = end
    return spans


def _rated(scenario: Scenario, interval: int) -> Scenario:
    known = known_by(scenario, interval)
    ratings = {event.subject: event.value for event in known if event.event == "rating"}
    if not ratings:
        return scenario
    lines = list(scenario.lines)
    for row, line in enumerate(lines):
        for name in (f"line:{line.name}", f"line:row {row + HEADER + 1}"):
            if name in ratings:
                lines[row] = line.model_copy(update={"rating_kva": ratings[name]})
    nodes = [
        node.model_copy(update={"rating_kva": ratings[f"node:{node.node}"]})
        if f"node:{node.node}" in ratings
        else node
        for node in scenario.nodes
    ]
    return scenario.replacing(lines=tuple(lines), nodes=tuple(nodes))


def events_of(scenario: Scenario, vehicle: str, decided: int) -> list[Event]:
    """What the driver of a vehicle changed, in order, once a contract made in interval `decided`
    was there to be changed; what is known earlier changes nothing."""
    known = known_by(scenario, scenario.intervals)
    return [e for e in known if e.vehicle == vehicle and e.interval > decided]


def is_there(own: list[Event], interval: int) -> bool:
    """Whether a vehicle's own changes leave it at its charger in an interval."""
    for event in own:
        if interval < event.interval:
            continue
        if event.event == "no_show":
            return False
        if event.event == "leaves_early" and interval >= (event.until_interval or 0):
            return False
        if event.event == "late" and interval < (event.from_interval or 0):
            return False
    return True
