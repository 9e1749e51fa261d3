"""Changing the inputs in mid-day without breaking a promise."""

from dataclasses import replace

from evdash.checker.plans import plan_problems
from evdash.domain.plan import SolveReport, tail_plan
from evdash.domain.refusal import RefusalReason
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Network, Trace
from evdash.errors import Fault, InputError, SolverFailure
from evdash.horizon.advance import snapshot_of
from evdash.horizon.day import start_day
from evdash.horizon.inputs import prepare_from
from evdash.horizon.networks import limit_check
from evdash.scheduling.shortfall import plan_for_contracts

CLOCK = ("start", "interval_minutes", "intervals")


def revise(trace: Trace, scenario: Scenario, network: Network | None = None) -> Trace:
    """The day with `scenario`, and `network` if given, in force from now on; the past stays.

    `scenario` is one as given: what has happened on the way, by its events, is carried into it.
    Before the first step the whole day changes. Later, contracts keep their terms, and
    arrivals are redrawn only from the interval being decided. If the certified tail no
    longer holds under the new limits, another schedule for the same contracts takes its
    place; where there is none, ImpossibleCommitments tells who would miss how much. The
    clock of a day under way cannot change: InputError.
    """
    revised = put_in_force(trace, scenario, network)
    if not trace.steps or trace.is_over:
        return revised
    check = limit_check(revised.inputs)
    contracts = trace.state.contracts
    snapshot = replace(snapshot_of(revised.inputs, trace.state), requests=())
    tail = tail_plan(snapshot, RefusalReason("fallback"), SolveReport("feasible"))
    if not plan_problems(check, contracts, tail):
        return revised
    tail = replace(tail, power_kw=plan_for_contracts(snapshot))
    problems = plan_problems(check, contracts, tail)
    if problems:
        raise SolverFailure("; ".join(problems))
    return replace(revised, state=replace(trace.state, tail_kw=tail.power_kw))


def put_in_force(trace: Trace, scenario: Scenario, network: Network | None = None) -> Trace:
    """As `revise`, whatever the last plan then breaks: for a policy that keeps no limit."""
    network = network or trace.inputs.network
    if not trace.steps:
        return start_day(scenario, network, trace.policy)
    _refuse_other_clock(trace.scenario, scenario)
    return replace(trace, inputs=prepare_from(scenario, network, trace.inputs, trace.now))


def _refuse_other_clock(old: Scenario, new: Scenario) -> None:
    """Promises are counted in intervals, so that those have to stay what they are."""
    faults = [
        Fault(key, f"{getattr(new, key)}", f"stays {getattr(old, key)} once the day has begun")
        for key in CLOCK
        if getattr(new, key) != getattr(old, key)
    ]
    if faults:
        raise InputError(faults)
