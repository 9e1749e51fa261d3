"""What a person can let happen now, and the event that makes. No Streamlit in here."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from evdash.domain.events import Event, EventKind
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.domain.vehicles import Contract
from evdash.files.overrides import edit_scenario

Field = Literal["count", "element", "kva", "percent", "span", "vehicle", "kwh", "until", "back"]


@dataclass(frozen=True, slots=True)
class Choice:
    """A kind of event as a person calls it, what else must be said, and what it means."""

    kind: EventKind
    label: str
    fields: tuple[Field, ...]
    help: str


CHOICES: Mapping[str, Choice] = {
    one.kind: one
    for one in (
        Choice(
            "chargers_fail",
            "Chargers fail",
            ("count",),
            "They stop working at once, until somebody lets them work again.",
        ),
        Choice("chargers_return", "Chargers work again", ("count",), "From now on."),
        Choice(
            "rating",
            "A line or transformer may carry less, or more",
            ("element", "kva"),
            "Its rating is another from now on: a hot transformer, a line out for work.",
        ),
        Choice(
            "load_factor",
            "Other loads on the feeder turn out different",
            ("percent", "span"),
            "The forecast of all loads is revised; the station gets what room is left.",
        ),
        Choice(
            "price_factor",
            "Energy turns out dearer or cheaper",
            ("percent", "span"),
            "The forecast of energy prices is revised. No promise depends on it.",
        ),
        Choice(
            "leaves_early",
            "A vehicle leaves early",
            ("vehicle", "until"),
            "It gets what can be had by then, and nobody else gets less for it.",
        ),
        Choice(
            "asks_more",
            "A vehicle asks for more energy",
            ("vehicle", "kwh"),
            "It gets as much more, by the same time, as every promise leaves room for.",
        ),
        Choice(
            "late",
            "A vehicle is late",
            ("vehicle", "back"),
            "It is away and cannot charge until then; its time of return stays.",
        ),
        Choice(
            "no_show",
            "A vehicle does not come",
            ("vehicle",),
            "It is gone for good, and its charger is free for others.",
        ),
    )
}


def event_of(trace: Trace, kind: str, said: Mapping[str, object]) -> Event:
    """The event a person described, happening now. `percent` is a change, −20 for a fifth less."""
    choice = CHOICES[kind]
    cells: dict[str, object] = {"interval": trace.now, "event": choice.kind}
    for field in choice.fields:
        if field in ("count", "kva", "kwh"):
            cells["value"] = said[field]
        elif field == "percent":
            cells["value"] = 1 + float(str(said[field])) / 100
        elif field in ("element", "vehicle"):
            cells["subject"] = said[field]
        elif field == "span":
            cells["from_interval"], cells["until_interval"] = said["from"], said["until"]
        else:
            cells["until_interval" if field == "until" else "from_interval"] = said[field]
    return Event.model_validate(cells)


def checked(trace: Trace, event: Event) -> Event:
    """The event, if it can happen; raises InputError with every fault."""
    given = trace.inputs.given
    edit_scenario(given.replacing(events=(*given.events, event)), {})
    return event


def contracts(trace: Trace) -> dict[str, Contract]:
    """The contracts that are still open, by vehicle."""
    return {c.vehicle: c for c in (*trace.state.contracts, *trace.state.waiting)}


def elements(scenario: Scenario) -> dict[str, tuple[str, float]]:
    """Every rated line and node: its name in words and its rating, kVA."""
    found = {}
    for subject, element in scenario.rated_elements.items():
        rating_kva = scenario.rating_kva_of(element)
        if rating_kva is not None:
            of_line = element.kind == "line"
            ends = f"line or transformer {element.node}–{element.to_node}"
            called = ends if of_line else f"node {element.node}"
            found[subject] = f"{called}, now {rating_kva:g} kVA", rating_kva
    return found
