"""What is said of events: choices become events, effects and the ledger become sentences."""

import pytest

from evdash.errors import InputError
from evdash.horizon.day import run_day
from evdash.horizon.relief import Relief
from evdash.metrics.ledger import ledger
from evdash.metrics.outlook import outlook
from evdash.scheduling.p1 import p1_policy
from evdash.ui.events.choices import CHOICES, checked, contracts, elements, event_of
from evdash.ui.events.words import (
    contract_told,
    effect_told,
    events_told,
    ledger_rows,
    remedies_told,
    short_rows,
    story_told,
    summary_told,
)
from tests.builders import line
from tests.horizon.test_events import begun, event, told

SAID = {
    "count": 1,
    "element": "line:s-a",
    "kva": 50.0,
    "percent": -20,
    "from": 1,
    "until": 2,
    "vehicle": "a",
    "kwh": 2.0,
    "back": 2,
}


@pytest.mark.parametrize("kind", CHOICES)
def test_every_choice_makes_an_event_that_can_happen(kind):
    trace = begun()
    made = checked(trace, event_of(trace, kind, SAID))
    assert (made.interval, made.event) == (1, kind)
    after, happening = told(trace, made)
    assert effect_told(happening)
    assert after.inputs.given.events == (made,)


def test_a_fifth_less_is_a_factor_of_four_fifths():
    assert event_of(begun(), "load_factor", SAID).value == pytest.approx(0.8)


def test_times_an_event_bears_on_are_told():
    ahead = outlook(begun())
    told_of = {kind: events_told((event_of(begun(), kind, SAID),), ahead) for kind in CHOICES}
    assert told_of["late"] == r"a is late\, back at 02\:00"
    assert told_of["leaves_early"] == r"a leaves early at 02\:00"
    assert told_of["load_factor"].endswith(r"what was expected from 01\:00 until 02\:00")
    assert told_of["chargers_fail"] == "1 of the chargers stops working"
    assert told_of["rating"] == r"the rating of line s\-a is 50 kVA from now on"


def test_what_cannot_happen_is_told():
    trace = begun()
    with pytest.raises(InputError, match="would leave -6 chargers"):
        checked(trace, event_of(trace, "chargers_fail", SAID | {"count": 9}))


def test_what_can_be_chosen_is_what_there_is():
    trace = begun(lines=[line("s", "a", rating=90.0)])
    assert list(contracts(trace)) == ["a", "b"]
    assert contract_told(contracts(trace)["a"], outlook(trace)) == "a, 8.0 kWh owed by 03:00"
    assert elements(trace.scenario) == {"line:s-a": ("line or transformer s–a, now 90 kVA", 90.0)}


def test_a_shortfall_is_told_with_whom_and_how_much():
    after, happening = told(begun([2, 5, 5]), event("chargers", value=0))
    ahead = outlook(after)
    assert "20.0 kWh promised to 2 vehicles cannot be delivered in time" in effect_told(happening)
    rows = short_rows(happening, ahead)
    assert [(r["Vehicle"], r["Missing, kWh"], r["Back by"]) for r in rows] == [
        ("a", 10.0, "03:00"),
        ("b", 10.0, "03:00"),
    ]


def test_remedies_are_told_one_by_one_or_none():
    text = remedies_told(Relief(2, 13.5, 3), 0.5)
    assert "2 more chargers" in text
    assert "13.5 kW more" in text
    assert "waiting 1.5 h longer" in text
    assert "No one thing alone" in remedies_told(Relief(None, None, None), 1.0)


def test_remedies_that_were_not_proven_are_told_so():
    text = remedies_told(Relief(2, 13.5, None, sure=False), 0.5)
    assert "the search was cut short" in text
    assert "the search was cut short" in remedies_told(Relief(2, None, None, sure=False), 0.5)
    none = remedies_told(Relief(None, None, None, sure=False), 1.0)
    assert "No one thing alone" not in none
    assert "was found in time" in none


def test_the_ledger_tells_the_story():
    after, _ = told(begun([2, 5, 5]), event("chargers", value=0))
    done = run_day(after, p1_policy())
    entries, ahead = ledger(done), outlook(done)
    story = story_told(entries[0], ahead)
    assert "was promised 12.0 kWh by 03:00" in story
    assert "at 01:00, 0 chargers work from now on, and 10.0 kWh can no longer be" in story
    assert "It got 2.0 kWh; 10.0 kWh are missing." in story
    under_way = story_told(ledger(after)[0], outlook(after))
    assert "It has 2.0 kWh so far; 10.0 kWh are missing." in under_way
    row = ledger_rows(entries, ahead)[0]
    assert (row["What became of it"], row["Known since"]) == ("! short", "01:00")
    assert summary_told(entries) == "2 short"


def test_a_driver_who_gives_something_up_is_told_apart():
    after, happening = told(begun(), event("no_show", subject="a"))
    assert "a gives up 8.0 kWh, which is no broken promise" in effect_told(happening)
    done = run_day(after, p1_policy())
    assert "kept but for that" in story_told(ledger(done)[0], outlook(done))
    assert summary_told(ledger(done)) == "3 kept, 1 cut by drivers"
