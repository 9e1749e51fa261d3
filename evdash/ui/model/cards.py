"""P1 equation by equation: the formula, this run's numbers in it, and a sentence for each."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from evdash.domain.trace import Step
from evdash.grid.lindistflow import base_injections, voltage_sq_pu
from evdash.grid.reduction import active_limit_kw, voltage_minima
from evdash.horizon.advance import advance
from evdash.horizon.requests import need_kwh, promised_intervals
from evdash.metrics.equations import (
    NodeNumbers,
    RatingNumbers,
    StationNumbers,
    VehicleNumbers,
)
from evdash.scheduling import equations
from evdash.ui.model.tex import name, number, signed, total, usd
from evdash.ui.words import counted, element_words, money, plain


@dataclass(frozen=True, slots=True)
class Numbers:
    """All that the equations of one step are filled in with; no vehicle where nobody is there."""

    step: Step
    node: NodeNumbers
    rating: RatingNumbers | None
    station: StationNumbers
    vehicle: VehicleNumbers | None

    @property
    def span(self) -> str:
        scenario, t = self.step.inputs.scenario, self.step.interval
        return f"{scenario.time_of(t):%H:%M}–{scenario.time_of(t + 1):%H:%M}"


Filled = tuple[str, str]
"""An equation with numbers, as KaTeX, and what it says in a sentence, as Markdown."""


@dataclass(frozen=True, slots=True)
class Card:
    """One equation: the paper's number, its title, its formula, its numbers, its code."""

    paper: str
    title: str
    formula: str
    fill: Callable[[Numbers], Filled]
    code: Callable[..., Any]


NOBODY = ("", "Nobody is under contract or asking in this interval.")


def node_balance(n: Numbers) -> Filled:
    """(1a)."""
    here = n.node
    tex = (
        rf"p_{{{name(here.node)}}} = {number(here.generation_kw)} - {number(here.load_kw)} - "
        rf"{number(here.station_kw)} = {number(here.injection_kw)}\ \text{{kW}}"
    )
    charging = (
        f", and the charging station draws {here.station_kw:,.1f} kW"
        if here.hosts_station
        else "; the station is not at this node"
    )
    said = f"At node {plain(here.node)} the loads take {here.load_kw:,.1f} kW{charging}."
    return tex, said


def apparent_power(n: Numbers) -> Filled:
    """(2)."""
    rating = n.rating
    if rating is None:
        return "", "No rating stands between the substation and the station in this scenario."
    holds = r"\le" if rating.active_kw <= rating.limit_kw + 1e-6 else r">"
    tex = (
        rf"{number(abs(rating.active_kw))} {holds} \sqrt{{{number(rating.rating_kva, 0)}^2 - "
        rf"({number(rating.reactive_kvar)})^2}} = {number(rating.limit_kw)}\ \text{{kW}}"
    )
    where = element_words(rating.element, n.step.inputs.scenario)
    return tex, (
        f"Through {where} flow {rating.active_kw:,.1f} kW; with {rating.reactive_kvar:,.1f} kvar "
        f"beside them it may carry {rating.limit_kw:,.1f} kW."
    )


def linear_voltage(n: Numbers) -> Filled:
    """(3)."""
    v = n.node
    tex = (
        rf"v_{{{name(v.node)}}} = {number(v.source_sq, 4)} {signed(v.active_part, 4)} "
        rf"{signed(v.reactive_part, 4)} = {number(v.voltage_sq, 4)}"
    )
    return tex, (
        f"Active power changes the squared voltage of node {plain(v.node)} by "
        f"{v.active_part:+.4f}, reactive power by {v.reactive_part:+.4f}; the voltage itself is "
        f"the root, {v.voltage_pu:.4f} pu."
    )


def voltage_limits(n: Numbers) -> Filled:
    """(4c)."""
    v = n.node
    low = r"\le" if v.lowest_pu <= v.voltage_pu + 1e-9 else ">"
    high = r"\le" if v.voltage_pu <= v.highest_pu + 1e-9 else ">"
    tex = rf"{v.lowest_pu:g}\ {low}\ {v.voltage_pu:.4f}\ {high}\ {v.highest_pu:g}\ \text{{pu}}"
    if v.voltage_pu < v.lowest_pu:
        said = f"{v.lowest_pu - v.voltage_pu:.4f} pu below what is allowed"
    elif v.voltage_pu > v.highest_pu:
        said = f"{v.voltage_pu - v.highest_pu:.4f} pu above what is allowed"
    else:
        said = f"{v.voltage_pu - v.lowest_pu:.4f} pu above the lowest voltage allowed"
    return tex, f"Node {plain(v.node)} is {said}."


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


def station_power(n: Numbers) -> Filled:
    """(8)."""
    s = n.station
    powers = sorted(s.power_kw.values(), reverse=True)
    tex = rf"p^{{EV}} = {total(powers)} = {number(s.total_kw)}\ \text{{kW}}"
    if s.headroom_kw < float("inf"):
        where = element_words(s.binding, n.step.inputs.scenario)
        room = f"The feeder leaves {s.headroom_kw:,.1f} kW for it, limited by {where}."
    else:
        room = "The feeder sets no limit to it."
    return tex, f"{counted(len(powers), 'vehicle')} together draw {s.total_kw:,.1f} kW. {room}"


def charger_count(n: Numbers) -> Filled:
    """(9)."""
    s = n.station
    running = len(s.power_kw)
    free = s.chargers - running
    said = "all chargers are taken" if free == 0 else f"{counted(free, 'charger')} free"
    return rf"{running} \le {s.chargers}", f"{running} charging at {n.span}, {said}."


