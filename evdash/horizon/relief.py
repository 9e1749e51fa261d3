"""After something has happened: what else would have to change for every promise to be kept."""

from dataclasses import dataclass

import numpy as np

from evdash.domain.trace import State, Trace
from evdash.horizon.advance import snapshot_of
from evdash.scheduling.problem import contracts_problem
from evdash.scheduling.relief import (
    later_return,
    more_chargers,
    more_headroom_kw,
    relief_effort,
)


@dataclass(frozen=True, slots=True)
class Relief:
    """The least of each remedy that alone would keep every promise; None where none would.

    `sure` is whether that is proven; otherwise less might do, or a remedy may be missing.
    `chargers` more, `headroom_kw` more for the station in every interval left,
    `later_intervals` more of waiting for the vehicles that are short.
    """

    chargers: int | None
    headroom_kw: float | None
    later_intervals: int | None
    sure: bool = True


def relief(trace: Trace) -> Relief:
    """The remedies for the promises that are short at `trace.now`."""
    state = trace.state
    contracts = (*state.contracts, *state.waiting)
    nothing = np.zeros((len(state.waiting), state.tail_kw.shape[1]))
    everyone = State(state.now, contracts, np.vstack([state.tail_kw, nothing]))
    owed = np.array([c.promised_kwh - c.delivered_kwh for c in contracts])
    problem = contracts_problem(snapshot_of(trace.inputs, everyone), np.maximum(0.0, owed))
    short = np.array([contract.is_short for contract in contracts], dtype=bool)
    effort = relief_effort()
    return Relief(
        chargers=more_chargers(problem, effort),
        headroom_kw=more_headroom_kw(problem, effort),
        later_intervals=later_return(problem, short, effort),
        sure=not effort.cut_short,
    )
