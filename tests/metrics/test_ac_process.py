"""What the AC process is asked arrives as it was, whatever has happened to the scenario."""

import numpy as np

from benchmarks.random_days import random_scenario
from benchmarks.random_events import random_events
from evdash.domain.scenario import Scenario
from evdash.horizon.day import start_day, step
from evdash.horizon.happen import happen
from evdash.policies.registry import RULES

SEEDS = range(1, 25)
MOST_INTERVALS = 30


def test_scenarios_changed_by_events_arrive_as_they_are() -> None:
    happened = 0
    for seed in SEEDS:
        rng, trace = np.random.default_rng(seed), start_day(random_scenario(seed))
        policy = RULES["edf"].make(trace.inputs)
        while trace.now < min(MOST_INTERVALS, trace.scenario.intervals):
            if events := random_events(rng, trace):
                trace = happen(trace, events)
                changed = trace.inputs.scenario
                assert Scenario.model_validate_json(changed.model_dump_json()) == changed
                happened += 1
            trace = step(trace, policy)
    assert happened > 30
