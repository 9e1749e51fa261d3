"""A run in the figures by which runs are compared."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from evdash.domain.outlook import Outlook
from evdash.domain.trace import Trace
from evdash.metrics.ac import AcPoint
from evdash.metrics.ledger import broken_promises, ledger
from evdash.metrics.service import Totals, totals
from evdash.metrics.verdict import ac_verdict


@dataclass(frozen=True, slots=True)
class KeyFigures:
    """Totals of the intervals executed, lowest voltages in them, and what deciding took.

    Voltages in pu, None before the first step; the AC ones cover the intervals in
    `ac_known`; of these, charging exceeds a limit in `ac_breached` and the feeder one by itself in
    `ac_breached_by_feeder`. In `ac_unchecked` of them the power flow itself failed: they count as
    neither kept nor exceeded. `broken` counts promises not kept or known not to be.
    """

    day: Totals
    broken: int
    lowest_voltage_pu: float | None
    lowest_node: str
    lowest_ac_pu: float | None
    ac_known: int
    ac_breached: int
    ac_breached_by_feeder: int
    ac_unchecked: int
    solve_seconds: float
    worst_solve_seconds: float


def key_figures(trace: Trace, ahead: Outlook, ac: Mapping[int, AcPoint]) -> KeyFigures:
    """The figures of the steps taken; `ac` is what AC power flow found, by interval."""
    voltage = ahead.voltage_pu[: trace.now]
    executed = {step.interval: ac[step.interval] for step in trace.steps if step.interval in ac}
    known, verdict = list(executed.values()), ac_verdict(executed, len(trace.steps))
    solved = [float(point.voltage_pu.min()) for point in known if point.solved]
    seconds = [step.plan.report.seconds for step in trace.steps]
    lowest = np.unravel_index(int(voltage.argmin()), voltage.shape)[1] if voltage.size else None
    return KeyFigures(
        day=totals(trace),
        broken=len(broken_promises(ledger(trace))),
        lowest_voltage_pu=float(voltage.min()) if voltage.size else None,
        lowest_node="" if lowest is None else ahead.nodes[int(lowest)],
        lowest_ac_pu=min(solved, default=None),
        ac_known=len(known),
        ac_breached=len(verdict.intervals_by_charging),
        ac_breached_by_feeder=len({t for one in verdict.by_feeder for t in one.intervals}),
        ac_unchecked=len(verdict.failures),
        solve_seconds=sum(seconds),
        worst_solve_seconds=max(seconds, default=0.0),
    )


def until(trace: Trace, n_steps: int) -> Trace:
    """The day as it stood after `n_steps`; the day itself where it has not come so far."""
    if n_steps >= len(trace.steps):
        return trace
    following = trace.steps[n_steps]
    return replace(
        trace,
        inputs=following.inputs,
        state=following.before,
        steps=trace.steps[:n_steps],
        happenings=tuple(h for h in trace.happenings if h.interval <= n_steps),
    )


def common_steps(traces: list[Trace]) -> list[int]:
    """How many steps of each trace lie within the time that all of them have come through."""
    hours = min(trace.now * trace.scenario.interval_hours for trace in traces)
    return [int(hours / trace.scenario.interval_hours + 1e-9) for trace in traces]
