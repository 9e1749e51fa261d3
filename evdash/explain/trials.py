"""P1 solved again at one interval with one thing changed, each change once."""

from dataclasses import dataclass, field, replace

import numpy as np

from evdash.domain.limits import Floats
from evdash.domain.plan import Plan, Policy, Snapshot
from evdash.domain.trace import Inputs
from evdash.domain.vehicles import Request
from evdash.explain.changes import NOTHING, Change, asked, changed
from evdash.scheduling.fast.forced import least_headroom_kw, lp_bound_with
from evdash.scheduling.problem import OPTIMALITY_USD, problem_of
from evdash.scheduling.refused import forcing_bonus

Plans = dict[tuple[str, Change], Plan]
"""P1's plans by the vehicle a change bears on ("" for all alike) and the change."""
CROWD = 6
"""Other newcomers above which each solve takes long, and is shared by all that are refused."""


@dataclass(frozen=True, slots=True)
class Trials:
    """One refused vehicle at one interval, and the plans of all changes tried so far.

    `plans` may be shared by the vehicles refused at one step: a change that bears on all alike
    is solved once for all of them. `lp_bounds` keeps what `lp_bound_with` found.
    """

    inputs: Inputs
    snapshot: Snapshot
    request: Request
    policy: Policy
    plans: Plans = field(default_factory=dict)
    lp_bounds: dict[Change, float] = field(default_factory=dict)

    @property
    def vehicle(self) -> str:
        return self.request.vehicle

    @property
    def window(self) -> int:
        """Slots the vehicle may charge in, count."""
        return self.request.deadline_interval - self.snapshot.now

    @property
    def base(self) -> Plan:
        """P1's plan as it was, without the vehicle."""
        return self.plan(NOTHING)

    @property
    def others(self) -> frozenset[str]:
        """The newcomers beside it."""
        return frozenset(r.vehicle for r in self.snapshot.requests) - {self.vehicle}

    @property
    def is_crowded(self) -> bool:
        """Whether so many compete that each solve takes long."""
        return len(self.others) > CROWD

    @property
    def idle_chargers(self) -> int:
        """As many chargers more as could ever be used at once."""
        everyone = len(self.snapshot.contracts) + len(self.snapshot.requests)
        return max(0, everyone - self.snapshot.chargers)

    @property
    def all_power_kw(self) -> float:
        """Headroom that cannot bind: everyone at full power."""
        everyone = [contract.request for contract in self.snapshot.contracts]
        return sum(r.max_kw for r in [*everyone, *self.snapshot.requests])

    def plan(self, change: Change) -> Plan:
        """P1's plan under a change."""
        key = self._key(change)
        if key not in self.plans:
            self.plans[key] = self.policy(changed(self.inputs, self.snapshot, self.vehicle, key[1]))
        return self.plans[key]

    def _key(self, change: Change) -> tuple[str, Change]:
        change = self.as_far_as_it_matters(change)
        return (self.vehicle if change.bears_on_vehicle else "", change)

    def as_far_as_it_matters(self, change: Change) -> Change:
        """The same P1, said so that vehicles with different windows find it solved already.

        More headroom matters only where all who may charge at full power exceed what there
        is, and no further than that.
        """
        if not change.headroom_kw or change.reshapes_vehicle:
            return change
        missing_kw = self._most_kw() - np.maximum(0.0, self.snapshot.rows.headroom_kw())
        slots = range(self.window) if change.slots is None else change.slots
        binding = tuple(slot for slot in slots if missing_kw[slot] > 0)
        if not binding:
            return replace(change, headroom_kw=0.0, slots=None)
        enough_kw = float(missing_kw[list(binding)].max())
        return replace(change, headroom_kw=min(change.headroom_kw, enough_kw), slots=binding)

    def _most_kw(self) -> Floats:
        """Everyone with an open window at full power, (slots,), kW."""
        everyone = [contract.request for contract in self.snapshot.contracts]
        everyone.extend(self.snapshot.requests)
        ends = np.array([r.deadline_interval for r in everyone]) - self.snapshot.now
        top_kw = np.array([r.max_kw for r in everyone])
        slots = np.arange(self.snapshot.n_slots)
        return np.asarray((slots < ends[:, None]).T @ top_kw)

    def admits(self, change: Change) -> bool:
        """Whether P1 admits the vehicle under a change."""
        if asked(self.inputs, self.snapshot, self.request, change).refusal:
            return False
        return not self.too_dear(change) and self.vehicle in self.plan(change).admitted

    def too_dear(self, change: Change) -> bool:
        """Whether the LP alone proves that P1 refuses the vehicle under a change.

        What is the vehicle's own is rarely refused so, and not asked.
        """
        if change.without or change.bears_on_vehicle or self._key(change) in self.plans:
            return False
        return self.lp_exceeds(change, self.known_cost(change) + OPTIMALITY_USD)

    def known_cost(self, change: Change) -> float:
        """What P1's value under a change of headroom or chargers cannot exceed, $.

        More of both never makes it dearer, so every plan made with less of both says so.
        """
        change, as_it_was = self.as_far_as_it_matters(change), self.cost_without
        less_room = [
            _objective(plan)
            for (vehicle, less), plan in self.plans.items()
            if not vehicle and less.is_within(change)
        ]
        return min([as_it_was, *less_room])

    def lp_exceeds(self, change: Change, usd: float) -> bool:
        """Whether the LP's value with the vehicle in exceeds an amount under a change.

        It is not solved where it cannot: more headroom or chargers never make it dearer.
        """
        change = self.as_far_as_it_matters(change)
        for other, bound in self.lp_bounds.items():
            if bound <= usd and other.is_within(change):
                return False
            if bound > usd and change.is_within(other):
                return True
        return self.lp_bound_with(change) > usd

    def lp_bound_with(self, change: Change) -> float:
        """What P1's value with the vehicle in cannot fall below, by its LP, $."""
        change = self.as_far_as_it_matters(change)
        if change not in self.lp_bounds:
            anew = changed(self.inputs, self.snapshot, self.vehicle, change)
            self.lp_bounds[change] = lp_bound_with(problem_of(anew), self.vehicle)
        return self.lp_bounds[change]

    def none_between(self, less: Change, more: Change) -> bool:
        """Whether nothing between two amounts can admit the vehicle, a tie within a cent apart."""
        if self.lp_exceeds(more, self.known_cost(less) - OPTIMALITY_USD):
            return True
        return self.bound_with(more) >= self.cost(less) - OPTIMALITY_USD

    def least_headroom_kw(self) -> float:
        """With less headroom more than this the vehicle cannot fit beside the contracts, kW."""
        alone = changed(self.inputs, self.snapshot, self.vehicle, Change(without=self.others))
        return least_headroom_kw(problem_of(alone), self.vehicle, range(self.window))

    def cost(self, change: Change) -> float:
        """P1's value under a change, $."""
        return _objective(self.plan(change))

    def fits(self, change: Change = NOTHING) -> bool:
        """Whether a plan for the contracts and the vehicle was found.

        Newcomers need not be admitted, so they need not be asked: the problem is small.
        """
        alone = replace(change, without=self.others)
        if self.admits(replace(alone, bonus=self.bonus)):
            return True
        return not self.cannot_fit(change) and self.admits(alone)

    def cannot_fit(self, change: Change = NOTHING) -> bool:
        """Whether it is proven that no plan for the contracts can hold the vehicle too."""
        alone = replace(change, bonus=self.bonus, without=self.others)
        if asked(self.inputs, self.snapshot, self.request, alone).refusal:
            return True
        if self.known_to_fit(change):
            return False
        return not self.admits(alone) and self.plan(alone).report.status == "optimal"

    def known_to_fit(self, change: Change) -> bool:
        """Whether a plan made with no more headroom or chargers holds the vehicle."""
        change = self.as_far_as_it_matters(change)
        return any(
            self.vehicle in plan.admitted
            and replace(less, bonus=0.0, without=frozenset()).is_within(change)
            for (_, less), plan in self.plans.items()
        )

    def forced(self, change: Change = NOTHING) -> Plan | None:
        """P1's plan with the vehicle in, whatever it costs; None if no such plan was found.

        A bonus above all that could be lost by admitting it forces it in wherever it fits,
        and P1's own answer says whether it does.
        """
        forcing = replace(change, bonus=self.bonus)
        if self.cannot_fit(change) or not self.admits(forcing):
            return None
        return self.plan(forcing)

    def cost_with(self, change: Change = NOTHING) -> float:
        """P1's value with the vehicle in and paying its own price, $; inf if no plan was found."""
        plan = self.forced(change)
        return np.inf if plan is None else _objective(plan) + self.bonus

    def bound_with(self, change: Change = NOTHING) -> float:
        """What P1's value with the vehicle in cannot fall below, $; inf if it cannot fit."""
        if self.cannot_fit(change):
            return np.inf
        return _bound(self.plan(replace(change, bonus=self.bonus))) + self.bonus

    @property
    def cost_without(self) -> float:
        """P1's value as it was, $."""
        return self.cost(NOTHING)

    @property
    def bound_without(self) -> float:
        """What P1's value as it was cannot fall below, $."""
        return _bound(self.base)

    @property
    def bonus(self) -> float:
        """More than any two plans can differ by, $."""
        return forcing_bonus(self.snapshot, self.inputs.scenario.tariff)


def _objective(plan: Plan) -> float:
    objective = plan.report.objective
    return np.inf if objective is None else objective


def _bound(plan: Plan) -> float:
    return -np.inf if plan.report.bound is None else plan.report.bound
