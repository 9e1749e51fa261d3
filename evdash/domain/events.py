"""What happens in a day under way: the rows of `events.csv`, and what each kind must say.

An event is known from the start of its interval on and never before.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import BeforeValidator

from evdash.domain.fields import (
    LARGE,
    Name,
    OptionalCount,
    OptionalNumber,
    Record,
    declare,
    declare_optional,
)

EventKind = Literal[
    "chargers_fail",
    "chargers_return",
    "chargers",
    "rating",
    "load_factor",
    "price_factor",
    "price",
    "leaves_early",
    "late",
    "no_show",
    "asks_more",
]
Edge = Literal["from_interval", "until_interval"]
OptionalName = Annotated[
    Name | None,
    BeforeValidator(lambda value: value if value is None or str(value).strip() else None),
]


class Event(Record):
    """A row of `events.csv`: something that happens, known from the start of its interval on."""

    interval: int = declare("Interval at whose start it becomes known", "", 0, ge=0)
    event: EventKind = declare("What happens, as listed below", "", "chargers")
    subject: OptionalName = declare_optional("Element or vehicle it happens to", "")
    value: OptionalNumber = declare_optional(
        "How many, how much: see below", "", ge=-1000, le=LARGE
    )
    from_interval: OptionalCount = declare_optional("First interval it bears on", "", ge=0)
    until_interval: OptionalCount = declare_optional(
        "First interval it no longer bears on", "", ge=0
    )

    @property
    def amount(self) -> float:
        """The value of a kind that has one."""
        return 0.0 if self.value is None else self.value

    @property
    def vehicle(self) -> str:
        """The vehicle it happens to; empty for events of the station, the feeder and forecasts."""
        return self.subject or "" if EVENT_FORMS[self.event].subject == "vehicle" else ""

    @property
    def text(self) -> str:
        """What happens, in plain words without the time."""
        form, subject = EVENT_FORMS[self.event], self.subject or ""
        if form.subject == "element":
            subject = subject.replace(":", " ", 1)  # `line:632-633` is line 632-633
        words = form.words if self.amount != 1 else form.words_of_one or form.words
        return words.format(subject=subject, value=f"{self.amount:g}")

    def told(self, clock: Callable[[int], str]) -> str:
        """What happens and the times it bears on, as `clock` tells the start of an interval."""
        begin, end = self.from_interval, self.until_interval
        if self.vehicle:
            at = "" if end is None else f" at {clock(end)}"
            return self.text + at + ("" if begin is None else f", back at {clock(begin)}")
        since = "" if begin is None else f" from {clock(begin)}"
        return self.text + since + ("" if end is None else f" until {clock(end)}")


@dataclass(frozen=True, slots=True)
class EventForm:
    """What a kind of event means and which cells its row must have; empty text means none.

    `least` and `most` bound the value. `words` tells one of them in a sentence; `words_of_one`
    does where its value is 1 and grammar wants it.
    """

    meaning: str
    words: str
    subject: Literal["", "element", "vehicle"] = ""
    value: str = ""
    least: float = 0.0
    most: float = LARGE
    whole: bool = False
    span: tuple[Edge, ...] = ()
    span_required: bool = False
    words_of_one: str = ""


SPAN: tuple[Edge, ...] = ("from_interval", "until_interval")
FACTOR = "factor on what was expected"
EVENT_FORMS: Mapping[EventKind, EventForm] = {
    "chargers_fail": EventForm(
        "So many chargers stop working, until others return",
        "{value} of the chargers stop working",
        value="chargers",
        least=1,
        most=100_000,
        whole=True,
        words_of_one="1 of the chargers stops working",
    ),
    "chargers_return": EventForm(
        "So many chargers work again",
        "{value} more of the chargers work",
        value="chargers",
        least=1,
        most=100_000,
        whole=True,
        words_of_one="1 more of the chargers works",
    ),
    "chargers": EventForm(
        "From now on so many chargers work",
        "{value} chargers work from now on",
        value="chargers",
        most=100_000,
        whole=True,
        words_of_one="1 charger works from now on",
    ),
    "rating": EventForm(
        "The rating of a line or transformer (`line:632-633`) or of a node's net injection "
        "(`node:634`) is another from now on",
        "the rating of {subject} is {value} kVA from now on",
        subject="element",
        value="kVA",
    ),
    "load_factor": EventForm(
        "All loads are expected, and turn out, larger or smaller by a factor",
        "loads are {value} times what was expected",
        value=FACTOR,
        most=100,
        span=SPAN,
    ),
    "price_factor": EventForm(
        "Energy prices are larger or smaller by a factor",
        "energy costs {value} times what was expected",
        value=FACTOR,
        most=100,
        span=SPAN,
    ),
    "price": EventForm(
        "The energy price is another",
        "energy costs {value} $/kWh",
        value="$/kWh",
        least=-1000,
        most=1000,
        span=SPAN,
    ),
    "leaves_early": EventForm(
        "A vehicle under contract will be gone from `until_interval` on",
        "{subject} leaves early",
        subject="vehicle",
        span=("until_interval",),
        span_required=True,
    ),
    "late": EventForm(
        "A vehicle under contract is away and back at the charger only at `from_interval`; its "
        "time of return stays",
        "{subject} is late",
        subject="vehicle",
        span=("from_interval",),
        span_required=True,
    ),
    "no_show": EventForm(
        "A vehicle under contract is gone and does not come back",
        "{subject} does not come",
        subject="vehicle",
    ),
    "asks_more": EventForm(
        "A vehicle under contract asks for more energy, drawn from the grid, by the same time",
        "{subject} asks for {value} kWh more",
        subject="vehicle",
        value="kWh",
        least=0.001,
    ),
}
