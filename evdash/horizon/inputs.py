"""Making a scenario ready to run."""

from evdash.domain.scenario import Arrival, GeneratedArrivals, Scenario
from evdash.domain.trace import Inputs
from evdash.errors import Fault, InputError
from evdash.grid.reduction import limit_rows
from evdash.horizon.arrivals import arrivals_of, renumbered
from evdash.horizon.requests import first_interval, requests_by_interval


def prepare(scenario: Scenario) -> Inputs:
    """Draw the arrivals, word their requests, reduce the feeder."""
    return inputs_for(scenario, arrivals_of(scenario))


def prepare_from(scenario: Scenario, past: Inputs, now: int) -> Inputs:
    """Inputs in force from interval `now` on: who came before stays, only the rest is redrawn.

    What those who came before asked for stays worded as it was. Once the day is over nobody
    is to come any more, not even too late.
    """
    begin = now if now < scenario.intervals else now + 1
    came = [a for a in past.arrivals if first_interval(past.scenario, a.arrival) < begin]
    coming = [a for a in arrivals_of(scenario) if first_interval(scenario, a.arrival) >= begin]
    if isinstance(scenario.arrivals, GeneratedArrivals):
        coming = list(renumbered(coming, first=len(came) + 1))
    _refuse_names_twice(came, coming)
    return Inputs(
        scenario=scenario,
        arrivals=(*came, *coming),
        requests=past.requests[:begin] + requests_by_interval(scenario, coming)[begin:],
        rows=limit_rows(scenario),
    )


def _refuse_names_twice(came: list[Arrival], coming: list[Arrival]) -> None:
    known = {arrival.vehicle for arrival in came}
    faults = [
        Fault("arrivals", repr(arrival.vehicle), "has come already; should be a new name")
        for arrival in coming
        if arrival.vehicle in known
    ]
    if faults:
        raise InputError(faults)


def inputs_for(scenario: Scenario, arrivals: tuple[Arrival, ...]) -> Inputs:
    """Inputs for arrivals already known."""
    return Inputs(
        scenario=scenario,
        arrivals=arrivals,
        requests=requests_by_interval(scenario, arrivals),
        rows=limit_rows(scenario),
    )
