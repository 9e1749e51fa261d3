"""Days made so that one vehicle is refused for a reason known by construction."""

from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.explain.refusals import Explanation, explain_vehicle
from evdash.horizon.day import run_day, start_day
from evdash.scheduling.p1 import p1_policy
from tests.builders import make_scenario
from tests.horizon.days import with_headroom


def ran(scenario: Scenario, network="lindistflow") -> Trace:
    return run_day(start_day(scenario, network), p1_policy())


def explained(scenario: Scenario, vehicle: str = "v") -> Explanation:
    return explain_vehicle(ran(scenario), vehicle)


def by(explanation: Explanation) -> dict[str, float]:
    """The amount of each remedy, by kind (of amounts the last)."""
    return {remedy.kind: remedy.amount for remedy in explanation.remedies}


def helpless(explanation: Explanation) -> set[str]:
    return {none.kind for none in explanation.helpless}


def roomy(headroom_kw: list[float], **fields) -> Scenario:
    """Headroom told outright, set by the rating of node a; flat price; 3 chargers of 2–10 kW."""
    return make_scenario(
        **with_headroom(headroom_kw), price=fields.pop("price", [0.1] * len(headroom_kw)), **fields
    )
