"""What the optimiser just decided, and why somebody was refused."""

import streamlit as st

from evdash.domain.trace import PAPERS
from evdash.policies.registry import described
from evdash.ui.parts import small_table, view
from evdash.ui.reasons import (
    refused_latest_first,
    told_binding,
    told_revision,
    told_why,
    told_worths,
)
from evdash.ui.session import Session
from evdash.ui.telling import refused_in, told_below, told_later
from evdash.ui.words import (
    clock,
    decision_lines,
    decision_title,
    plain,
)


def decision(session: Session) -> None:
    """What the optimiser just decided."""
    trace, ahead = session.run.trace, view(session)
    by_p1 = trace.policy == PAPERS
    with st.container(key="decision"):
        if not trace.steps:
            st.markdown(f"#### What {'the optimiser decides' if by_p1 else 'is decided'}")
            st.markdown(INTRODUCTION if by_p1 else _introduction(trace.policy))
            return
        last = trace.steps[-1]
        told = DECISION_HELP if by_p1 else plain(described(trace.policy).told)
        st.markdown(f"#### {decision_title(last, ahead)}", help=told)
        for line in decision_lines(last, ahead):
            st.markdown(line)
        if last.requests:
            rows = session.once("requests", lambda: _requests(session))
            small_table(rows, height=290)
            box = st.expander(
                "All answers in full", key="table_requests", type="compact", on_change="rerun"
            )
            if box.open:
                box.markdown(_reasons(session))
        why(session)
        told_below("revision", "What changed from the plan before", trace, told_revision)
        told_below("binding", "What binds, and when", trace, told_binding)
        if trace.is_over:
            told_below("worth", "What would more have been worth?", trace, told_worths)


ASKED = (
    "Every interval new plug-in electric vehicles (PEVs) ask for a charge and choose a price. The "
    "station says **yes** — "
    "a contract: this much energy by that time — or **no**, at once"
)
PRESS = "Press **Step** to decide the first interval."
INTRODUCTION = (
    f"{ASKED}, knowing nothing of who comes "
    "later. Then it plans all contracted charging anew, for the highest profit within what the "
    f"feeder and the chargers allow.\n\n{PRESS}"
)


def _introduction(policy: str) -> str:
    """What is decided where it is not by P1, and how."""
    rule = described(policy)
    return f"{ASKED}. Here **{plain(rule.title)}** decides: {plain(rule.told)}\n\n{PRESS}"


DECISION_HELP = (
    "The plan is the solution of a mixed-integer linear program. Its cost is compared with a "
    "bound no plan can beat: within 1 cent of it, the plan counts as proven optimal."
)


def _requests(session: Session) -> list[dict[str, object]]:
    ahead, step = view(session), session.run.trace.steps[-1]
    refused = {refusal.vehicle for refusal in step.plan.refused}
    return [
        {
            "Vehicle": request.vehicle,
            "Option": request.option,
            "kWh": round(request.need_kwh, 1),
            "Back by": clock(ahead.times[request.deadline_interval], ahead),
            "Answer": "✗ no" if request.vehicle in refused else "✓ yes",
        }
        for request in step.requests
    ]


def _reasons(session: Session) -> str:
    """Every answer of the last step, as a list: the column is too narrow for a table."""
    step = session.run.trace.steps[-1]
    reasons = {refusal.vehicle: str(refusal.reason) for refusal in step.plan.refused}
    return "\n".join(
        f"- **{plain(request.vehicle)}**: {plain(reasons.get(request.vehicle, 'admitted'))}"
        for request in step.requests
    )


def why(session: Session) -> None:
    """Why one vehicle was refused and what would have admitted it, for the one that is picked.

    Found by solving again, so never before it is asked for, and in the background.
    """
    trace = session.run.trace
    refused = refused_latest_first(trace)
    if not refused:
        return
    picked = st.selectbox(
        "Why was it refused?",
        refused,
        index=None,
        key="why",
        placeholder="Pick a refused vehicle",
        help=WHY_HELP,
    )
    if picked:
        told_later("why_told", refused_in(trace, picked), picked, lambda: told_why(trace, picked))


WHY_HELP = (
    "Found by solving again with one thing changed: the cause, and the least change that would "
    "have admitted this vehicle, all else as it was."
)
