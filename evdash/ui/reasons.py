"""Refusals explained on request. No Streamlit in here."""

from evdash.domain.trace import Trace
from evdash.errors import SolverFailure
from evdash.explain.refusals import explain_vehicle, too_late
from evdash.ui.solving import policy
from evdash.ui.words import plain


def refused_latest_first(trace: Trace) -> list[str]:
    """Everyone refused so far, the latest interval's first."""
    by_step = [[refusal.vehicle for refusal in step.plan.refused] for step in trace.steps]
    by_step.append([request.vehicle for request in too_late(trace)])
    return [vehicle for group in reversed(by_step) for vehicle in group]


def told_why(trace: Trace, vehicle: str) -> list[str]:
    """Cause and remedy as paragraphs of Markdown."""
    try:
        explanation = explain_vehicle(trace, vehicle, policy)
    except SolverFailure:
        return ["That could not be found out in time."]
    return [plain(line) for line in (explanation.detail, explanation.remedy) if line]
