"""The verdict on the limits of a tab's run, told at the head of the page with what helps."""

from collections.abc import Iterable

import streamlit as st

from evdash.metrics.feeder import day_breaches
from evdash.metrics.verdict import FULL_AC, LINEARISED, ModelVerdict, ac_verdict, verdict_of
from evdash.metrics.verdict_words import sentences
from evdash.policies.registry import described
from evdash.ui.apart import one_click
from evdash.ui.parts import view
from evdash.ui.referee import referee
from evdash.ui.session import Session
from evdash.ui.words import marked, wording

AGAIN_HELP = (
    "From its start to its end, with the settings as they are now, and the limits of AC power "
    "flow kept, which knows losses. What happened on the way is forgotten, as by Reset; Undo "
    "brings it back."
)
FROM_NOW_HELP = (
    "The limits of AC power flow, which knows losses, are kept in all hours still to be decided. "
    "Not done where that would break a promise already made."
)


def verdicts(session: Session, patience_seconds: float = 0.0) -> tuple[ModelVerdict, ModelVerdict]:
    """What the linearised model says, plan included, and AC power flow of what it has checked."""
    trace, ahead = session.run.trace, view(session)
    found = referee.findings(trace, patience_seconds)
    linear = session.once(
        "linear_verdict",
        lambda: verdict_of(LINEARISED, day_breaches(trace, ahead.station_kw), ahead.n_intervals),
    )
    ac = session.once("ac_verdict", lambda: ac_verdict(found, len(trace.steps)), detail=len(found))
    return linear, ac


def headline(session: Session) -> None:
    """What is exceeded, in which model, by how much, by whose doing; one click to what helps.

    Drawn once the voltages are, which wait a little for AC power flow.
    """
    trace = session.run.trace
    models = verdicts(session)
    every = sentences(models, wording(trace, view(session)))
    told = [one for one in every if one.state in ("bad", "note")]
    with st.container(gap="xxsmall"):
        for one in told:
            st.markdown(marked(one))
        help_out(session, models)


def _by_linearised(session: Session, model: ModelVerdict) -> bool:
    """Whether charging exceeds a limit in an interval decided by the linearised model."""
    steps = session.run.trace.steps
    return any(
        steps[t].inputs.network == LINEARISED for t in model.intervals_by_charging if t < len(steps)
    )


def help_out(session: Session, models: Iterable[ModelVerdict]) -> None:
    """One click to what keeps the limits that charging exceeds, where that was decided wrongly."""
    trace = session.run.trace
    keeps = described(trace.policy).keeps_limits
    if not keeps or not any(_by_linearised(session, model) for model in models):
        return
    with st.container(horizontal=True, gap="small"):
        if not trace.is_over and trace.inputs.network == LINEARISED:
            st.button(
                "Keep limits in Full AC from now on",
                on_click=one_click(session.rewire),
                args=(FULL_AC,),
                key="rewire_to_ac",
                type="tertiary",
                icon=":material/shield:",
                help=FROM_NOW_HELP,
            )
        st.button(
            "Run the day again in Full AC",
            on_click=one_click(session.run_again_in),
            args=(FULL_AC,),
            key="again_in_ac",
            type="tertiary",
            icon=":material/replay:",
            help=AGAIN_HELP,
        )
