"""Limits exceeded by a day as executed, each interval under the inputs then in force."""

from collections.abc import Callable, Sequence

from evdash.checker.feeder import FeederCheck
from evdash.domain.breach import Breach
from evdash.domain.elements import CHARGERS
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.metrics.outlook import spans_in_force
from evdash.metrics.records import executed_station_kw


def linear_breaches(trace: Trace) -> tuple[Breach, ...]:
    """What the independent checker finds in the linearised model, for a day that is over."""
    station_kw = executed_station_kw(trace)
    return in_force_only(trace, lambda scenario: FeederCheck(scenario).breaches(station_kw))


def charger_breaches(trace: Trace) -> tuple[Breach, ...]:
    """Intervals with more vehicles charging than there were chargers; none under any policy
    that keeps limits."""
    return tuple(
        Breach(
            interval=step.interval,
            element=CHARGERS,
            depth=float(step.plan.charging[0] - step.inputs.scenario.station.chargers),
            base_depth=0.0,
            unit="vehicles",
            tolerance=0.0,
        )
        for step in trace.steps
        if step.plan.charging[0] > step.inputs.scenario.station.chargers
    )


def in_force_only(
    trace: Trace, breaches: Callable[[Scenario], Sequence[Breach]]
) -> tuple[Breach, ...]:
    """Of the breaches found under each scenario those in the intervals it was in force."""
    return tuple(
        breach
        for inputs, span in spans_in_force(trace)
        for breach in breaches(inputs.scenario)
        if span.start <= breach.interval < span.stop
    )
