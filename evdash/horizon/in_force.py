"""The scenario in force: as given, with what has happened so far carried into it."""

from collections.abc import Callable, Mapping

from evdash.domain.events import Event, EventKind
from evdash.domain.scenario import ProfileRow, Scenario


def in_force(given: Scenario, now: int) -> Scenario:
    """`given` as known at the start of interval `now`: every event up to then, none later.

    Events of vehicles change contracts and not the scenario. Rows of the profile before an
    event's own interval stay, so that the last scenario in force holds the loads and prices
    of the whole day as they turned out.
    """
    scenario = given
    for event in sorted(given.events, key=lambda event: event.interval):
        if event.interval <= now and event.event in EFFECTS:
            scenario = EFFECTS[event.event](scenario, event)
    return scenario


def _chargers(scenario: Scenario, count: float) -> Scenario:
    station = scenario.station.model_copy(update={"chargers": int(count)})
    return scenario.replacing(station=station)


def _fail(scenario: Scenario, event: Event) -> Scenario:
    return _chargers(scenario, max(0.0, scenario.station.chargers - event.amount))


def _return(scenario: Scenario, event: Event) -> Scenario:
    return _chargers(scenario, scenario.station.chargers + event.amount)


def _rating(scenario: Scenario, event: Event) -> Scenario:
    element = scenario.rated_elements[event.subject or ""]
    return scenario.with_rating(element, lambda _: event.value)


def _profile(
    column: str, value: Callable[[float, float], float]
) -> Callable[[Scenario, Event], Scenario]:
    """An event that changes a column of the profile: `value` of what stands there and its own."""

    def changed(scenario: Scenario, event: Event) -> Scenario:
        first = event.interval if event.from_interval is None else event.from_interval
        until = scenario.intervals if event.until_interval is None else event.until_interval

        def row_of(row: ProfileRow) -> ProfileRow:
            if not max(first, event.interval) <= row.interval < until:
                return row
            return row.model_copy(update={column: value(getattr(row, column), event.amount)})

        return scenario.replacing(profile=tuple(row_of(row) for row in scenario.profile))

    return changed


EFFECTS: Mapping[EventKind, Callable[[Scenario, Event], Scenario]] = {
    "chargers_fail": _fail,
    "chargers_return": _return,
    "chargers": lambda scenario, event: _chargers(scenario, event.amount),
    "rating": _rating,
    "load_factor": _profile("load_pu", lambda old, factor: old * factor),
    "price_factor": _profile("price_per_kwh", lambda old, factor: old * factor),
    "price": _profile("price_per_kwh", lambda _, price: price),
}
