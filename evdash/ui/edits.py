"""Edits of a day under way as what they are: events, as far as events can say them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from evdash.domain.events import Event
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.horizon.in_force import in_force

CHARGERS = "station.chargers"
SETTINGS = ("chargers", "price")
"""Kinds of event that stand for a setting: they also hold for the next run of the day."""


@dataclass(frozen=True, slots=True)
class Edit:
    """What is edited from now on: events, and settings that no event can say."""

    events: tuple[Event, ...]
    settings: Mapping[str, object]


def edit_of(trace: Trace, settings: Mapping[str, object], prices: Sequence[float] | None) -> Edit:
    """An edit of settings and, if given, of all energy prices ($/kWh), in mid-day."""
    events: list[Event] = []
    if CHARGERS in settings:
        count = settings[CHARGERS]
        events.append(Event.model_validate(_row(trace, "chargers") | {"value": count}))
    if prices is not None:
        events += _price_events(trace, prices)
    rest = {key: value for key, value in settings.items() if key != CHARGERS}
    return Edit(tuple(events), rest)


def _row(trace: Trace, kind: str) -> dict[str, object]:
    return {"interval": trace.now, "event": kind}


def _price_events(trace: Trace, prices: Sequence[float]) -> Iterator[Event]:
    """One event for every span of equal new prices, from now on."""
    old = trace.scenario.price_per_kwh.tolist()
    changed = [(t, prices[t]) for t in range(trace.now, len(old)) if prices[t] != old[t]]
    # of consecutive intervals of one price, interval less position in the list is the same
    spans = groupby(enumerate(changed), key=lambda one: (one[1][0] - one[0], one[1][1]))
    for (_, price), span in spans:
        intervals = [t for _, (t, _) in span]
        yield Event.model_validate(
            _row(trace, "price")
            | {
                "value": price,
                "from_interval": intervals[0],
                "until_interval": intervals[-1] + 1,
            }
        )


def with_settings_kept(trace: Trace, opened: Scenario) -> Scenario:
    """The scenario for another run of the day: settings as they are now, what happened forgotten.

    Events the scenario itself came with (`opened`) stay, and happen again.
    """
    given = trace.inputs.given
    edits = tuple(e for e in given.events if e.event in SETTINGS and e not in opened.events)
    settled = in_force(given.replacing(events=edits), given.intervals)
    return settled.replacing(events=tuple(e for e in given.events if e in opened.events))
