"""The equations of the feeder, filled in: (1) to (4)."""

from evdash.grid.lindistflow import base_injections, voltage_sq_pu
from evdash.grid.reduction import active_limit_kw, voltage_minima
from evdash.ui.model.card import Card, Filled, Numbers
from evdash.ui.model.tex import name, number, signed
from evdash.ui.words import element_words, plain


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
