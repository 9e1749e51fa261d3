"""A revision tells every kWh that moved, and why."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.random_days import random_scenario
from evdash.domain.events import Event
from evdash.domain.trace import Trace
from evdash.explain.revisions import explain_revision
from evdash.files.bundled import DEFAULT
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import run_day, start_day, step
from evdash.horizon.happen import happen
from evdash.horizon.revise import revise
from evdash.scheduling.p1 import p1_policy
from tests.builders import vehicle
from tests.explain.cases import ran, roomy

RISING = [0.1, 0.12, 0.14, 0.16]
"""So that every plan is the only cheapest."""


def change_of(trace: Trace, interval: int) -> np.ndarray:
    """Energy of each contract and slot now less before, kWh."""
    before = trace.steps[interval - 1].after.tail_kw
    after = trace.steps[interval].plan.power_kw[: len(before)]
    return (after - before) * trace.scenario.interval_hours


@pytest.mark.parametrize("scenario", [None, 0, 1, 3, 5], ids=str)
def test_all_energy_moved_is_accounted_for(scenario):
    day = read_scenario(DEFAULT, ()) if scenario is None else random_scenario(scenario)
    trace = ran(day)
    for interval in range(1, len(trace.steps)):
        told = explain_revision(trace, interval)
        change = change_of(trace, interval)
        rows = {c.vehicle: n for n, c in enumerate(trace.steps[interval].before.contracts)}
        for move in told.moves:
            change[rows[move.vehicle], move.from_interval - interval] += move.energy_kwh
            change[rows[move.vehicle], move.to_interval - interval] -= move.energy_kwh
        assert abs(change).max(initial=0.0) < 1e-5
        price = day.price_per_kwh[interval:]
        cost = float((change_of(trace, interval) @ price).sum())
        assert told.cost_change == pytest.approx(cost, abs=1e-9)
        assert 0 <= told.for_newcomers_kwh <= told.moved_kwh + 1e-9
        assert told.text.endswith(".")


def test_a_newcomer_takes_the_slot():
    """c is planned for 01:00 and has till 04:00; w, who has only that hour, takes it."""
    scenario = roomy(
        [8.0] * 4,
        price=RISING,
        vehicles=[
            vehicle("c", hour=0, need_kwh=16.0, option="C2", max_kw=8.0),
            vehicle("w", hour=1, need_kwh=8.0, option="C1"),
        ],
    )
    told = explain_revision(ran(scenario), 1)
    assert [(m.vehicle, m.from_interval, m.to_interval) for m in told.moves] == [("c", 1, 2)]
    assert told.moved_kwh == pytest.approx(8.0)
    assert told.for_newcomers_kwh == pytest.approx(8.0)
    assert told.text == (
        "At 01:00 the only contract moved 8.0 kWh for $0.16 more in energy: "
        "c 8.0 kWh from 01:00 to 02:00. All of it made room for w."
    )


def test_cheaper_hours_after_an_edit():
    """The price of the third hour falls once c is planned for the second."""
    scenario = roomy(
        [8.0] * 4,
        price=[0.1, 0.11, 0.2, 0.2],
        vehicles=[vehicle("c", hour=0, need_kwh=16.0, option="C2", max_kw=8.0)],
    )
    trace = step(start_day(scenario), p1_policy())
    profile = tuple(
        row.model_copy(update={"price_per_kwh": 0.01}) if row.interval == 2 else row
        for row in scenario.profile
    )
    trace = run_day(revise(trace, scenario.replacing(profile=profile)), p1_policy())
    told = explain_revision(trace, 1)
    assert told.edited == ("the energy price",)
    assert told.cost_change == pytest.approx(-8 * 0.10)
    assert told.text == (
        "The energy price had been edited. At 01:00 the only contract moved 8.0 kWh for $0.80 "
        "less in energy: c 8.0 kWh from 01:00 to 02:00. It moved into cheaper hours."
    )


def test_an_edit_of_the_limits_is_named():
    scenario = roomy(
        [8.0] * 4,
        price=RISING,
        vehicles=[vehicle("c", hour=0, need_kwh=16.0, option="C2", max_kw=8.0)],
    )
    trace = step(start_day(scenario), p1_policy())
    trace = revise(trace, edit_scenario(trace.scenario, {"feeder.load_scale": 1.1}))
    trace = step(trace, p1_policy())
    told = explain_revision(trace, 1)
    assert told.edited == ("the headroom",)
    assert told.moved_kwh > 0
    assert told.moved_kwh == pytest.approx(abs(change_of(trace, 1)).sum() / 2)


def test_nothing_to_tell():
    scenario = roomy([8.0] * 3, vehicles=[vehicle("c", hour=0, need_kwh=16.0)])
    trace = ran(scenario)
    told = explain_revision(trace, 1)
    assert told.text == "At 01:00 the only contract stayed as planned."
    with pytest.raises(ValueError, match="follows another"):
        explain_revision(trace, 0)
    with pytest.raises(ValueError, match="follows another"):
        explain_revision(replace(trace, steps=trace.steps[1:]), 1)


def test_what_happened_between_two_plans_is_told_and_shifts_no_row():
    """a never comes: the rows of those who stay are held against their own of before."""
    scenario = roomy(
        [16.0] * 5,
        price=[0.1, 0.11, 0.2, 0.2, 0.2],
        vehicles=[
            vehicle("a", hour=0, need_kwh=16.0, option="C2", max_kw=8.0),
            vehicle("b", hour=0, need_kwh=16.0, option="C2", max_kw=8.0),
        ],
    )
    trace = step(start_day(scenario), p1_policy())
    planned = dict(
        zip([c.vehicle for c in trace.state.contracts], trace.state.tail_kw, strict=True)
    )
    gone = happen(trace, [Event(interval=1, event="no_show", subject="a")])
    done = step(gone, p1_policy())
    told = explain_revision(done, 1)
    assert told.text.startswith("At 01:00, a does not come. At 01:00 ")
    assert {move.vehicle for move in told.moves} <= {"b"}
    after = done.steps[1].plan.power_kw[0]
    assert told.cost_change == pytest.approx(
        float((after - planned["b"]) @ done.scenario.price_per_kwh[1:])
    )


def test_what_becomes_short_is_told():
    scenario = roomy(
        [8.0] * 4,
        vehicles=[vehicle("c", hour=0, need_kwh=16.0, option="C2", max_kw=8.0)],
    )
    trace = step(start_day(scenario), p1_policy())
    failed = happen(trace, [Event(interval=1, event="chargers", value=0)])
    told = explain_revision(step(failed, p1_policy()), 1)
    missing = failed.happenings[-1].short_kwh
    assert missing > 1
    assert told.text.startswith("At 01:00, 0 chargers work from now on. ")
    assert f"{missing:.1f} kWh promised to 1 vehicle cannot be delivered in time." in told.text
