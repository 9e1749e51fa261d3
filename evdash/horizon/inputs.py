"""Making a scenario ready to run."""

import numpy as np

from evdash.domain.arrivals import Arrival, GeneratedArrivals
from evdash.domain.limits import LimitRows
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Inputs, Network
from evdash.domain.vehicles import GUEST
from evdash.errors import Fault, InputError
from evdash.horizon.arrivals import arrivals_of, renumbered
from evdash.horizon.in_force import in_force
from evdash.horizon.networks import NETWORKS
from evdash.horizon.requests import first_interval, requests_by_interval

FEEDER_PARTS = ("feeder", "nodes", "lines", "interval_minutes", "intervals")
"""What limits depend on, beside the profile's loads and generation and the station's node."""


def prepare(scenario: Scenario, network: Network = "lindistflow") -> Inputs:
    """Draw the arrivals, word their requests, reduce the feeder; nothing has happened yet."""
    arrivals = arrivals_of(scenario)
    return Inputs(
        given=scenario,
        scenario=scenario,
        arrivals=arrivals,
        requests=requests_by_interval(scenario, arrivals),
        rows=NETWORKS[network].rows(scenario),
        network=network,
    )


def prepare_like(scenario: Scenario, past: Inputs) -> Inputs:
    """As `prepare`, with the rows of `past` where nothing they depend on differs."""
    arrivals = arrivals_of(scenario)
    return Inputs(
        given=scenario,
        scenario=scenario,
        arrivals=arrivals,
        requests=requests_by_interval(scenario, arrivals),
        rows=_rows_after(scenario, past.network, past),
        network=past.network,
    )


def prepare_from(given: Scenario, network: Network, past: Inputs, now: int) -> Inputs:
    """Inputs in force from interval `now` on: who came before stays, only the rest is redrawn.

    `given` is the scenario without what happened on the way; its events up to `now` are carried
    into the one in force. What those who came before asked for stays worded as it was. Once the
    day is over nobody is to come any more, not even too late.
    """
    scenario = in_force(given, now)
    begin = now if now < scenario.intervals else now + 1
    came = [a for a in past.arrivals if first_interval(past.scenario, a.arrival) < begin]
    coming = [a for a in arrivals_of(scenario) if first_interval(scenario, a.arrival) >= begin]
    if isinstance(scenario.arrivals, GeneratedArrivals):
        coming = list(renumbered(coming, first=len(came) + 1))
    # who has just been let in beside the scenario's own arrivals stays, too
    there = {arrival.vehicle for arrival in (*came, *coming)}
    guests = (a for a in past.arrivals if a.vehicle.startswith(GUEST))
    coming += [guest for guest in guests if guest.vehicle not in there]
    _refuse_names_twice(came, coming)
    return Inputs(
        given=given,
        scenario=scenario,
        arrivals=(*came, *coming),
        requests=past.requests[:begin] + requests_by_interval(scenario, coming)[begin:],
        rows=_rows_after(scenario, network, past),
        network=network,
    )


def _rows_after(scenario: Scenario, network: Network, past: Inputs) -> LimitRows:
    """The rows of before where nothing they depend on has changed, so that they stay to the bit."""
    before = past.scenario
    unchanged = (
        network == past.network
        and all(getattr(scenario, part) == getattr(before, part) for part in FEEDER_PARTS)
        and scenario.station.node == before.station.node
        and np.array_equal(scenario.load_pu, before.load_pu)
        and np.array_equal(scenario.generation_pu, before.generation_pu)
    )
    return past.rows if unchanged else NETWORKS[network].rows(scenario)


def _refuse_names_twice(came: list[Arrival], coming: list[Arrival]) -> None:
    known = {arrival.vehicle for arrival in came}
    faults = [
        Fault("arrivals", repr(arrival.vehicle), "has come already; should be a new name")
        for arrival in coming
        if arrival.vehicle in known
    ]
    if faults:
        raise InputError(faults)
