"""Sentences of a verdict: what they say of causes, of neighbours, and of what is not known."""

import numpy as np

from evdash.domain.breach import Breach
from evdash.domain.elements import Element
from evdash.domain.events import Event
from evdash.domain.trace import Trace
from evdash.horizon.day import run_day, start_day
from evdash.metrics.ac import AcPoint
from evdash.metrics.verdict import FULL_AC, LINEARISED, ModelVerdict, ac_verdict, verdict_of
from evdash.metrics.verdict_words import Wording, in_brief, sentences
from evdash.scheduling.p1 import p1_policy
from tests.builders import line, make_scenario, node, vehicle

ALL_HOLD = "Every limit holds in the linearised model and by AC power flow"


def at_clock(trace: Trace) -> Wording:
    return Wording.of(trace, lambda t: f"{trace.scenario.time_of(t):%H:%M}")


def breach(element: str, t: int, depth: float, base: float = 0.0, unit: str = "kVA") -> Breach:
    return Breach(t, Element.read(element), depth, base, unit, 1e-6)


def small() -> Trace:
    return start_day(
        make_scenario(
            nodes=[node("s"), node("a"), node("b")],
            lines=[line("s", "a", rating=50), line("a", "b")],
            vehicles=[vehicle("v")],
        )
    )


def texts(*models: ModelVerdict) -> list[str]:
    return [one.text for one in sentences(models, at_clock(small()))]


def test_neighbours_voltages_are_told_together_and_the_cause_of_each() -> None:
    found = verdict_of(
        FULL_AC,
        [
            breach("voltage_min:a", 1, 0.01, unit="pu"),
            breach("voltage_min:b", 2, 0.03, base=0.01, unit="pu"),
            breach("line:s-a", 2, 9.4),
            breach("line:s-a:export", 3, 2.0, base=2.0),
        ],
        4,
    )
    mine, own = texts(found)
    assert mine.startswith("By AC power flow, charging exceeds 3 limits: ")
    assert "line or transformer s–a (50 kVA) by 9.4 kVA at 02:00" in mine
    assert "at node b (0.9 pu), and at 1 other node, by up to 0.0300 pu in 2 intervals" in mine
    assert "in part without charging" in mine
    assert own.startswith("By AC power flow, the feeder by itself exceeds 1 limit")
    assert "against power flowing back" in own
    assert in_brief(found, at_clock(small())).count(" by ") == 2
    (worsened,) = texts(verdict_of(FULL_AC, [breach("line:s-a", 0, 5.0, base=1.0)], 4))
    assert "charging worsens 1 limit that the feeder exceeds by itself" in worsened


def test_nothing_is_said_to_hold_that_is_not_known() -> None:
    unknown = np.array([np.nan])
    fine = AcPoint(np.array([1.0]), np.array([1.0]), ())
    failed = AcPoint(unknown, unknown, (), "no room")
    lost = breach("power_flow:a", 1, 1.0, unit="solution missing")
    linear = verdict_of(LINEARISED, (), 4)
    only_linear = "Every limit holds in the linearised model."
    assert texts(linear, ac_verdict({}, 0)) == [
        "AC power flow checks each interval once it is over.",
        only_linear,
    ]
    waiting, holds = texts(linear, ac_verdict({0: fine}, 2))
    assert waiting == "1 interval is still being checked by AC power flow."
    assert holds == only_linear
    broken, holds = texts(linear, ac_verdict({0: fine, 1: failed}, 2))
    assert broken == "1 interval could not be checked: the AC power flow itself failed (no room)."
    assert holds == only_linear
    gone, holds = texts(linear, ac_verdict({1: AcPoint(unknown, unknown, (lost,))}, 1))
    assert gone == ("AC power flow has no solution with charging, voltage may collapse: at 01:00.")
    assert holds == only_linear
    assert texts(linear, ac_verdict({0: fine}, 1)) == [f"{ALL_HOLD}."]


def test_a_limit_is_named_as_it_was_in_force_then() -> None:
    """The rating falls at 02:00: what was exceeded before is told with the rating of before."""
    event = Event(interval=2, event="rating", subject="line:s-a", value=20.0)
    scenario = make_scenario(
        nodes=[node("s"), node("a")], lines=[line("s", "a", rating=50)], events=[event.model_dump()]
    )
    trace = run_day(start_day(scenario), p1_policy())
    for interval, rating in ((1, 50), (3, 20)):
        found = verdict_of(FULL_AC, [breach("line:s-a", interval, 1.0)], 4)
        (told,) = sentences([found], at_clock(trace))
        assert f"({rating} kVA)" in told.text
