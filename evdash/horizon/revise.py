"""Changing the inputs in mid-day without breaking a promise."""

from dataclasses import replace

from evdash.checker.feeder import FeederCheck
from evdash.checker.plans import plan_problems
from evdash.domain.plan import SolveReport, tail_plan
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.errors import SolverFailure
from evdash.horizon.advance import snapshot_of
from evdash.horizon.day import start_day
from evdash.horizon.inputs import prepare_from
from evdash.scheduling.shortfall import plan_for_contracts


def revise(trace: Trace, scenario: Scenario) -> Trace:
    """The day with `scenario` in force from now on; the past stays.

    Before the first step the whole day changes. Later, contracts keep their terms, and
    arrivals are redrawn only from the interval being decided. If the certified tail no
    longer holds under the new limits, another schedule for the same contracts takes its
    place; where there is none, ImpossibleCommitments tells who would miss how much.
    """
    if not trace.steps:
        return start_day(scenario)
    inputs = prepare_from(scenario, trace.inputs, trace.now)
    if trace.is_over:
        return replace(trace, inputs=inputs)
    check = FeederCheck(scenario)
    contracts = trace.state.contracts
    snapshot = replace(snapshot_of(inputs, trace.state), requests=())
    tail = tail_plan(snapshot, "", SolveReport("feasible"))
    if not plan_problems(check, contracts, tail):
        return replace(trace, inputs=inputs)
    tail = replace(tail, power_kw=plan_for_contracts(snapshot))
    problems = plan_problems(check, contracts, tail)
    if problems:
        raise SolverFailure("; ".join(problems))
    return replace(trace, inputs=inputs, state=replace(trace.state, tail_kw=tail.power_kw))
