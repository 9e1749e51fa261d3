"""What more of a limit is worth: the same day, the same arrivals, run again with it changed."""

from collections.abc import Iterator
from dataclasses import dataclass

from evdash.domain.elements import Element
from evdash.domain.events import Event
from evdash.domain.plan import Policy
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Inputs, Trace
from evdash.domain.words import element_words, some_money
from evdash.explain.binding import binding_elements
from evdash.explain.words import counted
from evdash.horizon.day import begin, run_day
from evdash.horizon.networks import NETWORKS
from evdash.horizon.requests import requests_by_interval
from evdash.metrics.service import totals
from evdash.scheduling.p1 import p1_plans

MORE_KVA = 10.0
WIDER_PU = 0.01


@dataclass(frozen=True, slots=True)
class Worth:
    """By how much one change of the inputs moves a day's totals.

    `profit` in $, `admitted` in vehicles, `energy_kwh` delivered. Any of them may be negative:
    nobody knows at noon who comes at night, and room given away early is gone.
    """

    what: str
    profit: float
    admitted: int
    energy_kwh: float

    @property
    def text(self) -> str:
        """In a sentence."""
        if not self.admitted and abs(self.profit) < 0.005:
            return f"{self.what} would have changed nothing."
        vehicles = counted(abs(self.admitted), "vehicle")
        more = "more" if self.admitted >= 0 else "fewer"
        earned = "earned" if self.profit >= 0 else "lost"
        return (
            f"{self.what} would have {earned} {some_money(abs(self.profit))} on this day, with "
            f"{vehicles} {more} admitted."
        )


def day_worths(trace: Trace, policy: Policy | None = None) -> Iterator[Worth]:
    """What one more charger, 10 kVA more of the binding rating and a wider voltage band are worth.

    Each is worked out when asked for, by running the day of `trace` anew from its start, with
    all that happens on the way happening again. The rating is that of the element reached most
    often, or else tightest most often; without a rated element among them there is none to raise.
    """
    policy, given = policy or p1_plans(), trace.inputs.given
    base = rerun(trace, given, policy)
    yield _worth(base, "One more charger", one_more_charger(given), policy)
    element = binding_rating(base)
    if element is not None:
        what = f"{MORE_KVA:g} kVA more on {element_words(element, given)}"
        yield _worth(base, what, higher_rating(given, element), policy)
    what = f"A voltage band wider by {WIDER_PU:g} pu on either side"
    yield _worth(base, what, wider_band(given), policy)


def rerun(trace: Trace, scenario: Scenario, policy: Policy) -> Trace:
    """The whole day under another scenario, with the arrivals of `trace` as they were."""
    network, arrivals = trace.inputs.network, trace.inputs.arrivals
    inputs = Inputs(
        given=scenario,
        scenario=scenario,
        arrivals=arrivals,
        requests=requests_by_interval(scenario, arrivals),
        rows=NETWORKS[network].rows(scenario),
        network=network,
    )
    return run_day(begin(inputs), policy)


def _worth(base: Trace, what: str, scenario: Scenario, policy: Policy) -> Worth:
    before, after = totals(base), totals(rerun(base, scenario, policy))
    return Worth(
        what=what,
        profit=after.profit - before.profit,
        admitted=after.admitted - before.admitted,
        energy_kwh=after.energy_delivered_kwh - before.energy_delivered_kwh,
    )


def one_more_charger(scenario: Scenario) -> Scenario:
    """The scenario with one charger more, also where an event sets how many work."""
    chargers = scenario.station.chargers + 1
    return scenario.replacing(
        station=scenario.station.model_copy(update={"chargers": chargers}),
        events=tuple(_more(e, 1.0) if e.event == "chargers" else e for e in scenario.events),
    )


def wider_band(scenario: Scenario) -> Scenario:
    """The scenario with 0.01 pu more between its voltage limits on either side."""
    limits = scenario.feeder
    wider = {
        "voltage_min_pu": limits.voltage_min_pu - WIDER_PU,
        "voltage_max_pu": limits.voltage_max_pu + WIDER_PU,
    }
    return scenario.replacing(feeder=limits.model_copy(update=wider))


def binding_rating(trace: Trace) -> Element | None:
    """The rated line, transformer or node reached most often in a day, or else tightest."""
    rated = [b for b in binding_elements(trace) if b.element.is_rating]
    return rated[0].element if rated else None


def higher_rating(scenario: Scenario, element: Element) -> Scenario:
    """The scenario with 10 kVA more on a line or node, also where an event rates it."""
    subject = scenario.file_name(element)
    events = tuple(
        _more(e, MORE_KVA) if e.event == "rating" and e.subject == subject else e
        for e in scenario.events
    )
    higher = scenario.with_rating(element, lambda kva: (kva or 0.0) + MORE_KVA)
    return higher.replacing(events=events)


def _more(event: Event, more: float) -> Event:
    return event.model_copy(update={"value": event.amount + more})
