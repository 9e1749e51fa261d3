"""A policy from outside: asked with care, and its answer made into a whole plan.

It is somebody else's code and never trusted: it sees a copy of the snapshot, may raise, answer
nonsense or never come back, and its plan counts only if the independent checker passes it.
"""

import copy
import time
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from evdash.domain.limits import Floats
from evdash.domain.plan import Plan, Policy, Refusal, Snapshot, SolveReport
from evdash.domain.refusal import RefusalReason
from evdash.domain.trace import LimitCheck
from evdash.errors import PolicyFault, SolverFailure, legible
from evdash.horizon.day import Decide, certified_plan
from evdash.scheduling.clean import RESIDUAL_KW
from evdash.scheduling.effort import Effort
from evdash.scheduling.guarded import answered
from evdash.scheduling.refused import short_of_headroom

ANSWER = (
    "should be a mapping from a vehicle's name to its power in kW in every slot, or an evdash Plan"
)
LEFT_BEHIND = "it did not come back in an earlier interval and is not asked again"


class Outside:
    """Somebody else's function as a policy. Raises PolicyFault for whatever it does wrong."""

    def __init__(self, function: Callable[[Snapshot], object]) -> None:
        self._function = function
        self._is_left_behind = False

    def __call__(self, snapshot: Snapshot, /) -> Plan:
        if self._is_left_behind:
            raise PolicyFault(LEFT_BEHIND)
        began, effort = time.perf_counter(), Effort()
        try:
            answer = answered(lambda: self._asked(snapshot), effort)
        except PolicyFault:
            raise
        except SolverFailure as failure:  # in the solvers' words, whom this guard is made for
            self._is_left_behind = effort.left_behind
            raise PolicyFault(f"{failure}".replace("the solver", "it", 1)) from failure
        return completed(snapshot, answer, time.perf_counter() - began)

    def _asked(self, snapshot: Snapshot) -> object:
        try:
            return self._function(copy.deepcopy(snapshot))
        except (Exception, SystemExit) as error:
            raise PolicyFault(f"it raised {type(error).__name__}: {error}") from error


def certified_for(name: str) -> Decide:
    """As every plan is certified; where the last one is kept, the policy and its fault are named,
    to whoever asked in vain, too."""

    def decide(policy: Policy, snapshot: Snapshot, check: LimitCheck) -> Plan:
        plan = certified_plan(policy, snapshot, check)
        if plan.report.status != "fallback":
            return plan
        why = legible(f"{name}: {plan.report.note}")
        kept = RefusalReason("fallback", where=why)
        refused = tuple(
            replace(one, reason=kept) if one.reason.kind == "fallback" else one
            for one in plan.refused
        )
        return replace(plan, refused=refused, report=replace(plan.report, note=why))

    return decide


def completed(snapshot: Snapshot, answer: object, seconds: float = 0.0) -> Plan:
    """The plan an answer stands for. Raises PolicyFault, in words, if it stands for none.

    Contracts it leaves out keep what was last planned for them. Who asks and is in it is admitted,
    everybody else refused: at the door, by the feeder alone, or as the policy says.
    """
    given = _rows(answer)
    contracts = tuple(contract.vehicle for contract in snapshot.contracts)
    asking = {request.vehicle: request for request in snapshot.requests}
    for name in given:
        if name not in asking and name not in contracts:
            raise PolicyFault(f"it plans for {name!r}, who neither asks now nor has a contract")
        if name in asking and (door := asking[name].refusal):
            raise PolicyFault(f"it admits {name}, whom nobody can serve: {door}")
    power = {name: _power_kw(name, row, snapshot.n_slots) for name, row in given.items()}
    admitted = tuple(name for name in asking if name in power)
    planned = dict(zip(contracts, snapshot.tail_kw, strict=True)) | power
    vehicles = (*contracts, *admitted)
    words = _words(answer)
    return Plan(
        now=snapshot.now,
        vehicles=vehicles,
        power_kw=np.array([planned[name] for name in vehicles]).reshape(-1, snapshot.n_slots),
        admitted=admitted,
        refused=tuple(
            Refusal(
                name,
                request.refusal
                or short_of_headroom(snapshot, request)
                or RefusalReason("policy", where=words.get(name, "")),
            )
            for name, request in asking.items()
            if name not in power
        ),
        report=SolveReport("feasible", seconds=seconds),
        capacity_price_per_kwh=_prices(answer, snapshot.n_slots),
    )


def _rows(answer: object) -> dict[str, object]:
    """What an answer gives each vehicle, not looked at yet."""
    if isinstance(answer, Plan):
        if len(answer.vehicles) != len(answer.power_kw):
            counts = f"{len(answer.vehicles)} vehicles and {len(answer.power_kw)} rows of power"
            raise PolicyFault(f"its plan has {counts}")
        rows = dict(zip(answer.vehicles, answer.power_kw, strict=True))
        if len(rows) != len(answer.vehicles):
            raise PolicyFault("its plan names a vehicle twice")
        return rows
    if not isinstance(answer, Mapping):
        raise PolicyFault(f"it answered {type(answer).__name__}; {ANSWER}")
    for name in answer:
        if not isinstance(name, str):
            raise PolicyFault(f"it answered with the key {name!r}; {ANSWER}")
    return dict(answer)


def _power_kw(vehicle: str, row: object, n_slots: int) -> Floats:
    """A vehicle's power, (slots,), kW, what a solver leaves over taken for nothing."""
    try:
        power_kw = np.array(row, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise PolicyFault(f"its power for {vehicle} are no numbers ({error})") from error
    if power_kw.shape != (n_slots,):
        shape = f"has shape {power_kw.shape}, and {n_slots} slots are left"
        raise PolicyFault(f"its power for {vehicle} {shape}")
    return np.where(np.abs(power_kw) <= RESIDUAL_KW, 0.0, power_kw)


def _words(answer: object) -> dict[str, str]:
    """Why somebody is refused, as a policy that answers a whole plan may say."""
    if not isinstance(answer, Plan):
        return {}
    told = {}
    for refusal in answer.refused:
        reason: object = refusal.reason  # an author may give a text
        own = isinstance(reason, RefusalReason) and reason.kind == "policy"
        told[refusal.vehicle] = legible(refusal.reason.where if own else str(reason))
    return told


def _prices(answer: object, n_slots: int) -> Floats | None:
    """The price of each slot's capacity, (slots,), if a policy tells one."""
    if not isinstance(answer, Plan) or answer.capacity_price_per_kwh is None:
        return None
    prices = np.array(answer.capacity_price_per_kwh, dtype=np.float64)
    if prices.shape != (n_slots,) or not np.isfinite(prices).all():
        raise PolicyFault(f"its prices of capacity are not {n_slots} numbers")
    return prices
