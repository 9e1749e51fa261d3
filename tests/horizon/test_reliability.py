"""The long run's own judge: it passes sound days and tells each way in which one is not."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks import reliability
from benchmarks.kept_days import kept, run_kept
from benchmarks.random_days import random_scenario
from benchmarks.reliability import FORM, Result, rows_of, run_one
from benchmarks.soundness import problems_of_day
from evdash.domain.trace import Step, Trace
from evdash.horizon.day import run_day, start_day
from evdash.scheduling.p1 import p1_policy
from tests.builders import make_scenario, vehicle
from tests.horizon.days import with_headroom


def sound_day() -> Trace:
    vehicles = [vehicle(name, need_kwh=12.0, option="C2") for name in ("a", "b")]
    day = make_scenario(
        **with_headroom([13.0, 13.0, 13.0]),
        price=[0.2, 0.1, 0.15],
        vehicles=vehicles,
        station={"chargers": 2},
    )
    return run_day(start_day(day), p1_policy())


def with_step(trace: Trace, k: int, step: Step) -> Trace:
    return replace(trace, steps=(*trace.steps[:k], step, *trace.steps[k + 1 :]))


def with_power(trace: Trace, k: int, change) -> Trace:
    taken = trace.steps[k]
    plan = replace(taken.plan, power_kw=change(taken.plan.power_kw.copy()))
    return with_step(trace, k, replace(taken, plan=plan))


def told(trace: Trace) -> str:
    return "\n".join(problems_of_day(trace))


def test_a_sound_day_passes():
    trace = sound_day()
    assert trace.steps[0].plan.admitted == ("a", "b")
    assert told(trace) == ""


def test_energy_missing_is_told():
    assert "a: promised 12.0 kWh, off by" in told(with_power(sound_day(), 1, lambda p: p * 0.9))


def test_charging_out_of_time_is_told():
    trace = sound_day()
    early = replace(trace.steps[0].requests[0], arrival_interval=2)
    step = replace(trace.steps[0], requests=(early, trace.steps[0].requests[1]))
    assert "outside its time" in told(with_step(trace, 0, step))


def test_too_few_chargers_and_too_little_headroom_are_told():
    trace = sound_day()
    busiest = int(np.argmax([s.plan.charging[0] for s in trace.steps]))
    step = trace.steps[busiest]
    fewer = replace(
        step.inputs,
        scenario=step.inputs.scenario.replacing(
            station=step.inputs.scenario.station.model_copy(update={"chargers": 0})
        ),
        rows=replace(step.inputs.rows, limit_kw=step.inputs.rows.limit_kw * 0),
    )
    found = told(with_step(trace, busiest, replace(step, inputs=fewer)))
    assert "on 0 chargers" in found
    assert "headroom 0.0 kW" in found


def test_a_tail_that_is_not_feasible_is_told():
    trace = sound_day()
    after = replace(trace.steps[0].after, tail_kw=trace.steps[0].after.tail_kw * 0.5)
    found = told(with_step(trace, 0, replace(trace.steps[0], after=after)))
    assert "interval 0: its tail is not feasible" in found


def test_a_fallback_and_falling_profit_are_told():
    trace = sound_day()
    step = trace.steps[1]
    labelled = replace(step.plan, report=replace(step.plan.report, status="fallback", note="why"))
    assert "interval 1: fallback (why)" in told(with_step(trace, 1, replace(step, plan=labelled)))
    dearer = step.inputs.scenario.replacing(
        profile=tuple(
            row.model_copy(update={"price_per_kwh": 0.9}) for row in step.inputs.scenario.profile
        )
    )
    dear = replace(step, inputs=replace(step.inputs, scenario=dearer))
    assert "interval 1: profit falls" in told(with_step(trace, 1, dear))


def test_random_days_are_the_same_for_the_same_seed_and_differ_between_seeds():
    assert random_scenario(3) == random_scenario(3)
    assert random_scenario(3) != random_scenario(4)


def test_a_short_run_is_sound_and_reported():
    results = [run_one(seed) for seed in (2, 17)]
    assert all(result.problems == () for result in results)
    rows = dict(rows_of(results, 1.0))
    assert rows["days"] == "2"
    assert rows["infeasible intervals"] == "0"
    assert int(rows["contracts"]) > 0


@pytest.mark.parametrize(("problems", "status"), [((), 0), (("it broke",), 3)])
def test_the_exit_status_says_whether_anything_broke(monkeypatch, capsys, problems, status):
    result: Result = replace(run_one(2), problems=problems)
    monkeypatch.setattr(reliability, "run_kept", lambda *asked, **how: [result])
    assert reliability.main(["--days", "1"]) == status
    assert ("seed 2: it broke" in capsys.readouterr().out) is bool(problems)


def once(seed: int) -> Result:
    """A day that cannot be run twice."""
    mark = Path(os.environ["EVDASH_TEST_DAYS"]) / f"{seed}"
    mark.touch(exist_ok=False)
    return run_one(seed)


def test_days_are_kept_and_not_run_again(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("EVDASH_TEST_DAYS", str(tmp_path))
    file = tmp_path / "days"
    first = run_kept(once, range(2, 3), 1, FORM, told="days", file=file)
    both = run_kept(once, range(1, 3), 1, FORM, told="days", file=file)
    assert [result.seed for result in both] == [1, 2]
    assert both[1:] == first
    assert [result.seed for result in kept(file, FORM)] == [2, 1]
