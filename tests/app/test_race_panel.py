"""The race on the Compare page, without a browser: started, watched, told; and stopped."""

import time
from dataclasses import replace

from streamlit.testing.v1 import AppTest

from evdash.horizon.inputs import prepare
from evdash.policies.race import race
from evdash.ui.race.racing import KEY, Finished, Racing
from tests.app.test_compare_page import opened, press, session, texts
from tests.builders import generator, make_scenario

PATIENCE_SECONDS = 240


def racing(at: AppTest) -> Racing:
    found: Racing = at.session_state[KEY]
    return found


def choose(at: AppTest, *names: str) -> AppTest:
    at.pills(key="race_policies").set_value(list(names)).run()
    assert not at.exception
    return at


def until_done(at: AppTest) -> AppTest:
    until = time.monotonic() + PATIENCE_SECONDS
    while racing(at).is_running and time.monotonic() < until:
        time.sleep(0.3)
        at.run()
        assert not at.exception
    return at.run()


def test_a_race_runs_beside_the_page_and_is_told() -> None:
    at = choose(opened(), "p1", "llf", "uncoordinated")
    before = session(at).run
    press(at, "race_start")
    assert racing(at).is_running
    until_done(at)
    assert racing(at).said == ""
    found = racing(at).finished
    assert found is not None
    assert [lap.policy for lap in found.race.laps] == ["p1", "llf", "uncoordinated"]
    assert session(at).run is before  # the present run stays as it was
    told = texts(at).replace("\\", "")
    assert "Least laxity first" in told
    assert "Profit, $" in told
    assert "By AC power flow, charging exceeds limits under every policy: p1 (" in told
    session(at).edit("fewer chargers", {"station.chargers": 6})
    at.run()
    assert "other inputs by now" in texts(at)


def test_what_was_kept_and_who_could_not_take_part_is_told() -> None:
    at = opened()
    scenario = make_scenario(arrivals=generator(vehicles_per_day=200.0), station={"chargers": 1})
    inputs = prepare(scenario)
    found = race(inputs, ("p1", "bid-price"))
    racing(at).finished = Finished(replace(found, absent={"oracle": "no reason"}), inputs)
    at.run()
    assert not at.exception
    told = texts(at).replace("\\", "")
    assert "refusals kept room for others" in told
    assert "Oracle could not take part: no reason" in told
    assert "other inputs by now" in told


def test_a_race_can_be_stopped() -> None:
    at = choose(opened(), "oracle", "bid-price")
    press(at, "race_start")
    place = racing(at)._place
    assert place is not None
    until = time.monotonic() + PATIENCE_SECONDS
    while place.process is None and time.monotonic() < until:
        time.sleep(0.01)
    press(at, "race_stop")
    assert place.process is not None
    assert place.process.poll() is not None
    assert not racing(at).is_running
    assert racing(at).finished is None
    assert at.button(key="race_start")


def test_a_turn_that_cannot_be_waited_for_is_told(tmp_path, monkeypatch) -> None:
    """A folder in its place cannot be opened as that file, nor another user's be by anybody."""
    queue = tmp_path / "taken"
    queue.mkdir()
    monkeypatch.setattr("evdash.ui.race.racing.QUEUE", queue)
    at = choose(opened(), "p1", "llf")
    press(at, "race_start")
    until_done(at)
    said = " ".join(error.value for error in at.error).replace("\\", "")
    assert "another user of this computer" in said
    assert f"{queue}" in said
    assert at.button(key="race_start")
