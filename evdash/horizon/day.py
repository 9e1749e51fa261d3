"""The moving horizon: the one loop over the day in the whole program."""

from collections.abc import Callable
from dataclasses import replace

from evdash.checker.plans import plan_problems
from evdash.domain.plan import Plan, Policy, Snapshot, SolveReport, tail_plan
from evdash.domain.refusal import RefusalReason
from evdash.domain.scenario import Scenario
from evdash.domain.trace import PAPERS, Inputs, LimitCheck, Network, Step, Trace
from evdash.errors import PowerFlowDiverged, SolverFailure
from evdash.horizon.advance import advance, contracts_under, initial_state, snapshot_of
from evdash.horizon.happen import reached
from evdash.horizon.inputs import prepare
from evdash.horizon.networks import limit_check

Decide = Callable[[Policy, Snapshot, LimitCheck], Plan]
"""How a policy's answer comes to count: `certified_plan`, or `answered_plan` where no limit is
to be kept."""


def start_day(scenario: Scenario, network: Network = "lindistflow", policy: str = PAPERS) -> Trace:
    """A day about to begin, to be decided by the policy named."""
    return begin(prepare(scenario, network), policy)


def begin(inputs: Inputs, policy: str = PAPERS) -> Trace:
    """A day about to begin, from inputs already prepared."""
    state = initial_state(inputs.scenario.intervals)
    return reached(Trace(inputs=inputs, state=state, policy=policy))


def run_day(
    trace: Trace,
    policy: Policy,
    on_step: Callable[[Trace], None] | None = None,
    decide: Decide | None = None,
) -> Trace:
    """Step to the end of the horizon, telling `on_step` after every step."""
    inputs, check = trace.inputs, limit_check(trace.inputs)
    while not trace.is_over:
        if trace.inputs is not inputs:  # something has happened
            inputs, check = trace.inputs, limit_check(trace.inputs)
        trace = step(trace, policy, check, decide)
        if on_step is not None:
            on_step(trace)
    return trace


def step(
    trace: Trace, policy: Policy, check: LimitCheck | None = None, decide: Decide | None = None
) -> Trace:
    """Decide the interval `trace.now` and carry it out, up to what happens as the next begins.

    The trace given stays as it was.
    """
    inputs, before = trace.inputs, trace.state
    check = check or limit_check(inputs)
    snapshot = snapshot_of(inputs, before)
    plan = (decide or certified_plan)(policy, snapshot, check)
    after = advance(before, plan, snapshot.requests, snapshot.interval_hours)
    taken = Step(before=before, inputs=inputs, requests=snapshot.requests, plan=plan, after=after)
    return reached(replace(trace, state=after, steps=(*trace.steps, taken)))


def certified_plan(policy: Policy, snapshot: Snapshot, check: LimitCheck) -> Plan:
    """The policy's plan if it passes every check, else the last plan's tail, labelled so.

    The tail was certified when it was made and inputs are only changed by `revise` and `happen`,
    which certify it anew, so that a step never breaks a contract. A solver or power flow that
    found nothing is answered by the tail; any other exception is a mistake in the policy's
    code and is let through, with the trace as it was.
    """
    try:
        plan = policy(snapshot)
    except (SolverFailure, PowerFlowDiverged) as failure:
        return fallback(snapshot, str(failure))
    problems = answer_problems(plan, snapshot)
    if not problems:
        contracts = contracts_under(plan, snapshot.contracts, snapshot.requests)
        problems = plan_problems(check, contracts, plan)
    return fallback(snapshot, "; ".join(problems)) if problems else plan


def answered_plan(policy: Policy, snapshot: Snapshot, _check: LimitCheck) -> Plan:
    """The policy's plan if it answers the snapshot, whatever it does to the limits."""
    plan = policy(snapshot)
    problems = answer_problems(plan, snapshot)
    return fallback(snapshot, "; ".join(problems)) if problems else plan


def answer_problems(plan: Plan, snapshot: Snapshot) -> list[str]:
    """What keeps a plan from being an answer to the snapshot at all, in words."""
    problems = []
    if plan.now != snapshot.now:
        problems.append(f"the plan is for interval {plan.now}, not for {snapshot.now}")
    if plan.vehicles[: len(snapshot.contracts)] != tuple(c.vehicle for c in snapshot.contracts):
        problems.append("the plan leaves out contracts or their order")
    if plan.vehicles[len(snapshot.contracts) :] != plan.admitted:
        problems.append("the plan's new vehicles are not those it says it admits")
    answered = [*plan.admitted, *(refusal.vehicle for refusal in plan.refused)]
    if sorted(answered) != sorted(request.vehicle for request in snapshot.requests):
        problems.append("the plan does not answer every request, and no other, once")
    return problems


def fallback(snapshot: Snapshot, why: str) -> Plan:
    """The certified tail without new contracts."""
    report = SolveReport("fallback", objective=snapshot.tariff.cost(snapshot.tail_kw), note=why)
    return tail_plan(snapshot, RefusalReason("fallback"), report)
