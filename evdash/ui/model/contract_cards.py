"""The equations of contracts, filled in: (5) to (7)."""

from evdash.scheduling import equations
from evdash.ui.model.card import NOBODY, Card, Filled, Numbers
from evdash.ui.model.tex import name, number, total
from evdash.ui.words import counted, plain


def contracts(n: Numbers) -> Filled:
    """(5a), (5b)."""
    before, plan = len(n.step.before.contracts), n.step.plan
    tex = rf"\underbrace{{u = 1}}_{{{before}\ \text{{under contract}}}}"
    tex += rf"\qquad \underbrace{{u \in \{{0, 1\}}}}_{{{len(n.step.requests)}\ \text{{new}}}}"
    if n.vehicle is not None:
        tex += rf"\qquad u_{{{name(n.vehicle.request.vehicle)}}} = {int(n.vehicle.admitted)}"
    return tex, (
        f"{counted(before, 'vehicle')} must go on being served; of "
        f"{counted(len(n.step.requests), 'newcomer')} {len(plan.admitted)} got a contract and "
        f"{len(plan.refused)} did not."
    )


def only_contracts(n: Numbers) -> Filled:
    """(6a)."""
    v = n.vehicle
    if v is None:
        return NOBODY
    hours = sum(power > 0 for power in v.power_kw)
    tex = rf"D_{{{name(v.request.vehicle)},t}} \le {int(v.admitted)}\quad \forall t"
    if v.admitted:
        said = f"has a contract and is switched on in {counted(hours, 'interval')} of its plan"
    else:
        said = "has no contract, so its charger stays off"
    return tex, f"{plain(v.request.vehicle)} {said}."


def charger_limits(n: Numbers) -> Filled:
    """(6b)."""
    v = n.vehicle
    if v is None:
        return NOBODY
    name_, power = plain(v.request.vehicle), v.power_kw[0] if v.power_kw else 0.0
    low, high = number(v.low_kw), number(v.request.max_kw)
    if power <= 0:
        tex = rf"{low} \cdot 0 \le 0 \le {high} \cdot 0\ \text{{kW}}"
        return tex, f"{name_} does not charge at {n.span}: off is allowed, a trickle is not."
    tex = rf"{low} \cdot 1 \le {number(power)} \le {high} \cdot 1\ \text{{kW}}"
    return tex, (
        f"{name_} charges with {power:,.1f} kW; once on, its charger can go from "
        f"{v.low_kw:,.1f} to {v.request.max_kw:,.1f} kW."
    )


def promised_return(n: Numbers) -> Filled:
    """(7a)."""
    v = n.vehicle
    if v is None:
        return NOBODY
    scenario = n.step.inputs.scenario
    back = f"{scenario.time_of(v.request.deadline_interval):%H:%M}"
    tex = rf"D_{{{name(v.request.vehicle)},t}} = 0\quad \text{{from }}\ t \ge \text{{{back}}}"
    used = [t for t, power in enumerate(v.power_kw) if power > 0]
    last = scenario.time_of(n.step.interval + used[-1] + 1) if used else None
    plan = f"; the plan is done with it by {last:%H:%M}" if last else ""
    kind = "was promised" if v.admitted else "would have had"
    left = max(0, v.intervals_left)
    return tex, (
        f"{plain(v.request.vehicle)} {kind} its return by {back}, "
        f"{counted(left, 'interval')} from here{plan}."
    )


def energy_owed(n: Numbers) -> Filled:
    """(7b)."""
    v = n.vehicle
    if v is None:
        return NOBODY
    owed = rf"{number(v.owed_kwh)} \cdot {int(v.admitted)}\ \text{{kWh}}"
    powers = [power for power in v.power_kw if power > 0]
    tex = rf"({total(powers)}) \cdot {v.interval_hours:g} = {owed}"
    if not v.admitted:
        return tex, f"{plain(v.request.vehicle)} asked for {v.owed_kwh:,.1f} kWh and gets none."
    return tex, (
        f"{plain(v.request.vehicle)} is still owed {v.owed_kwh:,.1f} kWh, and its planned powers "
        f"come to {v.planned_kwh:,.1f} kWh: not less, not more."
    )


CONTRACTS = (
    Card(
        "(5)",
        "A contract stays a contract",
        r"u_n = 1\ \text{(contracts)},\qquad "
        r"u_n \in \{0,1\}\ \text{(new)}",
        contracts,
        equations.contracts_stay,
    ),
    Card(
        "(6a)",
        "Only contracts charge",
        r"D_{nt} \le u_n",
        only_contracts,
        equations.only_contracts_charge,
    ),
    Card(
        "(6b)",
        "A charger is off, or between its limits",
        r"\underline{p}^{EV} D_{nt} \le "
        r"P_{nt} \le \overline{p}^{EV} D_{nt}",
        charger_limits,
        equations.charger_power,
    ),
    Card(
        "(7a)",
        "Nothing after the promised return",
        r"D_{nt} = 0\quad \forall t > a_n",
        promised_return,
        equations.time_of_return,
    ),
    Card(
        "(7b)",
        "Exactly the energy owed",
        r"\sum_t P_{nt}\,\Delta t = u_n s_n",
        energy_owed,
        equations.energy_owed,
    ),
)
