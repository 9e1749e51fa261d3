"""The policies by name: how each is made for a day, and how its plans come to count."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from evdash.domain.plan import Policy
from evdash.domain.trace import Inputs
from evdash.horizon.day import Decide, answered_plan, certified_plan
from evdash.policies.bid_price import bid_price
from evdash.policies.oracle import oracle
from evdash.policies.rules import (
    by,
    earliest_deadline,
    first_come,
    least_laxity,
    uncoordinated,
)
from evdash.scheduling.p1 import p1_policy
from evdash.scheduling.reference import solve_reference


@dataclass(frozen=True, slots=True)
class Rule:
    """A policy's name in words, what it does, how it is made for a day, how its plans count."""

    title: str
    told: str
    make: Callable[[Inputs], Policy]
    decide: Decide = certified_plan

    @property
    def keeps_limits(self) -> bool:
        """Whether its plans count only if they keep every limit and contract."""
        return self.decide is certified_plan


RULES: Mapping[str, Rule] = {
    "p1": Rule(
        "P1, the paper's",
        "Admits what earns most of those who ask now, whoever may come later.",
        lambda _: p1_policy(),
    ),
    "p1-plain": Rule(
        "P1, solved plainly",
        "The same problem as the paper writes it, handed whole to a solver: slower, to compare.",
        lambda _: p1_policy(solve_reference),
    ),
    "bid-price": Rule(
        "bid-price",
        "Admits what earns most together with those expected to come, of whom it knows only "
        "the statistics.",
        lambda inputs: bid_price(inputs.scenario),
    ),
    "fcfs": Rule(
        "First come, first served",
        "Charges in order of arrival and admits whoever then still fits.",
        lambda _: by(first_come),
    ),
    "edf": Rule(
        "Earliest deadline first",
        "Charges who has to be back first, and admits whoever then still fits.",
        lambda _: by(earliest_deadline),
    ),
    "llf": Rule(
        "Least laxity first",
        "Charges who could wait least, and admits whoever then still fits.",
        lambda _: by(least_laxity),
    ),
    "uncoordinated": Rule(
        "Uncoordinated",
        "Admits everyone and charges at full power at once; keeps no limit of feeder or station.",
        lambda _: uncoordinated,
        answered_plan,
    ),
    "oracle": Rule(
        "Oracle",
        "Knows in advance who will come: no policy that keeps the same limits can earn more.",
        oracle,
    ),
}
