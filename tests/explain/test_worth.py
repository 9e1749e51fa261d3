"""Worths of a day equal running it by hand; the table of binding elements equals the records."""

import pytest

from evdash.domain.elements import CHARGERS, Element
from evdash.domain.events import Event
from evdash.explain.binding import binding_elements, binding_told
from evdash.explain.words import Clock
from evdash.explain.worth import binding_rating, day_worths, higher_rating
from evdash.files.bundled import DEFAULT, PRESETS
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import run_day, start_day
from evdash.horizon.revise import revise
from evdash.metrics.records import interval_records
from evdash.metrics.service import totals
from evdash.scheduling.p1 import p1_policy
from tests.explain.cases import ran

TRANSFORMER = Element("line", "633", "634")


@pytest.fixture(scope="module")
def bundled():
    return ran(read_scenario(DEFAULT, ()))


def raised(scenario):
    lines = tuple(
        line.model_copy(update={"rating_kva": 510.0}) if line.name == "633-634" else line
        for line in scenario.lines
    )
    return scenario.replacing(lines=lines)


def test_worths_equal_running_the_day_by_hand(bundled):
    scenario, before = bundled.scenario, totals(bundled)
    by_hand = (
        edit_scenario(scenario, {"station.chargers": 13}),
        raised(scenario),
        edit_scenario(scenario, {"feeder.voltage_min_pu": 0.96, "feeder.voltage_max_pu": 1.04}),
    )
    worths = list(day_worths(bundled))
    for worth, changed in zip(worths, by_hand, strict=True):
        after = totals(ran(changed))
        assert worth.profit == pytest.approx(after.profit - before.profit, abs=1e-9)
        assert worth.admitted == after.admitted - before.admitted
        assert worth.text.startswith(worth.what)
    assert "one more charger" in worths[0].what.lower()
    assert "633–634" in worths[1].what
    assert worths[2].text.endswith("would have changed nothing.")


def test_a_wider_band_is_worth_most_where_voltage_binds():
    trace = ran(read_scenario(PRESETS / "voltage-limited", ()))
    rows = binding_elements(trace)
    assert rows[0].element.kind == "voltage_min"
    *_, band = day_worths(trace)
    assert band.profit > 10
    assert "earned $" in band.text


def test_a_day_under_way_is_run_whole_under_its_present_inputs(bundled):
    trace = start_day(bundled.scenario)
    while trace.now < 12:
        trace = run_day_to(trace, trace.now + 1)
    trace = revise(trace, edit_scenario(trace.scenario, {"station.chargers": 11}))
    first = next(day_worths(trace))
    twelve = totals(bundled)
    eleven = totals(ran(edit_scenario(bundled.scenario, {"station.chargers": 11})))
    assert first.profit == pytest.approx(twelve.profit - eleven.profit, abs=1e-9)


def run_day_to(trace, interval):
    from evdash.horizon.day import step

    while trace.now < interval:
        trace = step(trace, p1_policy())
    return trace


def test_the_table_of_binding_elements_equals_the_records(bundled):
    rows = {row.element: row for row in binding_elements(bundled)}
    records = interval_records(bundled)
    for element, row in rows.items():
        if element != CHARGERS:
            assert row.tightest == tuple(r.interval for r in records if r.binding == str(element))
    full = tuple(r.interval for r in records if r.charging == 12)
    assert rows[CHARGERS].reached == full
    reached = tuple(r.interval for r in records if r.station_kw >= r.headroom_kw - 0.05)
    assert rows[TRANSFORMER].reached == reached
    assert binding_rating(bundled) == TRANSFORMER


def test_without_limits_nothing_binds():
    scenario = read_scenario(DEFAULT, ())
    free = scenario.replacing(
        lines=tuple(line.model_copy(update={"rating_kva": None}) for line in scenario.lines)
    )
    trace = run_day(start_day(free), p1_policy())
    assert binding_rating(trace) is None
    assert [worth.what for worth in day_worths(trace)] == [
        "One more charger",
        "A voltage band wider by 0.01 pu on either side",
    ]


def test_what_happens_on_the_way_happens_again(bundled):
    """Ten chargers from noon on: with one more of them there are thirteen before, eleven after."""
    given = bundled.scenario
    failing = given.replacing(events=(Event(interval=12, event="chargers", value=10),))
    trace = ran(failing)
    more = edit_scenario(given, {"station.chargers": given.station.chargers + 1})
    by_hand = ran(more.replacing(events=(Event(interval=12, event="chargers", value=11),)))
    first = next(day_worths(trace))
    assert first.admitted == totals(by_hand).admitted - totals(trace).admitted
    assert first.profit == pytest.approx(totals(by_hand).profit - totals(trace).profit, abs=1e-9)


def test_a_lowered_rating_is_raised_where_it_was_lowered(bundled):
    lowered = Event(interval=12, event="rating", subject="line:633-634", value=450.0)
    raised_both = higher_rating(bundled.scenario.replacing(events=(lowered,)), TRANSFORMER)
    assert raised_both.events[0].value == 460.0
    line = next(one for one in raised_both.lines if one.name == "633-634")
    assert line.rating_kva == 510.0


def test_what_binds_is_told_with_its_hours(bundled):
    told = " ".join(binding_told(bundled))
    assert "Line or transformer 633–634 (500 kVA) sets the headroom from 00:00 to 24:00" in told
    full = next(row for row in binding_elements(bundled) if row.element == CHARGERS).reached
    assert f"All chargers are in use {Clock(bundled.scenario, 0).spans(full)}." in told
    assert binding_told(start_day(bundled.scenario)) == ()


@pytest.mark.parametrize("preset", sorted(path.name for path in PRESETS.iterdir()))
def test_in_ac_too_only_that_is_reached_which_leaves_no_more_room(preset):
    """Elements without a limit of their own in an interval have all the room there is."""
    trace = run_day(start_day(read_scenario(PRESETS / preset, ()), "ac"), p1_policy())
    records = interval_records(trace)
    full = {
        (r.interval, r.binding)
        for r in records
        if r.headroom_kw - r.station_kw <= max(0.05, 1e-3 * r.headroom_kw)
    }
    rows = [row for row in binding_elements(trace) if row.element != CHARGERS]
    assert {(t, str(row.element)) for row in rows for t in row.reached} == full
