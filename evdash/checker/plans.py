"""The checker held against a plan, before the plan counts."""

from collections.abc import Sequence

import numpy as np

from evdash.checker.contracts import Promise, broken_promises, charger_excess
from evdash.domain.plan import Plan
from evdash.domain.trace import LimitCheck
from evdash.domain.vehicles import Contract


def plan_problems(feeder: LimitCheck, contracts: Sequence[Contract], plan: Plan) -> list[str]:
    """Everything a plan breaks, in words; nothing if it may be applied.

    `contracts` are the open ones and the newly made, in the order of the plan's rows.
    """
    scenario = feeder.scenario
    if plan.power_kw.shape != (len(contracts), scenario.intervals - plan.now):
        return [f"the plan's power has shape {plan.power_kw.shape}"]
    if plan.vehicles != tuple(contract.vehicle for contract in contracts):
        return ["the plan's vehicles are not those under contract"]
    promises = [
        Promise(
            vehicle=contract.vehicle,
            first=contract.request.arrival_interval,
            deadline=contract.request.deadline_interval,
            owed_kwh=contract.request.need_kwh - contract.delivered_kwh,
            min_kw=contract.request.min_kw,
            max_kw=contract.request.max_kw,
        )
        for contract in contracts
    ]
    problems = broken_promises(promises, plan.power_kw, plan.now, scenario.interval_hours)
    charging = (plan.power_kw > 0).sum(axis=0)
    problems += charger_excess(charging.tolist(), scenario.station.chargers, plan.now)
    station_kw = np.zeros(scenario.intervals)
    station_kw[plan.now :] = plan.power_kw.sum(axis=0)
    problems += [
        f"{breach.element} exceeded by {breach.depth:.6g} {breach.unit} "
        f"in interval {breach.interval}"
        for breach in feeder.breaches(station_kw)
        if breach.by_station and breach.interval >= plan.now
    ]
    return problems
