"""Refusals explained on request. No Streamlit in here."""

from evdash.domain.trace import PAPERS, Trace
from evdash.errors import InputError, SolverFailure
from evdash.explain.binding import binding_told
from evdash.explain.refusals import explain_vehicle, too_late
from evdash.explain.revisions import explain_revision
from evdash.explain.worth import day_worths
from evdash.policies.registry import described
from evdash.ui.solving import answers, decider, policy
from evdash.ui.words import plain

BY_P1_ALONE = "That is told of days decided by P1 alone, and this one was decided by {}."
NOT_IN_TIME = "That could not be found out in time."


def refused_latest_first(trace: Trace) -> list[str]:
    """Everyone refused so far, the latest interval's first."""
    by_step = [[refusal.vehicle for refusal in step.plan.refused] for step in trace.steps]
    by_step.append([request.vehicle for request in too_late(trace)])
    return [vehicle for group in reversed(by_step) for vehicle in group]


def told_why(trace: Trace, vehicle: str) -> list[str]:
    """Cause and remedy as paragraphs of Markdown."""
    try:
        explanation = explain_vehicle(trace, vehicle, answers)
    except SolverFailure:
        return [NOT_IN_TIME]
    return [plain(line) for line in (explanation.detail, explanation.remedy) if line]


def told_revision(trace: Trace) -> list[str]:
    """What the last step changed in the plan of the step before it, and why."""
    if len(trace.steps) < 2:
        return ["This is the day's first plan."]
    return told_revision_at(trace, trace.now - 1)


def told_revision_at(trace: Trace, interval: int) -> list[str]:
    """What the step at `interval` changed in the plan of the step before it, and why."""
    try:
        asked, _ = decider(trace)
        return [plain(explain_revision(trace, interval, asked).text)]
    except (InputError, SolverFailure):
        return [NOT_IN_TIME]


def told_binding(trace: Trace) -> list[str]:
    """Which element sets the headroom in which hours, and when it is reached."""
    return [f"- {plain(line)}" for line in binding_told(trace)] or ["Nothing binds so far."]


def told_worths(trace: Trace) -> list[str]:
    """What one more charger, a higher rating, a wider voltage band would have been worth."""
    if trace.policy != PAPERS:
        return [BY_P1_ALONE.format(plain(described(trace.policy).title))]
    try:
        return [f"- {plain(worth.text)}" for worth in day_worths(trace, policy)]
    except SolverFailure:
        return [NOT_IN_TIME]
