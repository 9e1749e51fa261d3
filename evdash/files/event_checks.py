"""What a row of `events.csv` must agree on: with its own kind and with the rest."""

import re
from collections.abc import Iterator

from evdash.domain.arrivals import RecordedArrivals
from evdash.domain.events import EVENT_FORMS, Event, EventForm
from evdash.domain.scenario import Scenario
from evdash.domain.vehicles import DRAWN, GUEST
from evdash.files.checks import EVERY, Check, Place, Problem

MOST_CHARGERS = 100_000
MAY_COME = re.compile(rf"{DRAWN}\d{{3,}}|{GUEST}\d+")
DRAWN_NAME = f"{DRAWN}001, {DRAWN}002 and so on, as drawn vehicles are named"


def event_cells(scenario: Scenario) -> Iterator[Problem]:
    """Each row has the cells its kind asks for, and no others."""
    for i, event in enumerate(scenario.events):
        form = EVENT_FORMS[event.event]
        for column, needed, may_have in _cells(form):
            given = getattr(event, column) is not None
            place: tuple[Place, ...] = (("events", i, column), ("events", i, "event"))
            if needed and not given:
                meaning = _meaning(column, form)
                yield Problem(place, "a blank", f"{event.event} needs {meaning}")
            elif given and not may_have:
                shown = f"{getattr(event, column)}"
                yield Problem(place, shown, f"should be blank for {event.event}")


def _cells(form: EventForm) -> Iterator[tuple[str, bool, bool]]:
    """(column, whether it must be given, whether it may be)."""
    yield "subject", bool(form.subject), bool(form.subject)
    yield "value", bool(form.value), bool(form.value)
    for column in ("from_interval", "until_interval"):
        may_have = column in form.span
        yield column, may_have and form.span_required, may_have


def _meaning(column: str, form: EventForm) -> str:
    if column == "subject":
        return "the name of a vehicle" if form.subject == "vehicle" else "line:… or node:…"
    return f"a number ({form.value})" if column == "value" else "an interval"


def event_values(scenario: Scenario) -> Iterator[Problem]:
    """The value lies within what its kind allows."""
    for i, event in enumerate(scenario.events):
        form, value = EVENT_FORMS[event.event], event.value
        if not form.value or value is None:
            continue
        place: tuple[Place, ...] = (("events", i, "value"), ("events", i, "event"))
        if form.whole and value != int(value):
            yield Problem(place, f"{value:g}", f"should be a whole number ({form.value})")
        elif not form.least <= value <= form.most:
            rule = f"should be from {form.least:g} to {form.most:g} ({form.value})"
            yield Problem(place, f"{value:g}", rule)


def event_times(scenario: Scenario) -> Iterator[Problem]:
    """Nothing is known too late, and nothing bears on what is already past."""
    for i, event in enumerate(scenario.events):
        row: Place = ("events", i)
        at: Place = (*row, "interval")
        if event.interval >= scenario.intervals:
            rule = f"should be below the number of intervals, {scenario.intervals}"
            yield Problem((at, ("intervals",)), f"{event.interval}", rule)
            continue
        first = event.interval
        if event.from_interval is not None:
            place: Place = (*row, "from_interval")
            if not first <= event.from_interval < scenario.intervals:
                rule = f"should be from {first}, when it is known, to {scenario.intervals - 1}"
                yield Problem((place, at, ("intervals",)), f"{event.from_interval}", rule)
                continue
            first = event.from_interval
        if event.until_interval is not None:
            # who leaves may leave at once; a span holds at least one interval
            least = first if event.event == "leaves_early" else first + 1
            if not least <= event.until_interval <= scenario.intervals:
                place = (*row, "until_interval")
                drawn_on: tuple[Place, ...] = (at, (*row, "from_interval"), ("intervals",))
                rule = f"should be from {least} to {scenario.intervals}"
                yield Problem((place, *drawn_on), f"{event.until_interval}", rule)


def event_subjects(scenario: Scenario) -> Iterator[Problem]:
    """The element or vehicle is one of the scenario's."""
    elements = scenario.rated_elements
    named: tuple[Place, ...] = (
        ("lines", EVERY, "from_node"),
        ("lines", EVERY, "to_node"),
        ("nodes", EVERY, "node"),
    )
    known = scenario.arrivals
    # not everyone that may be drawn comes on every day; such a row then changes nothing
    vehicles, drawn, rule = frozenset[str](), True, f"should be {DRAWN_NAME}"
    if isinstance(known, RecordedArrivals):
        vehicles = frozenset(arrival.vehicle for arrival in known.vehicles)
        drawn, rule = known.forecast is not None, "should be a vehicle of arrivals.csv"
    for i, event in enumerate(scenario.events):
        kind = EVENT_FORMS[event.event].subject
        place: tuple[Place, ...] = (("events", i, "subject"), ("events", i, "event"))
        if event.subject is None:
            continue
        if kind == "element" and event.subject not in elements:
            yield Problem((*place, *named), repr(event.subject), _naming(scenario, event.subject))
        may_come = drawn and MAY_COME.fullmatch(event.subject) is not None
        if kind == "vehicle" and event.subject not in vehicles and not may_come:
            yield Problem((*place, ("arrivals", "vehicles")), repr(event.subject), rule)


def _naming(scenario: Scenario, subject: str) -> str:
    """How an element should be named in place of `subject`, which names none or several."""
    meant = [line.element for line in scenario.lines if str(line.element) == subject]
    if meant:
        names = " or ".join(
            f"{scenario.file_name(element)} (from {element.node} to {element.to_node})"
            for element in meant
        )
        return f"names {len(meant)} lines; should be {names}"
    return "should be line:FROM-TO or node:NAME as in lines.csv and nodes.csv"


def event_chargers(scenario: Scenario) -> Iterator[Problem]:
    """No more chargers fail than work."""
    working = float(scenario.station.chargers)
    for i, event in sorted(enumerate(scenario.events), key=lambda one: one[1].interval):
        working = chargers_after(event, working)
        if not 0 <= working <= MOST_CHARGERS:
            yield Problem(
                (("events", i, "value"), ("events", i, "event"), ("station", "chargers")),
                f"{event.amount:g}",
                f"would leave {working:g} chargers; should leave 0 to {MOST_CHARGERS:,}",
            )
            return


def chargers_after(event: Event, working: float) -> float:
    """Chargers that work after an event, where so many worked before it."""
    change = {"chargers_fail": -event.amount, "chargers_return": event.amount}
    return event.amount if event.event == "chargers" else working + change.get(event.event, 0.0)


EVENT_CHECKS: tuple[Check, ...] = (
    event_cells,
    event_values,
    event_times,
    event_subjects,
    event_chargers,
)
