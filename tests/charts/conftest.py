"""A day seen at three moments: before it begins, in the evening, when it is over."""

import pytest

from evdash.domain.trace import Trace
from evdash.files.bundled import DEFAULT
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import start_day, step
from evdash.scheduling.p1 import p1_policy

MOMENTS = {"start": 0, "evening": 19, "end": 24}


@pytest.fixture(scope="session")
def traces() -> dict[str, Trace]:
    trace = start_day(read_scenario(DEFAULT))
    seen = {}
    while True:
        seen |= {name: trace for name, now in MOMENTS.items() if now == trace.now}
        if trace.is_over:
            return seen
        trace = step(trace, p1_policy())


@pytest.fixture(params=MOMENTS)
def trace(request: pytest.FixtureRequest, traces: dict[str, Trace]) -> Trace:
    return traces[request.param]
