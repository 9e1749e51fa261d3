"""Somebody who comes as the day goes on, beside those the scenario lets arrive."""

from dataclasses import replace

from evdash.domain.arrivals import Arrival
from evdash.domain.trace import Trace
from evdash.domain.vehicles import GUEST
from evdash.errors import Fault, InputError
from evdash.horizon.requests import requests_by_interval


def guest_name(trace: Trace) -> str:
    """A name nobody has yet."""
    taken = {arrival.vehicle for arrival in trace.inputs.arrivals}
    return next(name for n in range(1, len(taken) + 2) if (name := f"{GUEST}{n}") not in taken)


def joined(trace: Trace, guest: Arrival) -> Trace:
    """The day with one more vehicle, who comes now and takes part in the next decision.

    Raises InputError where its option or name is not to be had, or the day is over.
    """
    inputs = trace.inputs
    known = {arrival.vehicle for arrival in inputs.arrivals}
    faults = []
    if trace.is_over:
        faults.append(Fault("the day", "over", "nobody can arrive any more"))
    if guest.option not in inputs.scenario.options_by_name:
        options = ", ".join(inputs.scenario.options_by_name)
        faults.append(Fault("option", guest.option, f"should be one of {options}"))
    if guest.vehicle in known:
        faults.append(Fault("vehicle", guest.vehicle, "has come already; should be a new name"))
    if not guest.soc_in < guest.soc_out:
        faults.append(Fault("soc_out", f"{guest.soc_out:g}", f"should be above {guest.soc_in:g}"))
    if faults:
        raise InputError(faults)
    present = guest.model_copy(update={"arrival": inputs.scenario.time_of(trace.now)})
    asked = requests_by_interval(inputs.scenario, [present])
    requests = tuple(old + new for old, new in zip(inputs.requests, asked, strict=True))
    arrivals = (*inputs.arrivals, present)
    return replace(trace, inputs=replace(inputs, arrivals=arrivals, requests=requests))