def objective(n: Numbers) -> Filled:
    """(P1)."""
    s = n.station
    worth = s.energy_cost - s.new_revenue
    tex = rf"{usd(s.energy_cost)} - {usd(s.new_revenue)} = {usd(worth)}"
    proven = f" No plan at all can get below {money(s.bound)}." if s.bound is not None else ""
    return tex, (
        f"The energy of the whole plan costs {money(s.energy_cost)}, the newcomers admitted now "
        f"pay {money(s.new_revenue)}.{proven} What earlier contracts pay is settled and left out."
    )


def energy_need(n: Numbers) -> Filled:
    """s_n."""
    v = n.vehicle
    if v is None:
        return NOBODY
    r, efficiency = v.request, n.step.inputs.scenario.station.efficiency
    tex = (
        rf"s = \frac{{({r.soc_out:.3g} - {r.soc_in:.3g}) \cdot {number(r.battery_kwh)}}}"
        rf"{{{efficiency:g}}} = {number(r.need_kwh)}\ \text{{kWh}}"
    )
    return tex, (
        f"{plain(r.vehicle)} came with {100 * r.soc_in:.3g} % and wants {100 * r.soc_out:.3g} % "
        f"of {r.battery_kwh:g} kWh; charging losses included, the grid must give "
        f"{r.need_kwh:,.1f} kWh."
    )


def return_time(n: Numbers) -> Filled:
    """a_n."""
    v = n.vehicle
    if v is None:
        return NOBODY
    r, scenario = v.request, n.step.inputs.scenario
    option = scenario.options_by_name.get(r.option)
    average = min(option.average_kw if option else r.max_kw, r.max_kw)
    whole = promised_intervals(r.need_kwh, average, r.max_kw, v.interval_hours)
    tex = (
        rf"a = \left\lceil \frac{{{number(r.need_kwh)}}}"
        rf"{{{number(average)} \cdot {v.interval_hours:g}}} \right\rceil = {whole}"
    )
    back = f"{scenario.time_of(r.deadline_interval):%H:%M}"
    if min(r.arrival_interval + whole, scenario.intervals) != r.deadline_interval:
        return "", f"{plain(r.vehicle)} got its terms under other settings: back by {back}."
    cut = r.arrival_interval + whole > scenario.intervals
    end = ", cut short by the end of the horizon" if cut else ""
    return tex, (
        f"Option {plain(r.option)} promises {average:g} kW on average, so the charge may take "
        f"{counted(whole, 'interval')}: back by {back}{end}."
    )


def next_interval(n: Numbers) -> Filled:
    """(10)."""
    v = n.vehicle
    if v is None or not v.admitted:
        return "", "Without a contract nothing is carried on to the next interval."
    left = v.owed_kwh - v.delivered_now_kwh
    tex = (
        rf"s \leftarrow {number(v.owed_kwh)} - {number(v.delivered_now_kwh)} = {number(left)}\ "
        rf"\text{{kWh}},\qquad a \leftarrow {v.intervals_left} - 1 = {v.intervals_left - 1}"
    )
    said = f"still owed {left:,.1f} kWh" if left > 0.05 else "fully charged"
    return tex, f"After {n.span} {plain(v.request.vehicle)} is {said}."


FEEDER = (
    Card(
        "(1)",
        "What enters and leaves a node",
        r"p_{i,t} = p^g_{i,t} - p^\ell_{i,t} - "
        r"p^{EV}_{i,t},\qquad q_{i,t} = q^g_{i,t} - q^\ell_{i,t}",
        node_balance,
        base_injections,
    ),
    Card(
        "(2)",
        "No more than an element's rating",
        r"|p_{i,t}| \le \sqrt{\overline{s}_i^2 - "
        r"q_{i,t}^2}",
        apparent_power,
        active_limit_kw,
    ),
    Card(
        "(3)",
        "Voltages follow power (linearised)",
        r"\mathbf{v}_t = v_0\mathbf{1} + "
        r"\mathbf{R}\mathbf{p}_t + \mathbf{X}\mathbf{q}_t",
        linear_voltage,
        voltage_sq_pu,
    ),
    Card(
        "(4c)",
        "Voltages stay inside their limits",
        r"\underline{v}\mathbf{1} \le \mathbf{v}_t "
        r"\le \overline{v}\mathbf{1}",
        voltage_limits,
        voltage_minima,
    ),
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
STATION = (
    Card(
        "(8)",
        "The station is the sum of its vehicles",
        r"p^{EV}_t = \sum_n P_{nt}",
        station_power,
        equations.station_power,
    ),
    Card(
        "(9)",
        "No more at once than chargers",
        r"\sum_n D_{nt} \le \overline{N}",
        charger_count,
        equations.charger_count,
    ),
    Card(
        "(P1)",
        "What is minimised",
        r"\min\ \sum_{n,t} c_t P_{nt}\,\Delta t - \sum_{n\ "
        r"\text{new}} C_n s_n u_n",
        objective,
        equations.profit,
    ),
)
CLOCK = (
    Card(
        "s",
        "How much energy a vehicle needs",
        r"s_n = \frac{(SOC_{out} - SOC_{in}) \cdot "
        r"Bcap_n}{\eta}",
        energy_need,
        need_kwh,
    ),
    Card(
        "a",
        "How long it may take",
        r"a_n = \left\lceil \frac{s_n}{P_{C_j}\,\Delta t} "
        r"\right\rceil",
        return_time,
        promised_intervals,
    ),
    Card(
        "(10)",
        "On to the next interval",
        r"s_n \leftarrow s_n - P_{n1}\,\Delta t,\qquad "
        r"a_n \leftarrow a_n - 1",
        next_interval,
        advance,
    ),
)
GROUPS = {
    "The feeder": FEEDER,
    "The contracts": CONTRACTS,
    "The station, and what is optimised": STATION,
    "From a request to a contract, and from hour to hour": CLOCK,
}
