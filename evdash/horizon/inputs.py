"""Making a scenario ready to run."""

from evdash.domain.scenario import Arrival, RecordedArrivals, Scenario
from evdash.domain.trace import Inputs
from evdash.grid.reduction import limit_rows
from evdash.horizon.arrivals import arrivals_of, renumbered
from evdash.horizon.requests import first_interval, requests_by_interval


def prepare(scenario: Scenario) -> Inputs:
    """Draw the arrivals, word their requests, reduce the feeder."""
    return inputs_for(scenario, arrivals_of(scenario))


def prepare_from(scenario: Scenario, past: Inputs, now: int) -> Inputs:
    """Inputs in force from interval `now` on: who came before stays, only the rest is redrawn."""
    came = [a for a in past.arrivals if first_interval(past.scenario, a.arrival) < now]
    coming = [a for a in arrivals_of(scenario) if first_interval(scenario, a.arrival) >= now]
    if isinstance(scenario.arrivals, RecordedArrivals):
        return inputs_for(scenario, (*came, *coming))
    return inputs_for(scenario, (*came, *renumbered(coming, first=len(came) + 1)))


def inputs_for(scenario: Scenario, arrivals: tuple[Arrival, ...]) -> Inputs:
    """Inputs for arrivals already known."""
    return Inputs(
        scenario=scenario,
        arrivals=arrivals,
        requests=requests_by_interval(scenario, arrivals),
        rows=limit_rows(scenario),
    )
